#include "vbond/statics/detail/kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {

void refuse_nothing_free(const StaticBody& body) {
  if (body.unknowns().size() > 0) return;
  throw NoEquilibrium(body.stage().name, "nothing is free to move",
                      "paths, critical loads and modes are of degrees of freedom that are free: hold fewer");
}

void refuse_rigid_motions(const StaticBody& body) {
  const RigidMotions free = free_rigid_motions(body.model(), body.state(), body.unknowns());
  if (free.names.empty()) return;
  std::string text;
  constexpr std::size_t named = 6;
  for (std::size_t k = 0; k < std::min(named, free.names.size()); ++k)
    text += (k > 0 ? ", " : "") + free.names[k];
  if (free.names.size() > named) text += fmt::format(" and {} more", free.names.size() - named);
  throw NoEquilibrium(
      body.stage().name, "parts of the body can move freely: " + text,
      "a support may be missing; a motion that no load drives can be held on one particle, such "
      "as the spin of a rod along x by fix = [\"rx\"]; kind = \"modes\" takes free bodies as they are");
}

void refuse_not_finite(const StaticBody& body) {
  if (body.places_are_finite() && std::isfinite(body.residual()) && std::isfinite(body.energies().total()))
    return;
  throw NoEquilibrium(
      body.stage().name,
      fmt::format("at load factor {:.6g}: {}", body.load_factor(), body.first_not_finite()),
      "particles that are bonded must stand apart, and loads and stiffnesses be far from the largest number");
}

void report_point(StaticBody& body, PointKind kind, std::optional<int> unstable, const StaticHooks& hooks,
                  StaticResult& result) {
  refuse_not_finite(body);
  ++body.clock().step;
  ++body.clock().stage_step;
  ++result.points;
  result.load_factor = body.load_factor();
  if (hooks.point)
    hooks.point({body.state(), body.load_factor(), kind, unstable, body.energies(),
                 [&body](const std::vector<ParticleId>& particles) { return body.reaction(particles); }});
}

StaticOutcome interrupted_outcome(StaticResult result, State state) {
  result.ended = "interrupted";
  state.v.assign(state.r.size(), {});
  state.omega.assign(state.r.size(), {});
  return {std::move(result), std::move(state)};
}

StaticOutcome run_from_constant_loads(const Model& model, const StaticStage& stage, State state,
                                      const StaticHooks& hooks, const RunFromBalance& run) {
  StaticResult result;
  try {
    std::optional<State> balanced = balance_of_constant_loads(model, stage, state, hooks, result);
    if (!balanced) return interrupted_outcome(std::move(result), std::move(state));
    State end = run(std::move(*balanced), result);
    return {std::move(result), std::move(end)};
  } catch (const NoEquilibrium& e) {
    throw StaticStageFailed(e, std::move(result));
  }
}

}  // namespace vbond
