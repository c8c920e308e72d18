#include "vbond/statics/detail/arc_length.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace vbond {

namespace {

// A step that needs more corrections than this is too long; five are usual.
constexpr int most_corrections = 12;
// How far the corrected point may be from the predicted one, over the length of the step. On a path of
// curvature kappa it is kappa s / 2, so a half is a turn of the path by one radian.
constexpr double largest_deviation = 0.5;

double held_movement(const StaticBody& body) {
  double sum = 0.0;
  for (const StaticSupport& support : body.stage().supports)
    for (int k = 0; k < 3; ++k) {
      const auto count = static_cast<double>(support.particles.size());
      if (support.held[static_cast<std::size_t>(k)]) sum += count * sq(component(support.displacement, k));
      if (support.held[static_cast<std::size_t>(k + 3)])
        sum += count * sq(body.unknowns().length() * component(support.rotation, k));
    }
  return sum;
}

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

}  // namespace

ArcLength::ArcLength(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings)
    : body_(body), solver_(solver), settings_(settings), weight_(held_movement(body)) {}

PathDirection ArcLength::unit(PathDirection d) const {
  const double length = std::sqrt(dot(d, d));
  return {d.u / length, d.f / length};
}

double ArcLength::angle(const PathDirection& a, const PathDirection& b) const {
  const PathDirection chord{a.u - b.u, a.f - b.f};
  return 2.0 * std::asin(0.5 * std::sqrt(dot(chord, chord)));
}

std::optional<PathPoint> ArcLength::point_here(const PathDirection& along) {
  const std::optional<int> unstable = solver_.factor(body_);
  if (!unstable) return {};
  PathDirection d{solver_.solve_full(body_, body_.load_direction()), 1.0};  // K du = g df
  const double length2 = dot(d, d);
  if (!std::isfinite(length2) || length2 == 0.0) return {};
  d = unit(std::move(d));
  if (dot(d, along) < 0.0) d = {-d.u, -d.f};
  return PathPoint{body_.placement(), std::move(d), *unstable, !body_.has_moment_part()};
}

// Newton's step on R = 0 that stays on the plane, by two solves with one factor:
//   K du = R + g df,  normal . (du, df) = 0.
ArcLength::Correction ArcLength::correction(const PathDirection& normal) {
  if (!solver_.factor(body_)) return {{}, "the tangent stiffness is singular"};
  const Vector a = solver_.solve_full(body_, body_.unbalanced());
  const Vector b = solver_.solve_full(body_, body_.load_direction());
  const double df = -normal.u.dot(a) / (normal.u.dot(b) + weight_ * normal.f);
  return {{a + df * b, df}, ""};
}

StepOutcome ArcLength::step(const Placement& from, const PathDirection& direction, double s) {
  StepOutcome outcome;
  body_.restore(from);
  body_.move(s * direction.u, from.load_factor + s * direction.f);
  PathDirection deviation{Vector::Zero(direction.u.size()), 0.0};
  const int most = std::min(most_corrections, settings_.iterations);
  for (;;) {
    outcome.residuals.push_back(body_.residual());
    if (balanced(body_, settings_, outcome.residuals)) break;
    if (outcome.iterations == most) outcome.why = fmt::format("no balance after {} corrections", most);
    if (!std::isfinite(outcome.residuals.back())) outcome.why = "the forces are not finite";
    if (!outcome.why.empty()) return outcome;
    Correction c = correction(direction);
    if (!c.why.empty()) {
      outcome.why = std::move(c.why);
      return outcome;
    }
    deviation.u += c.change.u;
    deviation.f += c.change.f;
    if (!(std::sqrt(dot(deviation, deviation)) <= largest_deviation * std::abs(s))) {
      outcome.why = "the balance found is far from the predicted one";
      return outcome;
    }
    body_.move(c.change.u, body_.load_factor() + c.change.f);
    ++outcome.iterations;
  }
  outcome.point = point_here(direction);
  if (!outcome.point) outcome.why = "the tangent stiffness is singular";
  return outcome;
}

double largest_bond_turn(const State& now, const Placement& before) {
  double largest = 0.0;
  for (const Bond& b : now.bonds) {
    const Quatd seen_now = conjugate(now.q[b.i]) * now.q[b.j];
    const Quatd seen_before = conjugate(before.q[b.i]) * before.q[b.j];
    const BondPose<double> pose_now = bond_pose(b, now);
    const BondPose<double> pose_before =
        bond_pose(b, before.r[b.i], before.q[b.i], before.r[b.j], before.q[b.j]);
    const Vec3d D_now = bonded_points(pose_now, b.R_i, b.R_j);
    const Vec3d D_before = bonded_points(pose_before, b.R_i, b.R_j);
    const auto of_line = [&](ParticleId p) {
      return angle_between(rotate(conjugate(now.q[p]), D_now), rotate(conjugate(before.q[p]), D_before));
    };
    largest = std::max(
        {largest, norm(rotation_vector(seen_now * conjugate(seen_before))), of_line(b.i), of_line(b.j)});
  }
  return largest;
}

std::optional<BondId> newly_snapped(const State& now, const Placement& before) {
  const auto snapped = [](const Bond& b, const BondPose<double>& pose) {
    return bond_range(b, bond_shape(pose, b.R_i, b.R_j)) == BondRange::snapped;
  };
  for (const BondId k : now.bonds.ids()) {
    const Bond& b = now.bonds[k];
    if (snapped(b, bond_pose(b, now)) &&
        !snapped(b, bond_pose(b, before.r[b.i], before.q[b.i], before.r[b.j], before.q[b.j])))
      return k;
  }
  return {};
}

}  // namespace vbond
