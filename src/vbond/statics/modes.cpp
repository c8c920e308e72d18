#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/bloch.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/kinks.hpp"
#include "vbond/statics/detail/mass_scaled.hpp"
#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {
namespace {

/// The stage with all its loads at full size.
StaticStage under_full_loads(StaticStage stage) {
  for (const Support& s : stage.supports)
    if (moves(s))
      throw NoEquilibrium(
          stage.name, fmt::format("the support of \"{}\" moves", s.group),
          "modes are about a balance at rest: move it in an equilibrium stage before this one");
  for (PointLoad& l : stage.loads) l.constant = true;
  for (Pressure& p : stage.pressures) p.constant = true;
  stage.constant_gravity = true;
  return stage;
}

/// There are no normal modes about a kink: a swing is stiffer to one side than to the other.
void refuse_kinks(const StaticBody& body) {
  const auto moves = [&body](ParticleId p) {
    return body.unknowns().of(p, 0) != Unknowns::held || body.unknowns().of(p, 1) != Unknowns::held ||
           body.unknowns().of(p, 2) != Unknowns::held;
  };
  if (const std::optional<Kink> kink = kink_at(body.model(), body.state(), moves))
    throw NoEquilibrium(body.stage().name, kink->what, kink->way_out);
}

/// What rounding and the last bit out of balance may make of the tangent times a rigid motion of length 1.
/// Positions are rounded by eps times the extent of the body, which turns and stresses its bonds by that over
/// their length; 64 for the terms of a row. A turn takes what is out of balance along.
double zero_stiffness(const StaticBody& body) {
  const BoundingBox box = box_around(body.state().r);
  const double far = std::max({box.diagonal(), norm(box.low), norm(box.high)});
  const double L = body.unknowns().length(), eps = std::numeric_limits<double>::epsilon();
  return 64 * eps * (1 + far / L) * max_norm(body.tangent().diagonal()) + 4 * max_norm(body.unbalanced()) / L;
}

/// The columns without their zero rows.
DenseMatrix rows_with_entries(const SparseMatrix& columns) {
  std::map<Eigen::Index, Eigen::Index> place;
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    for (SparseMatrix::InnerIterator it(columns, k); it; ++it)
      place.try_emplace(it.row(), static_cast<Eigen::Index>(place.size()));
  DenseMatrix dense = DenseMatrix::Zero(static_cast<Eigen::Index>(place.size()), columns.cols());
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    for (SparseMatrix::InnerIterator it(columns, k); it; ++it) dense(place[it.row()], k) = it.value();
  return dense;
}

/// Combinations of these rigid motions, in columns, to which their forces (K times motion) are no more than
/// `zero`.
DenseMatrix without_forces(const SparseMatrix& forces, double zero) {
  const DenseMatrix F = rows_with_entries(forces);
  if (F.rows() == 0) return DenseMatrix::Identity(F.cols(), F.cols());
  const DenseSingular svd = singular_values_pivoted(F);
  const auto stiff = (svd.values.array() > zero).count();
  return svd.V.rightCols(F.cols() - stiff);
}

/// Orthonormal, mass-scaled columns: the free rigid motions that meet no stiffness. Under load not all are: a
/// body that hangs swings. Motions of different parts share no forces, and are looked at apart.
SparseMatrix motions_without_stiffness(const StaticBody& body, const MassRoot& root) {
  const SparseMatrix motions = free_rigid_motions(body.model(), body.state(), body.unknowns()).basis;
  const SparseMatrix forces = body.tangent() * motions, shared = forces.transpose() * forces;
  const double zero = zero_stiffness(body);
  std::vector<Eigen::Triplet<double>> entries;
  int found = 0;
  Eigen::Index end = motions.cols();
  Eigen::Index reach = end;  // the first column that shares forces with those from here to end
  for (Eigen::Index k = end; k-- > 0;) {
    reach = std::min(reach, k);
    for (SparseMatrix::InnerIterator it(shared, k); it; ++it) reach = std::min(reach, it.row());
    if (reach < k) continue;
    const DenseMatrix free = without_forces(forces.middleCols(k, end - k), zero);
    for (Eigen::Index j = 0; j < free.cols(); ++j, ++found)
      for (Eigen::Index column = k; column < end; ++column)
        for (SparseMatrix::InnerIterator it(motions, column); it; ++it)
          entries.emplace_back(static_cast<int>(it.row()), found,
                               it.value() * free(column - k, j) * root.diagonal()[it.row()]);
    end = reach = k;
  }
  SparseMatrix columns(motions.rows(), found);
  columns.setFromTriplets(entries.begin(), entries.end());
  return orthonormalised(root.times_factor(columns));
}

double largest_column_sum(const SparseMatrix& A) {
  return max_norm(A.cwiseAbs().transpose() * Vector::Ones(A.rows()));
}

/// A value below all eigenvalues of A, and how many are clearly negative. Begins where rounding would make a
/// zero eigenvalue negative, so that it is just below the spectrum of a stable body. Throws
/// NoConvergence if there is no such value: A is not finite.
struct Below {
  double bound;
  int unstable;
};

Below below_spectrum(const SparseMatrix& A) {
  Factor factor;
  factor.analyse(A);
  const double largest = largest_column_sum(A);  // no eigenvalue is larger in size
  const double scale = largest == 0.0 ? 1.0 : largest;
  std::optional<int> unstable;
  for (double shift = 1e-12 * scale; shift < 100 * scale; shift *= 10) {
    if (factor.factor_definite(A, shift)) return {-shift, unstable.value_or(0)};
    if (!unstable) unstable = factor.factor_indefinite(A, shift);
  }
  throw NoConvergence("modes: the stiffness over the mass is not finite");
}

/// Eigenpairs of A without the rigid motions, lowest first.
struct Swings {
  EigenPairs pairs;
  int unstable = 0;
};

Swings swings_by_factors(const SparseMatrix& A, int count, const SparseMatrix& rigid) {
  const Below below = below_spectrum(A);
  return {smallest_eigenpairs(A, count, below.bound, rigid), below.unstable};
}

/// More than are wanted where that many are negative, to count these. As for factors, what is above
/// -1e-12 of the largest is not clearly negative.
Swings swings_by_multigrid(ByMultigrid& solver, const MassRoot& root, const SparseMatrix& A, int count,
                           const SparseMatrix& rigid) {
  const double zero = 1e-12 * largest_column_sum(A);
  LowestProblem problem;
  problem.size = A.rows();
  problem.times = [&A](const DenseMatrix& X) -> DenseMatrix { return A.transpose() * X; };
  problem.inverse = [&](const DenseMatrix& Y) {
    return root.transpose_times(solver.solutions(root.times(Y)));
  };
  problem.without = &rigid;
  problem.rounding = 16.0 * epsilon * max_norm(A.diagonal());
  const int left = static_cast<int>(A.rows() - rigid.cols());
  for (int looked_at = count;; looked_at = std::min(2 * looked_at, left)) {
    const Lowest found = solver.lowest_of(problem, {looked_at, 1e-7, 0.0, 1000});
    if (found.values[looked_at - 1] < -zero && looked_at < left) continue;
    const int wanted = std::min(count, found.size());
    return {{found.values.head(wanted), found.vectors.leftCols(wanted), 0},
            static_cast<int>((found.values.array() < -zero).count())};
  }
}

/// What the modes of a stage are made of.
struct Vibrating {
  const StaticBody& body;
  const MassRoot& root;
  const SparseMatrix& rigid;              // motions without stiffness of a body that repeats with its cell
  const std::vector<NaturalMode>& turns;  // of particles that touch no other
  int count;
};

NaturalMode mode(const Vibrating& v, double omega2, bool rigid, const Vector& y) {
  return {std::sqrt(std::max(omega2, 0.0)), omega2, rigid, v.body.unknowns().shape(v.root.motion(y))};
}

NaturalMode mode(const Vibrating& v, double omega2, bool rigid, const Eigen::VectorXcd& y) {
  Eigen::VectorXcd x(y.size());
  x.real() = v.root.motion(y.real());
  x.imag() = v.root.motion(y.imag());
  WaveShape shape = wave_shape(v.body.unknowns(), x);
  return {std::sqrt(std::max(omega2, 0.0)), omega2, rigid,
          std::move(shape.in_phase),        0,      std::move(shape.out_of_phase)};
}

/// The turns of particles that touch no other, as rigid motions. Those of others are no motions of a part.
std::vector<NaturalMode> turns_of_loose(const StaticBody& body) {
  const std::vector<Unknowns::Place>& turns = body.unknowns().free_turns();
  if (turns.empty()) return {};
  const PartImages parts = images_of_parts(body.model(), body.state(), body.unknowns());
  std::vector<std::size_t> number(parts.loops.size(), 0);
  for (const std::size_t part : parts.part) ++number[part];
  std::vector<NaturalMode> modes;
  for (const auto& [p, dof] : turns) {
    if (number[parts.part[p]] > 1) continue;
    const std::size_t particles = body.model().particles();
    Shape shape{PerParticle<Vec3d>(particles), PerParticle<Vec3d>(particles)};
    shape.rotation[p] = body.unknowns().axis(p, dof);
    modes.push_back({0.0, 0.0, true, std::move(shape)});
  }
  return modes;
}

/// Modes, and how many of them are clearly unstable.
struct Modes {
  std::vector<NaturalMode> all;
  int unstable = 0;
  int swings() const {
    return static_cast<int>(
        std::count_if(all.begin(), all.end(), [](const NaturalMode& m) { return !m.rigid; }));
  }
};

/// Of images that move as the particles do. solver: prepared where multigrid is to be used.
Modes modes_of_cell(const Vibrating& v, TangentSolver& solver, const SparseMatrix& K,
                    const SparseMatrix& rigid) {
  Modes found{v.turns};
  for (Eigen::Index k = 0; k < rigid.cols(); ++k)
    found.all.push_back(mode(v, 0.0, true, Vector(rigid.col(k))));
  const int left = static_cast<int>(K.rows() - rigid.cols());
  if (left == 0) return found;
  const SparseMatrix A = v.root.scaled(K);
  const int count = std::min(v.count, left);
  Swings swings = solver.by_multigrid()
                      ? swings_by_multigrid(solver.multigrid_at(v.body), v.root, A, count, rigid)
                      : swings_by_factors(A, count, rigid);
  for (Eigen::Index k = 0; k < swings.pairs.values.size(); ++k)
    found.all.push_back(mode(v, swings.pairs.values[k], false, Vector(swings.pairs.vectors.col(k))));
  found.unstable = swings.unstable;
  return found;
}

/// Of a wave. Each eigenvalue of the doubled matrix stands there twice; what is found up to some eigenvalue
/// spans the waves up to it, in whatever vectors.
Modes modes_of_wave(const Vibrating& v, const BlochTangent& K, const Eigen::MatrixXcd& rigid) {
  Modes found{v.turns};
  for (Eigen::Index k = 0; k < rigid.cols(); ++k)
    found.all.push_back(mode(v, 0.0, true, Eigen::VectorXcd(rigid.col(k))));
  const int left = static_cast<int>(K.real.rows() - rigid.cols());
  if (left == 0) return found;
  const SparseMatrix A = doubled(v.root.scaled(K.real), v.root.scaled_skew(K.imaginary));
  const int count = std::min(v.count, left);
  const Swings swings = swings_by_factors(A, 2 * count, doubled_columns(rigid));
  const Eigen::MatrixXcd waves = independent_waves(swings.pairs.vectors, count);
  for (Eigen::Index k = 0; k < waves.cols(); ++k) {
    Vector y(2 * waves.rows());
    y << waves.col(k).real(), waves.col(k).imag();
    found.all.push_back(mode(v, y.dot(A * y), false, Eigen::VectorXcd(waves.col(k))));
  }
  found.unstable = swings.unstable / 2;
  return found;
}

/// The motions without stiffness that go on as a wave whose phases are real.
SparseMatrix real_columns(const Eigen::MatrixXcd& X) {
  return DenseMatrix(X.real()).sparseView();
}

Modes modes_at(const Vibrating& v, const Wave& wave) {
  const BlochTangent K = bloch_tangent(v.body, wave);
  const Eigen::MatrixXcd rigid = motions_in_phase(v.body, v.rigid, wave);
  TangentSolver factors(LinearSolver::direct);
  return K.is_real() ? modes_of_cell(v, factors, K.real, real_columns(rigid)) : modes_of_wave(v, K, rigid);
}

}  // namespace

// K phi = omega^2 M phi as an ordinary eigenvalue problem for S^T phi, M = S S^T.
StaticOutcome find_modes(const Model& model, const StaticStage& stage, State state,
                         const StaticHooks& hooks) {
  const StaticStage loaded = under_full_loads(stage);
  StaticResult result;
  std::optional<Balanced> balanced = balance_of_constant_loads(
      model, model.cell.any() ? with_floating_held(model, loaded, state, {}) : loaded, state, hooks, result);
  if (!balanced) return interrupted_outcome(std::move(result), std::move(state));
  StaticBody body(model, loaded, std::move(balanced->state));
  refuse_pressure_without_energy(body);
  refuse_kinks(body);
  if (body.has_moment_part() && hooks.tell)
    hooks.tell(fmt::format(
        "stage \"{}\": {} no potential: frequencies are those of the symmetric part of the tangent",
        stage.name,
        body.friction_part() > 0.0 ? "friction of cracked bonds has" : "moments of fixed direction have"));
  const MassRoot root(model, body.state(), body.unknowns());
  const SparseMatrix rigid = motions_without_stiffness(body, root);
  const std::vector<NaturalMode> turns = turns_of_loose(body);
  const Vibrating vibrating{body, root, rigid, turns, stage.count};
  TangentSolver solver(stage.newton.solver);
  const bool swings = body.unknowns().size() > rigid.cols();
  Modes found;
  int fewest = stage.count;
  if (stage.waves.q.empty()) {
    if (swings) solver.prepare(body);
    found = modes_of_cell(vibrating, solver, body.tangent(), rigid);
    fewest = found.swings();
  }
  for (std::size_t k = 0; k < stage.waves.q.size(); ++k) {
    Pulse::may_end();
    result.waves.push_back(wave_of(stage.waves, k, body.state().cell, model.cell.periodic));
    Modes of_wave = modes_at(vibrating, result.waves.back());
    for (NaturalMode& m : of_wave.all) m.wave = static_cast<int>(k) + 1;
    fewest = std::min(fewest, of_wave.swings());
    found.unstable += of_wave.unstable;
    std::move(of_wave.all.begin(), of_wave.all.end(), std::back_inserter(found.all));
  }
  result.modes = std::move(found.all);
  result.unstable = found.unstable;
  if (const std::size_t all = body.unknowns().free_turns().size(); all > turns.size())
    tell(stage, hooks,
         fmt::format(
             "{} modes of frequency zero are not listed: turns of particles that others touch, and that "
             "nothing turns",
             all - turns.size()));
  if (fewest < stage.count) tell(stage, hooks, fmt::format("the body has {} frequencies only", fewest));
  result.ended = "converged";
  result.solver = solver.name();
  result.solver_iterations += solver.iterations();
  report_point(body, PointKind::end, result.unstable, hooks, result);
  return {std::move(result), std::move(body).take_state()};
}

}  // namespace vbond
