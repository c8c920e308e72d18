#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "vbond/model/mistakes.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/physics/bond_step.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinks.hpp"
#include "vbond/statics/detail/mass_scaled.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond {

double exact_critical_step(const Model& model, const State& state, const std::vector<Support>& supports) {
  if (!model.walls.empty())
    throw std::invalid_argument(
        "exact_critical_step: the model has walls, which the exact step does not know");
  StaticStage stage;
  for (const Support& s : supports)  // what is held less swings no slower
    if (!is_free_grip(s)) {
      Support& at_rest = stage.supports.emplace_back(s);
      at_rest.velocity = at_rest.angular_velocity = {}, at_rest.factor = {};
    }
  require_consistent("exact_critical_step", model, stage, state);
  // particles that just touch, and bonds with two slopes, swing over to their stiffer side
  const Model touching = with_what_just_touches(model, state);
  const StaticBody body(touching, stage, with_stiffer_slopes(state));
  const double nothing_swings = std::numeric_limits<double>::infinity();
  if (body.unknowns().size() == 0) return nothing_swings;
  if (!std::isfinite(max_norm(body.tangent().diagonal())))
    throw NoConvergence("the stiffness is not finite: " + body.first_not_finite());
  const double lambda =
      largest_eigenvalue(MassRoot(model, body.state(), body.unknowns()).scaled(body.tangent()));
  const double elastic = lambda > 0.0 ? critical_step(lambda) : nothing_swings;
  const bool damped = std::any_of(state.bonds.begin(), state.bonds.end(),
                                  [](const Bond& b) { return !b.broken && is_damped(b); });
  return damped ? std::min(elastic, step_bound(model, state, {}, {}, 1.0, supports).dt) : elastic;
}

}  // namespace vbond
