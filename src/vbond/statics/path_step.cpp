#include "vbond/statics/detail/path_step.hpp"

#include <algorithm>
#include <cmath>

#include "vbond/statics/detail/eigen.hpp"

namespace vbond {

namespace {

/// The eigenvalue with this number in increasing order, from 0, where `negative` of them are negative.
double eigenvalue_by_number(const SparseMatrix& A, int number, int negative) {
  for (int count = 2;; count *= 2) {
    Vector near = eigenpairs_near_zero(A, std::min(count, static_cast<int>(A.rows()))).values;
    std::sort(near.begin(), near.end());
    const auto below = std::count_if(near.begin(), near.end(), [](double x) { return x < 0.0; });
    const std::ptrdiff_t at = number - negative + below;
    if (at >= 0 && at < near.size()) return near[at];
    if (near.size() == A.rows()) return number < negative ? near[0] : near[near.size() - 1];
  }
}

}  // namespace

StepOutcome PathStep::to(double s) {
  StepOutcome outcome = arc_.step(start_.at, direction_, s);
  iterations_ += outcome.iterations;
  if (outcome.point) last_residuals_ = outcome.residuals;
  return outcome;
}

std::optional<PathNode> PathStep::zero_of(const Value& value, const PathNode& lo, const PathNode& hi,
                                          double small) {
  return zero_between({lo.s, value(lo.point)}, {hi.s, value(hi.point)}, value, small);
}

std::optional<PathNode> PathStep::zero_between(const Sample& lo, const Sample& hi, const Value& value,
                                               double small) {
  const double s = crossing(lo, hi, small, [&](double at) -> std::optional<double> {
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

// Of all eigenvalues in increasing order the one that is the first to change its sign, by number. Its sign
// is told by the number of negative ones. At an end of the stretch another one may have just vanished, so
// that the number is not to be had from the matrix: there the size is no guide if it is small.
std::optional<PathNode> PathStep::critical_point(const PathNode& lo, const PathNode& hi) {
  const bool softens = hi.point.unstable > lo.point.unstable;
  const int number = softens ? lo.point.unstable : lo.point.unstable - 1;  // from 0
  const auto eigenvalue = [this, number](const PathPoint& p) {
    body_.restore(p.at);
    return std::copysign(eigenvalue_by_number(body_.tangent(), number, p.unstable),
                         number - p.unstable + 0.5);
  };
  Sample a{lo.s, eigenvalue(lo.point)}, b{hi.s, eigenvalue(hi.point)};
  const double scale = std::max(std::abs(a.value), std::abs(b.value));
  for (Sample* end : {&a, &b})
    end->value = std::copysign(std::max(std::abs(end->value), 0.01 * scale), end->value);
  return zero_between(a, b, eigenvalue, 1e-10 * scale);
}

int PathStep::unstable_beside(const PathNode& special, double s, const PathNode& end) {
  const bool within = special.s < end.s ? s < end.s : s > end.s;
  if (!within) return end.point.unstable;
  const StepOutcome outcome = to(s);
  return outcome.point ? outcome.point->unstable : end.point.unstable;
}

}  // namespace vbond
