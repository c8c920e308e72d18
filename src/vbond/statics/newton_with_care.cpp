#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "vbond/statics/detail/newton.hpp"

namespace vbond {
namespace {

constexpr double largest_change_with_care = 0.5;  // of bonds in a step, as in minimise()  [rad]
constexpr int most_halvings = 12;

/// A part of the correction x after which the next one, by the same tangent, is the shorter. Nothing if none
/// of those tried is; the body is then where it was.
bool step_with_care(StaticBody& body, const TangentSolver& solver, const Vector& x) {
  const Placement from = body.placement();
  const double change = larger(body.largest_bond_change(x), body.largest_wall_change(x));
  if (!std::isfinite(change)) return false;
  double part = change > largest_change_with_care ? largest_change_with_care / change : 1.0;
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
  NewtonOutcome outcome;
  const auto no_further = [&](const std::string& why) {
    outcome.converged = body.residual() <= 100.0 * body.residual_of_rounding();
    outcome.why = fmt::format("{}, at an unbalanced force of {:.2g} of the largest", why, body.residual());
    return outcome;
  };
  for (int k = 0; k <= settings.iterations; ++k) {
    outcome.residuals.push_back(body.residual());
    if (balanced(body, settings, outcome.residuals)) {
      outcome.converged = true;
      return outcome;
    }
    if (interrupted && interrupted()) {
      outcome.interrupted = true;
      outcome.why = "interrupted";
      return outcome;
    }
    if (!std::isfinite(outcome.residuals.back())) {
      outcome.why = body.first_not_finite();
      return outcome;
    }
    if (!solver.take_full(body)) return no_further("the tangent is singular");
    const Vector x = solver.solve_as_taken(body.unbalanced());
    if (!x.allFinite() || !step_with_care(body, solver, x))
      return no_further("no step brings the body nearer to balance");
  }
  outcome.why = fmt::format("{} iterations, unbalanced force {:.2g} of the largest", settings.iterations,
                            outcome.residuals.back());
  return outcome;
}

}  // namespace vbond
