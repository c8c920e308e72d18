#include <fmt/format.h>

#include <stdexcept>

#include "vbond/setup/case_cell.hpp"
#include "vbond/setup/case_sources.hpp"
#include "vbond/setup/motion_stages.hpp"
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/setup_terms.hpp"

namespace vbond {
namespace {

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
void check_something_is_free(const StageResolver& resolver, const std::vector<Support>& supports) {
  if (resolver.spec.kind == StageKind::equilibrium || resolver.spec.kind == StageKind::fracture) return;
  if (resolver.anything_is_free(supports)) return;
  resolver.problems.add(
      resolver.spec.place, fmt::format("stage \"{}\": supports hold everything", resolver.spec.name),
      "paths, critical loads and modes are of degrees of freedom that are free", "take something out of fix");
}

/// Faces without friction hold nothing along themselves: what they carry is no sign that a body is held.
void refuse_smooth_joints(const Case& c, const StageSpec& spec, Problems& problems) {
  for (const BondSpec& set : c.bonds)
    if (const Rubbing& rubbing = set.recipe.rules.rubbing; rubbing.any() && rubbing.friction == 0.0)
      problems.add(set.place, fmt::format("bonds \"{}\": flat_joint.friction = 0", set.name),
                   fmt::format("stage \"{}\" is at rest: grains slide freely along cracked faces without "
                               "friction, so that no balance could be told from none",
                               spec.name),
                   "use friction > 0, or stages of dynamics, or leave friction out: broken cells then carry "
                   "nothing");
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
  refuse_smooth_joints(c, spec, problems);
  check_stage_of_sources(spec, model, problems);
  stage.supports = resolver.supports();
  resolve_terms(resolver, stage);
  check_something_is_free(resolver, stage.supports);
  stage.loads = resolver.loads();
  stage.cell = resolver.cell_drive();
  stage.waves = waves_of(spec);
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

StaticStage build_static_stage(const Case& c, const Model& model, int k, State& state, int threads) {
  Problems problems;
  const auto index = static_cast<std::size_t>(k);
  if (!is_static(c.stages.at(index).kind))
    throw std::logic_error("build_static_stage: the stage is of kind dynamics");
  StaticStage stage = resolve_static_stage(c, model, index, problems);
  problems.throw_if_any();
  const bool begins = state.clock.stage_step == 0;  // else under way: its bonds have been made
  if (begins) add_stage_bonds(c, index, model, state, problems, threads);
  if (begins) refuse_turned_through_face(c.stages[index], stage.supports, state, false, problems);
  complete_terms({c, model, c.stages[index], problems}, state, stage);
  if (begins && problems.none()) refuse_nothing_elastic(c.stages[index], model, state, problems);
  problems.throw_if_any();
  return stage;
}

}  // namespace vbond
