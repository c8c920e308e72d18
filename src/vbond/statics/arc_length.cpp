#include "vbond/statics/detail/arc_length.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/core/bounding_box.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {

namespace {

// A step that needs more corrections than this is too long; five are usual.
constexpr int most_corrections = 12;
// How far the corrected point may be from the predicted one, over the length of the step. On a path of
// curvature kappa it is kappa s / 2, so a half is a turn of the path by one radian.
constexpr double largest_deviation = 0.5;
// Near a critical point what is small out of balance moves the body far along its soft mode. So a point is
// one only when the next correction is no more than this part of the step, or what is out of balance is some
// times what rounding of positions leaves: more corrections would be rounding along that mode.
constexpr double settled_to = 1e-7;
constexpr double near_rounding = 10.0;
// Modes driven by more than this part of the largest force are no modes of a nearly symmetric body.
constexpr double strong_drive = 1e-6;

// A singular value of the small equations below this counts as zero. Rounding of a load that does not act
// along the mode is far smaller; at a limit point the load acts along its mode and is far larger.
constexpr double zero_singular_value = 1e-9;

/// The small equations for the amplitudes along null vectors and the change of the load factor, scaled so
/// that all are lengths.
class NullSpaceEquations {
 public:
  NullSpaceEquations(const Deflated& deflated, const StaticBody& body)
      : N_(deflated.null_vectors()), L_(deflated.null_values()), g_(body.load_direction()) {
    b_ = deflated.solve(g_);
    const double force = g_.norm(), length = b_.norm();
    per_factor_ = length > 0.0 ? length : 1.0;
    stiffness_ = force > 0.0 ? force / per_factor_ : 1.0;
  }
  Eigen::Index unknowns() const { return L_.size() + 1; }
  /// L a - N^T g df over the stiffness, for unknowns a and df times the length of b.
  DenseMatrix rows() const {
    DenseMatrix A = DenseMatrix::Zero(L_.size(), unknowns());
    A.leftCols(L_.size()) = (L_ / stiffness_).asDiagonal();
    A.rightCols(1) = -along_null_vectors(g_) / per_factor_;
    return A;
  }
  Vector along_null_vectors(const Vector& forces) const { return N_.transpose() * forces / stiffness_; }
  PathDirection direction(const Vector& unknowns) const {
    const double df = unknowns[L_.size()] / per_factor_;
    return {N_ * unknowns.head(L_.size()) + df * b_, df};
  }

 private:
  const DenseMatrix& N_;
  const Vector& L_;
  const Vector& g_;
  Vector b_;
  double per_factor_, stiffness_;
};

/// Of a cell that is strained, as if all particles went as far as its edges.
double strained_movement(const StaticBody& body) {
  double rate2 = 0.0, edges2 = 0.0;
  for (const CellComponent& c : body.stage().cell.component)
    if (c.by == CellComponent::By::strain) rate2 += sq(c.value);
  for (const CellEdge& e : body.state().cell) edges2 += norm2(e.along);
  return static_cast<double>(body.model().particles()) * rate2 * edges2;
}

double held_movement(const StaticBody& body) {
  const double imposed = body.imposed_strain() * extent_of(body);
  double sum = strained_movement(body) + static_cast<double>(body.model().particles()) * sq(imposed);
  for (const Support& support : body.stage().supports)
    for (std::size_t k = 0; k < 3; ++k) {
      const HeldAxes* axes = support.axes ? &*support.axes : nullptr;
      const auto count = static_cast<double>(support.particles.size());
      if (support.held[k] && !support.rigid) sum += count * sq(dot(support.velocity, axis_of(axes, k)));
      if (support.held[k + 3])
        sum += count * sq(body.unknowns().length() * dot(support.angular_velocity, axis_of(axes, k + 3)));
    }
  for (const Support& support : body.stage().supports)
    for (const ParticleId p : support.particles)
      if (support.rigid) sum += norm2(body.rate_of(support, p));
  return sum;
}

}  // namespace

double extent_of(const StaticBody& body) {
  double size = std::max(box_around(body.state().r).diagonal(), body.unknowns().length());
  if (body.moves_cell())
    for (const CellEdge& e : body.state().cell) size = std::max(size, norm(e.along));
  return size;
}

ArcLength::ArcLength(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings)
    : body_(body), solver_(solver), settings_(settings), weight_(held_movement(body)) {}

PathDirection ArcLength::unit(PathDirection d) const {
  const double length = std::sqrt(dot(d, d));
  return {d.u / length, d.f / length};
}

double ArcLength::angle(const PathDirection& a, const PathDirection& b) const {
  const PathDirection difference{a.u - b.u, a.f - b.f}, sum{a.u + b.u, a.f + b.f};
  return 2.0 * std::atan2(std::sqrt(dot(difference, difference)), std::sqrt(dot(sum, sum)));
}

/// Ready for a step on a plane with this normal; of no length: for the tangent at a given load factor.
void ArcLength::factor(const PathDirection& normal) {
  singular_.reset();
  bordered_ = full_is_singular_ = false;
  factored_at_ = body_.placement_number();
  solver_.prepare(body_);
  if (solver_.factors_full(body_)) {
    unstable_ = 0;
    bordered_ = dot(normal, normal) > 0.0;
    full_is_singular_ =
        bordered_ ? !solver_.take_bordered(body_, {body_.load_direction(), normal.u, weight_ * normal.f})
                  : !solver_.take_full(body_);
    return;
  }
  const std::optional<int> unstable = solver_.factor(body_);
  if (unstable) {
    unstable_ = *unstable;
  } else {
    singular_.emplace(solver_.deflated(body_));
    other_factors_ += singular_->factors();
    unstable_ = singular_->negative();
  }
  if (held_) of_held_ = solve_beside(*held_);
}

/// By the factor at hand, or where there is none by that of a matrix next to it.
DenseMatrix ArcLength::solve_beside(const DenseMatrix& B) {
  return singular_ ? singular_->solve_beside_columns(B) : solver_.solve_columns(B);
}

/// x without a part along the modes held, which balances b but for forces along them.
Vector ArcLength::solve_held(const Vector& b) {
  const DenseMatrix& M = *held_;
  const Vector driving = b - M * (M.transpose() * b);
  const Vector x = singular_ ? singular_->solve_beside(driving) : solver_.solve(driving);
  return x - of_held_ * solve_dense(M.transpose() * of_held_, M.transpose() * x);
}

std::optional<PathPoint> ArcLength::point_here(const PathDirection& along) {
  factor(along);
  return point_of_factor(along);
}

std::optional<PathPoint> ArcLength::point_of_factor(const PathDirection& along) {
  if (full_is_singular_) return {};
  PathDirection d = tangent(along);
  const int sign = sign_of_determinant(d);
  const double length2 = dot(d, d);
  if (!std::isfinite(length2) || length2 == 0.0) return {};
  d = unit(std::move(d));
  if (dot(d, along) < 0.0) d = {-d.u, -d.f};
  return PathPoint{body_.placement(), std::move(d), unstable_, !body_.has_moment_part(), sign};
}

/// Of the tangent stiffness, where no eigenvalue is zero. By Cramer's rule the f of the tangent of the path
/// is that determinant over the one of the bordered matrix.
int ArcLength::sign_of_determinant(const PathDirection& tangent) const {
  if (bordered_) return tangent.f < 0.0 ? -solver_.sign_of_bordered() : solver_.sign_of_bordered();
  if (solver_.factors_full(body_)) return solver_.sign_of_full();
  return singular_ ? 0 : unstable_ % 2 == 0 ? 1 : -1;
}

PathDirection ArcLength::tangent(const PathDirection& along) {
  if (held_) return {solve_held(body_.load_direction()), 1.0};
  if (bordered_) return solved_bordered(Vector::Zero(body_.unknowns().size()), 1.0);
  if (singular_) return singular_tangent(along);
  return {solver_.solve_full(body_, body_.load_direction()), 1.0};  // K du = g df
}

// With the null vectors N and their eigenvalues L: du = N a + b df, b from K b = g on the rest, and
//   L a - N^T g df = 0.
// Where outside moments act this has the symmetric part of the tangent only, so that the direction is only
// near the path's; corrections at points where the tangent can be factored have the whole of it.
// Of the solutions, as many as there are null vectors or, at a bifurcation, one more, the one nearest to
// `along`.
PathDirection ArcLength::singular_tangent(const PathDirection& along) {
  const NullSpaceEquations s(*singular_, body_);
  if (s.unknowns() == 1) return s.direction(Vector::Ones(1));
  const DenseSingular svd = singular_values(s.rows());
  const auto rank = (svd.values.array() > zero_singular_value).count();
  const DenseMatrix solutions = svd.V.rightCols(s.unknowns() - rank);
  DenseMatrix metric(solutions.cols(), solutions.cols());
  Vector rhs(solutions.cols());
  for (Eigen::Index i = 0; i < solutions.cols(); ++i) {
    const PathDirection d_i = s.direction(solutions.col(i));
    rhs[i] = dot(d_i, along);
    for (Eigen::Index j = 0; j < solutions.cols(); ++j)
      metric(i, j) = dot(d_i, s.direction(solutions.col(j)));
  }
  return s.direction(solutions * solve_shortest(metric, rhs));
}

// Newton's step on R = 0 that stays on the plane, by two solves with one factor:
//   K du = R + g df,  normal . (du, df) = 0.
PathDirection ArcLength::correction(const PathDirection& normal) {
  if (bordered_) return solved_bordered(body_.unbalanced(), 0.0);
  if (singular_ && !held_) return singular_correction(normal);
  const auto solved = [this](const Vector& f) {
    return held_ ? solve_held(f) : solver_.solve_full(body_, f);
  };
  const Vector a = solved(body_.unbalanced()), b = solved(body_.load_direction());
  const double df = -normal.u.dot(a) / (normal.u.dot(b) + weight_ * normal.f);
  return {a + df * b, df};
}

PathDirection ArcLength::solved_bordered(const Vector& R, double c) const {
  const Vector x = solver_.solve_bordered(R, c);
  return {x.head(R.size()), x[R.size()]};
}

// The same with du = N c + a + b df:
//   L c - N^T g df = N^T R,  normal . (N c + a + b df, df) = 0.
PathDirection ArcLength::singular_correction(const PathDirection& normal) {
  const NullSpaceEquations s(*singular_, body_);
  const Vector& R = body_.unbalanced();
  const Vector a = singular_->solve(R);
  DenseMatrix A(s.unknowns(), s.unknowns());
  A.topRows(s.unknowns() - 1) = s.rows();
  for (Eigen::Index k = 0; k < s.unknowns(); ++k)
    A(s.unknowns() - 1, k) = dot(normal, s.direction(Vector::Unit(s.unknowns(), k)));
  Vector rhs(s.unknowns());
  rhs << s.along_null_vectors(R), -normal.u.dot(a);
  // the shortest solution: nothing along a mode that nothing drives
  const DenseSingular svd = singular_values(A);
  Vector y = svd.U.transpose() * rhs;
  for (Eigen::Index k = 0; k < y.size(); ++k)
    y[k] = svd.values[k] > zero_singular_value ? y[k] / svd.values[k] : 0.0;
  PathDirection d = s.direction(svd.V * y);
  d.u += a;
  return d;
}

StepOutcome ArcLength::step(const Placement& from, const PathDirection& direction, double s,
                            bool end_of_step) {
  held_ = nullptr;
  return corrected(from, direction, s, end_of_step);
}

StepOutcome ArcLength::step_beside(const DenseMatrix& modes, const Placement& from,
                                   const PathDirection& direction, double s) {
  held_ = &modes;
  StepOutcome outcome;
  try {
    outcome = corrected(from, direction, s, false);
  } catch (...) {
    held_ = nullptr;
    throw;
  }
  held_ = nullptr;
  const double drive = this->drive(modes);
  if (!(drive <= strong_drive)) outcome.point.reset();
  outcome.driven = drive > near_rounding * body_.residual_of_rounding();
  return outcome;
}

/// The force along these modes that is out of balance, over the largest force in the body.
double ArcLength::drive(const DenseMatrix& modes) const {
  const Vector& R = body_.unbalanced();
  const double all = max_norm(R);
  return all > 0.0 ? body_.residual() * (max_norm(modes.transpose() * R) / all) : 0.0;
}

bool ArcLength::is_balanced_beside(const DenseMatrix& modes) const {
  return body_.residual_beside(modes) <= std::max(settings_.tolerance, body_.residual_of_rounding());
}

StepOutcome ArcLength::corrected(const Placement& from, const PathDirection& direction, double s,
                                 bool end_of_step) {
  StepOutcome outcome;
  body_.restore(from);
  body_.move(s * direction.u, from.load_factor + s * direction.f);
  PathDirection& deviation = outcome.deviation;
  deviation = {Vector::Zero(direction.u.size()), 0.0};
  const int most = std::min(most_corrections, settings_.iterations);
  for (;;) {
    Pulse::may_end();
    const double residual = body_.residual();
    outcome.residuals.push_back(residual);
    if (!std::isfinite(residual)) {
      outcome.why = body_.first_not_finite();
      return outcome;
    }
    PathDirection change;
    try {
      factor(direction);
      if (full_is_singular_) {
        outcome.why = "the equations of the step are singular";
        return outcome;
      }
      change = correction(direction);
    } catch (const NoConvergence& e) {
      if (!solver_.by_multigrid()) throw;
      outcome.why = e.what();  // a shorter step may do better
      return outcome;
    }
    const bool in_balance =
        held_ ? is_balanced_beside(*held_) : balanced(body_, settings_, outcome.residuals);
    const bool settled = std::sqrt(dot(change, change)) <= settled_to * std::abs(s);
    const double rounding = body_.residual_of_rounding();
    const bool falls = outcome.iterations == 0 || residual <= 0.3 * outcome.residuals.end()[-2];
    const bool stalled = residual <= (end_of_step && falls ? 1.0 : near_rounding) * rounding;
    if (in_balance && (settled || stalled || outcome.iterations == most)) break;
    if (outcome.iterations == most) {
      outcome.why = fmt::format("no balance after {} corrections", most);
      return outcome;
    }
    deviation.u += change.u;
    deviation.f += change.f;
    if (!(std::sqrt(dot(deviation, deviation)) <= largest_deviation * std::abs(s))) {
      outcome.why = "the balance found is far from the predicted one";
      return outcome;
    }
    body_.move(change.u, body_.load_factor() + change.f);
    ++outcome.iterations;
    ++iterations_;
  }
  outcome.point = point_of_factor(direction);
  if (!outcome.point) outcome.why = "nothing changes with the load factor";
  return outcome;
}

}  // namespace vbond
