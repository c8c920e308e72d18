#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "vbond/statics/detail/newton.hpp"

namespace vbond {
namespace {

constexpr int most_halvings = 12;

/// A part of the correction x after which the next one, by the same tangent, is the shorter. Nothing if none
/// of those tried is; the body is then where it was.
bool step_with_care(StaticBody& body, const TangentSolver& solver, const Vector& x) {
  const Placement from = body.placement();
  const double change = change_of(body, x);
  if (!std::isfinite(change)) return false;
  double part = change > largest_change ? largest_change / change : 1.0;
  for (int k = 0; k <= most_halvings; ++k, part *= 0.5) {
    body.restore(from);
    body.move(part * x, from.load_factor);
    const Vector& left = body.unbalanced();
    if (left.allFinite() && solver.solve_as_taken(left).norm() <= (1.0 - 0.25 * part) * x.norm()) return true;
  }
  body.restore(from);
  return false;
}

}  // namespace

NewtonOutcome correct_with_care(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                                const std::function<bool()>& interrupted) {
  const auto no_further = [&](const char* why) {
    return NewtonStop{
        fmt::format("{}, at an unbalanced force of {:.2g} of the largest", why, body.residual()),
        close_to_rounding(body)};
  };
  const NewtonStep step = [&](const std::vector<double>&) -> std::optional<NewtonStop> {
    if (!solver.take_full(body)) return no_further("the tangent is singular");
    const Vector x = solver.solve_as_taken(body.unbalanced());
    if (!x.allFinite() || !step_with_care(body, solver, x))
      return no_further("no step brings the body nearer to balance");
    return {};
  };
  return iterate(body, settings, interrupted, step);
}

}  // namespace vbond
