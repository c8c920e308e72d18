#include <fmt/format.h>

#include <stdexcept>

#include "vbond/build/stage_resolver.hpp"
#include "vbond/build/stages.hpp"
#include "vbond/build/walls.hpp"

namespace vbond {
namespace {

std::vector<StaticSupport> supports(const StageResolver& resolver) {
  std::vector<StaticSupport> resolved;
  for (const SupportSpec& s : resolver.spec.supports) {
    const HeldDirections d = directions_of(s);
    resolved.push_back({s.group.value, resolver.particles(s.group), d.held, s.displacement, s.rotation,
                        s.rigid, s.pivot, d.axes});
  }
  resolver.check_supports(resolved);
  return resolved;
}

std::vector<StaticLoad> loads(const StageResolver& resolver) {
  std::vector<StaticLoad> resolved;
  for (const LoadSpec& l : resolver.spec.loads) {
    StaticLoad load{l.group.value, resolver.particles(l.group), l.force, l.moment, l.constant};
    load.force_by_mass = l.total_force / resolver.mass_of(load.particles);
    load.moment_by_mass = l.total_moment / resolver.mass_of(load.particles);
    load.follower = l.follower;
    resolved.push_back(std::move(load));
  }
  return resolved;
}

/// What depends on the way by which an equilibrium is reached has no balance of its own.
void refuse_contacts(const StageResolver& resolver) {
  const std::string key = key_without_balance(resolver.model.contact);
  if (key.empty()) return;
  resolver.problems.add(
      resolver.spec.place,
      fmt::format("stage \"{}\" is static, and contacts do more than repel: {}", resolver.spec.name, key),
      "static stages take contacts that repel along the normal, without adhesion; friction and damping rest",
      "leave it out, or use kind = \"dynamics\" with damping");
}

/// A body that is held altogether has no modes, and no load makes it unstable. It may break.
void check_something_is_free(const StageResolver& resolver, const std::vector<StaticSupport>& supports) {
  if (resolver.spec.kind == StageKind::equilibrium || resolver.spec.kind == StageKind::fracture) return;
  if (resolver.anything_is_free(supports)) return;
  resolver.problems.add(
      resolver.spec.place, fmt::format("stage \"{}\": supports hold everything", resolver.spec.name),
      "paths, critical loads and modes are of degrees of freedom that are free", "take something out of fix");
}

}  // namespace

StaticStage resolve_static_stage(const Case& c, const Model& model, std::size_t k, Problems& problems) {
  const StageSpec& spec = c.stages.at(k);
  const StageResolver resolver{c, model, spec, problems};
  StaticStage stage;
  stage.name = spec.name;
  stage.kind = spec.kind;
  stage.gravity = spec.gravity;
  stage.constant_gravity = spec.constant_gravity;
  refuse_contacts(resolver);
  stage.supports = supports(resolver);
  stage.walls = resolve_static_wall_drives(resolver);
  check_something_is_free(resolver, stage.supports);
  stage.loads = loads(resolver);
  resolver.check_temperatures();
  for (const TemperatureSpec& t : spec.temperatures)
    stage.heating.push_back({resolver.particles(t.group), t.change});
  stage.newton = spec.newton;
  stage.steps = spec.steps;
  stage.at_saddle = spec.at_saddle;
  stage.path = spec.path;
  if (spec.stop_distance) stage.path.distance = resolver.distance_stop(*spec.stop_distance);
  stage.fracture = spec.fracture;
  if (spec.stop_breaks) stage.fracture.most_breaks = static_cast<int>(spec.stop_breaks->count);
  stage.search_to = spec.search_to;
  stage.count = spec.count;
  stage.frames_per_mode = spec.frames_per_mode;
  stage.amplitude = spec.amplitude;
  return stage;
}

void refuse_nothing_elastic(const StageSpec& spec, const Model& model, const State& state,
                            Problems& problems) {
  if (state.bonds.empty() && model.contact.law == ContactLaw::none)
    problems.add(spec.place, fmt::format("stage \"{}\": nothing is elastic", spec.name),
                 "there are no bonds and no contacts, so no load is in balance with anything",
                 "add a table [[bonds]] or [contact]");
}

StaticStage build_static_stage(const Case& c, const Model& model, int k, State& state) {
  Problems problems;
  const auto index = static_cast<std::size_t>(k);
  if (!is_static(c.stages.at(index).kind))
    throw std::logic_error("build_static_stage: the stage is of kind dynamics");
  StaticStage stage = resolve_static_stage(c, model, index, problems);
  problems.throw_if_any();
  if (state.clock.stage_step > 0) return stage;  // under way: its bonds have been made
  add_stage_bonds(c, index, model, state, problems);
  if (problems.none()) refuse_nothing_elastic(c.stages[index], model, state, problems);
  problems.throw_if_any();
  return stage;
}

}  // namespace vbond
