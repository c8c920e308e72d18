// U depends on places and turns u and on the strain E of the cell. What is left of its second derivative when
// u stays in balance is K_EE - K_Eu K_uu^-1 K_uE: the six columns X = K_uu^-1 K_uE are how particles move
// with a unit of each strain. That is dP/dF of F = 1 + E; Cauchy's stress s = P F^T/J changes by
//
//     ds = dP + s E - s tr E.
//
// C is a minimum of the energy over u, so its derivative with a stiffness that U is linear in is that of the
// energy at the six fields as they are.
#include "vbond/statics/homogenise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "vbond/core/images.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/cell_constants.hpp"
#include "vbond/statics/detail/homogenising.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/one_blas_thread.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {
namespace {

/// Of the same body, with all components of the cell among the unknowns.
StaticStage with_free_cell(StaticStage held) {
  for (CellComponent& c : held.cell.component) c = {CellComponent::By::stress, 0.0, {}};
  return held;
}

/// C is to follow from the four stiffnesses of bonds alone.
void refuse_derivatives(const Model& model, const State& s) {
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (b.broken) continue;
    const std::string bond = fmt::format("bond {} (particles {}, {})", k.value, b.i.value, b.j.value);
    require_material(b.rules->stretch.form != StretchForm::table,
                     bond + " stretches by a table, which c_A is no part of: leave stretch out");
    require_material(is_at_rest(s, k),
                     bond +
                         " is strained, and how C follows from stiffnesses is known of bonds at rest: "
                         "take prestrain out, and contacts that press");
    require_material(history_of_bond(s, k) == no_history,
                     bond + " has flowed or is damaged, and is not what its stiffnesses say");
  }
  for_touching_pairs(model, s, [](ParticleId i, ParticleId j, const Image&, double) {
    require_material(
        false, fmt::format("particles {} and {} touch, and contacts do not follow from bonds: bond all that "
                           "touch, or leave [contact] out",
                           i.value, j.value));
  });
}

/// What a component of engineering strain puts into its entry of the tensor, and into the one across.
double share(std::size_t k) {
  return k < 3 ? 1.0 : 0.5;
}

std::size_t floating_particles(const Model& model, const State& state, const Unknowns& unknowns) {
  const PartImages parts = images_of_parts(model, state, unknowns);
  return static_cast<std::size_t>(std::count_if(parts.part.begin(), parts.part.end(),
                                                [&](std::size_t part) { return parts.loops[part].empty(); }));
}

/// The body as it stands, and the six fields: how particles move with each strain of the cell.
class Fields {
 public:
  Fields(const Model& model, const StaticStage& stage, const State& state)
      : free_(with_free_cell(stage)),
        held_(stage),
        model_(model),
        state_(state),
        whole_(model, free_, state) {}

  /// X: from where the fields are looked for, if a factor is at hand; then the fields.
  Homogenised result(TangentSolver& solver, DenseMatrix& X);
  std::vector<ConstantsBySet> by_set() const;

 private:
  using Movements = Eigen::Matrix<double, 12, 6>;
  Movements movements(const Bond& b, const std::vector<Vector>& x) const;
  Constants from(const DenseMatrix& H) const;

  const StaticStage free_;
  const StaticStage& held_;
  const Model& model_;
  const State& state_;
  const StaticBody whole_;
  DenseMatrix X_;  // how unknowns move with the components of the cell
};

Constants Fields::from(const DenseMatrix& H) const {
  const double factor = sq(whole_.unknowns().cell_length()) / volume(state_.cell);
  Constants C;
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b)
      C[a][b] = factor * share(a) * share(b) * 0.5 *
                (H(Eigen::Index(a), Eigen::Index(b)) + H(Eigen::Index(b), Eigen::Index(a)));
  return C;
}

/// s E - s tr E for a unit of each strain.
void add_stress(const Tensor& s, Constants& C) {
  for (std::size_t b = 0; b < 6; ++b) {
    SymmetricParts unit{};
    unit[b] = share(b);
    const Tensor E = cell_tensor(unit, false);
    Tensor change;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const std::size_t row = static_cast<std::size_t>(i);
        component(change.row[row], j) =
            dot(s.row[row], E.row[static_cast<std::size_t>(j)]) - (b < 3 ? component(s.row[row], j) : 0.0);
      }
    const SymmetricParts parts = symmetric_part(change);
    for (std::size_t a = 0; a < 6; ++a) C[a][b] += parts[a];
  }
}

Homogenised Fields::result(TangentSolver& solver, DenseMatrix& X) {
  constexpr double accuracy = 3e-7;  // of X: what it leaves of C is of second order
  const StaticBody body(model_, held_, state_);
  const SparseMatrix& K = whole_.tangent();
  const DenseMatrix columns = K.rightCols(6), K_uE = columns.topRows(K.rows() - 6);
  std::optional<DenseMatrix> by_kept;
  if (X.size() == K_uE.size()) by_kept = solver.solve_columns_kept(body, K_uE, X, accuracy);
  X = X_ = by_kept ? std::move(*by_kept) : solved_with_tangent(solver, body, K_uE);
  Homogenised found;
  const DenseMatrix coupled = K_uE.transpose() * X_;
  found.C =
      from(columns.bottomRows(6) - coupled - coupled.transpose() + X_.transpose() * (body.tangent() * X_));
  const Tensor stress = cell_stress(model_, whole_.state());  // at rest
  found.stress = symmetric_part(stress);
  add_stress(stress, found.C);
  found.volume = volume(state_.cell);
  for (const double m : model_.mass) found.density += m / found.volume;
  found.particles = model_.particles();
  found.bonds = unbroken_bonds(state_);
  found.floating = floating_particles(model_, state_, body.unknowns());
  if (found.floating == model_.particles()) found.C = {}, found.stress = {};  // but for rounding
  found.solver = solver.name();
  for (const auto& row : found.C)
    for (const double x : row)
      if (!std::isfinite(x))
        throw NoEquilibrium(homogenise_name, "constants are not finite", "look at the bonds");
  return found;
}

/// How both ends of a bond move in six motions: the second one, if it is an image, with the cell as well.
Fields::Movements Fields::movements(const Bond& b, const std::vector<Vector>& x) const {
  const Unknowns& u = whole_.unknowns();
  const auto& [e1, e2, e3] = model_.cell.edges;
  const Vec3d way =
      double(image_of_j(b).a) * e1 + double(image_of_j(b).b) * e2 + double(image_of_j(b).c) * e3;
  Movements moved;
  for (Eigen::Index k = 0; k < 6; ++k) {
    SymmetricParts unit{};
    unit[std::size_t(k)] = 1.0 / u.cell_length();
    const Vector& field = x[std::size_t(k)];
    Movement i = u.movement(b.i, field), j = u.movement(b.j, field);
    j.shift += times(cell_tensor(unit, false), way);
    moved.col(k) << i.shift.x, i.shift.y, i.shift.z, i.turn.x, i.turn.y, i.turn.z, j.shift.x, j.shift.y,
        j.shift.z, j.turn.x, j.turn.y, j.turn.z;
  }
  return moved;
}

/// The energy of bonds that have one of the four stiffnesses alone, along the six fields.
std::vector<ConstantsBySet> Fields::by_set() const {
  std::vector<ConstantsBySet> sets;
  std::vector<std::array<DenseMatrix, 4>> sums;
  std::vector<Vector> moves(6, Vector::Zero(whole_.unknowns().size()));
  for (Eigen::Index k = 0; k < 6; ++k) {
    moves[std::size_t(k)].head(X_.rows()) = -X_.col(k);
    moves[std::size_t(k)].tail(6)[k] = 1.0;
  }
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (b.broken) continue;
    const auto at = std::lower_bound(sets.begin(), sets.end(), std::size_t(b.set),
                                     [](const ConstantsBySet& s, std::size_t set) { return s.set < set; });
    const auto place = at - sets.begin();
    if (at == sets.end() || at->set != std::size_t(b.set)) {
      sets.insert(at, ConstantsBySet{std::size_t(b.set), {}, {}, {}, {}});
      const DenseMatrix zero = DenseMatrix::Zero(6, 6);
      sums.insert(sums.begin() + place, {zero, zero, zero, zero});
    }
    const Movements moved = movements(b, moves);
    const BondStiffness<double> c = b.law->stiffness(b);
    const BondStiffness<double> alone[] = {
        {c.c_A, 0, 0, 0}, {0, c.c_D, 0, 0}, {0, 0, c.c_B, 0}, {0, 0, 0, c.c_T}};
    for (std::size_t part = 0; part < 4; ++part) {
      Bond one = b;
      one.coefficients = b.law->from_stiffness(alone[part], b.a, b.coefficients);
      const PairTangent<9> tangent = b.law->tangent(one, bond_pose(one, state_), no_history);
      sums[std::size_t(place)][part] +=
          moved.transpose() * block_of(tangent, whole_.unknowns().length()) * moved;
    }
  }
  for (std::size_t s = 0; s < sets.size(); ++s) {
    ConstantsBySet& set = sets[s];
    Constants* const to[] = {&set.c_A, &set.c_D, &set.c_B, &set.c_T};
    for (std::size_t part = 0; part < 4; ++part) *to[part] = from(sums[s][part]);
  }
  return sets;
}

}  // namespace

CellConstants::CellConstants(const Model& model, const State& given, const HomogeniseSettings& settings)
    : settings_(settings),
      model_(about_cell_of(model, given)),
      state_(given),
      stage_(stage_of_homogenising(settings.newton)),
      solver_(settings.newton.solver, FactorUse::kept_if_cheaper) {
  require_material(
      model.cell.any() && model.cell.periodic == std::array<bool, 3>{true, true, true},
      "the cell must be periodic in all three directions: it is the piece of material that is looked at");
  refuse_what_is_no_material(model, given);
  const OneBlasThread alone;
  refuse_free_bodies(model_, stage_, given);
  moved_ = !StaticBody(model_, stage_, given).rests_to_rounding();
  if (moved_) state_ = run_static_stage(model_, stage_, given, {}).state;
  refuse_kinks(model_, state_);
  if (settings.derivatives) refuse_derivatives(model_, state_);
  stage_ = with_floating_held(model_, stage_, state_, {});
}

Homogenised CellConstants::found_with(const State& state) {
  const OneBlasThread alone;
  try {
    Fields fields(model_, stage_, state);
    Homogenised found = fields.result(solver_, X_);
    found.moved = moved_;
    if (settings_.derivatives) found.derivatives = fields.by_set();
    return found;
  } catch (...) {  // memory has run out, or a solver does not converge
    throw current_failure(stage_);
  }
}

Homogenised homogenise(const Model& model, const State& given, const HomogeniseSettings& settings) {
  return CellConstants(model, given, settings).found();
}

}  // namespace vbond
