#include "vbond/statics/detail/path_step.hpp"

#include <algorithm>
#include <cmath>

#include "vbond/statics/detail/crossing.hpp"
#include "vbond/statics/detail/eigen.hpp"

namespace vbond {

StepOutcome PathStep::to(double s) {
  StepOutcome outcome = arc_.step(start_.at, direction_, s);
  iterations_ += outcome.iterations;
  if (outcome.point) last_residuals_ = outcome.residuals;
  return outcome;
}

std::optional<PathNode> PathStep::zero_of(const Value& value, const PathNode& lo, const PathNode& hi,
                                          double small) {
  const Sample a{lo.s, value(lo.point)}, b{hi.s, value(hi.point)};
  const double s = crossing(a, b, small, [&](double at) -> std::optional<double> {
    const StepOutcome outcome = to(at);
    if (!outcome.point) return std::nullopt;
    return value(*outcome.point);
  });
  for (const double aside : {0.0, -1e-9, 1e-9, -1e-7, 1e-7}) {  // over the length between the two
    const double at = s + aside * (hi.s - lo.s);
    if (StepOutcome outcome = to(at); outcome.point) return PathNode{at, std::move(*outcome.point)};
  }
  return {};
}

std::optional<PathNode> PathStep::limit_point(const PathNode& lo, const PathNode& hi) {
  const auto slope = [](const PathPoint& p) { return p.tangent.f; };
  // at 1e-8 of the slope at the ends the load factor is off by 1e-16 of its change
  return zero_of(slope, lo, hi, 1e-8 * std::max(std::abs(slope(lo.point)), std::abs(slope(hi.point))));
}

// Of all eigenvalues in increasing order the one that is the first to change its sign, by number: the number
// of negative ones tells its sign, and near zero it is the one that is nearest to zero.
std::optional<PathNode> PathStep::critical_point(const PathNode& lo, const PathNode& hi) {
  const bool softens = hi.point.unstable > lo.point.unstable;
  const int number = softens ? lo.point.unstable : lo.point.unstable - 1;  // from 0
  const auto eigenvalue = [this, number](const PathPoint& p) {
    body_.restore(p.at);
    return std::copysign(eigenpairs_near_zero(body_.tangent(), 1).values[0], number - p.unstable + 0.5);
  };
  const double scale = std::max(std::abs(eigenvalue(lo.point)), std::abs(eigenvalue(hi.point)));
  return zero_of(eigenvalue, lo, hi, 1e-10 * scale);
}

int PathStep::unstable_beside(const PathNode& special, double s, const PathNode& end) {
  const bool within = special.s < end.s ? s < end.s : s > end.s;
  if (!within) return end.point.unstable;
  const StepOutcome outcome = to(s);
  return outcome.point ? outcome.point->unstable : end.point.unstable;
}

}  // namespace vbond
