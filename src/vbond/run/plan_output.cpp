#include "vbond/run/plan_output.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/rules.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {
namespace {

/// Without dynamics there are no intervals, and what they are in need not be known.
double output_time(const CaseTime& time, const Model& model, const char* key, const Case& c) {
  if (!c.any_dynamics()) return std::numeric_limits<double>::infinity();
  return resolve_time(time, model, key, {c.file, 0, 0});
}

/// Groups with the volumes that they take up.
std::vector<StressedGroup> stressed_groups(const Case& c, const Model& model) {
  std::vector<StressedGroup> groups;
  for (const StressSpec& s : c.output.stresses) {
    const auto* by = std::get_if<StressVolume>(&s.volume);
    groups.push_back({resolve_groups({s.group}, model).front(), resolve_volume(s, model),
                      by != nullptr && *by == StressVolume::spheres});
  }
  return groups;
}

/// Groups that stages give to terms with columns of their own, each once.
std::map<std::string, std::vector<Group>> groups_of_terms(const Case& c, const Model& model) {
  std::map<std::string, std::vector<Group>> all;
  Terms::for_each([&]<class T>(T) {
    std::set<std::string> known;
    for (const StageSpec& stage : c.stages)
      for (const std::string& name : T::groups_in_history(stage))
        if (const Group* g = model.find_group(name); g != nullptr && known.insert(name).second)
          all[T::key].push_back(*g);
  });
  return all;
}

/// What may dissipate energy in this case.
std::vector<Loss> possible_losses(const Case& c, const Model& model) {
  const auto bonds = [&c](auto has) { return std::any_of(c.bonds.begin(), c.bonds.end(), has); };
  const auto rules = [&](auto has) { return bonds([&](const BondSpec& b) { return has(b.recipe.rules); }); };
  const auto damped = [&](std::size_t channel) {
    return bonds([=](const BondSpec& b) {
      return b.recipe.damping.by != DampingBy::none && b.recipe.damping.values[channel] > 0.0;
    });
  };
  const auto stages = [&c](auto has) { return std::any_of(c.stages.begin(), c.stages.end(), has); };
  const ContactModel& contact = model.contact;
  const bool touches = contact.law != ContactLaw::none && c.any_dynamics() &&
                       (!is_elastic(contact, model.materials) || !model.walls.empty());
  const std::pair<Loss, bool> all[] = {
      {Loss::damping_axial, damped(0)},
      {Loss::damping_shear, damped(1)},
      {Loss::damping_bending, damped(2)},
      {Loss::damping_torsion, damped(3)},
      {Loss::yield_axial, rules([](const BondRules& r) { return r.yield.limit.axial > 0.0; })},
      {Loss::yield_shear, rules([](const BondRules& r) { return r.yield.limit.shear > 0.0; })},
      {Loss::yield_bending, rules([](const BondRules& r) { return r.yield.limit.bending > 0.0; })},
      {Loss::yield_torsion, rules([](const BondRules& r) { return r.yield.limit.torsion > 0.0; })},
      {Loss::creep, rules([](const BondRules& r) { return r.creep.rate > 0.0; })},
      {Loss::softening, rules([](const BondRules& r) { return r.softening.any(); })},
      {Loss::drag, stages([](const StageSpec& s) { return s.b_translation > 0.0 || s.b_rotation > 0.0; })},
      {Loss::local_damping, stages([](const StageSpec& s) { return s.local_damping > 0.0; })},
      {Loss::contact_damping, touches},
      {Loss::friction, (touches && contact.tangential != TangentialForm::none) ||
                           rules([](const BondRules& r) { return r.rubbing.friction > 0.0; })},
      {Loss::rolling, touches && contact.rolling != RollingForm::none},
      {Loss::adhesion, touches && contact.adhesion != AdhesionForm::none},
      {Loss::bonding, particles_touch(contact) && contact.pairs == ContactPairs::unbonded &&
                          bonds([](const BondSpec& b) { return b.when != BondTime::start; })}};
  std::vector<Loss> possible;
  for (const auto& [cause, may_be] : all)
    if (may_be) possible.push_back(cause);
  return possible;
}

}  // namespace

bool any_statics(const Case& c) {
  return std::any_of(c.stages.begin(), c.stages.end(), [](const StageSpec& s) { return is_static(s.kind); });
}

OutputPlan plan_output(const Case& c, const Model& model, const std::filesystem::path& folder) {
  const OutputSpec& o = c.output;
  OutputPlan plan;
  plan.folder = folder;
  plan.units = model.units;
  plan.history_every = output_time(o.history_every, model, "output.history.every", c);
  plan.reactions = resolve_groups(o.reactions, model);
  plan.axial_force = resolve_groups(o.axial_force, model);
  plan.displacements = resolve_groups_or_particles(o.displacements, "displacements", model);
  plan.velocities = resolve_groups_or_particles(o.velocities, "velocities", model);
  plan.stresses = stressed_groups(c, model);
  for (const Wall& w : model.walls) plan.walls.push_back(w.name);
  for (const StageSpec& stage : c.stages)
    for (const SupportSpec& s : stage.supports)
      if (s.rigid && std::find(plan.grips.begin(), plan.grips.end(), s.group.value) == plan.grips.end())
        plan.grips.push_back(s.group.value);
  plan.of_terms = groups_of_terms(c, model);
  if (o.frames)
    plan.frames_every = o.frames->every ? output_time(*o.frames->every, model, "output.frames.every", c)
                                        : std::numeric_limits<double>::infinity();
  if (o.frames) plan.frame_format = {o.frames->single_precision, o.frames->compressed, o.frames->stress};
  if (o.frames) plan.frame_format.contacts = o.frames->contacts;
  if (o.frames) plan.frame_format.wrap = o.frames->wrap;
  plan.frame_format.cell_shears = std::any_of(c.stages.begin(), c.stages.end(), [](const StageSpec& s) {
    return s.cell && std::any_of(s.cell->component.begin() + 3, s.cell->component.end(),
                                 [](const auto& component) { return component.has_value(); });
  });
  plan.lammps_dump = o.lammps_dump;
  if (o.checkpoint_every)  // where nothing moves time is the number of the balance
    plan.checkpoint_every = c.any_dynamics()
                                ? output_time(*o.checkpoint_every, model, "output.checkpoint.every", c)
                                : o.checkpoint_every->resolve(1.0);
  plan.statics = any_statics(c);
  plan.cell = model.cell.any();
  plan.passage = !c.sources.empty() || !c.sinks.empty();
  const bool drops = c.watch.on_unphysical == OnUnphysical::drop || !c.sinks.empty();
  plan.breaks = std::any_of(c.bonds.begin(), c.bonds.end(),
                            [drops](const BondSpec& b) { return drops || b.recipe.rules.can_break(); });
  plan.capsules =
      std::any_of(c.bonds.begin(), c.bonds.end(), [](const BondSpec& b) { return b.recipe.capsule; });
  plan.flow =
      std::any_of(c.bonds.begin(), c.bonds.end(), [](const BondSpec& b) { return b.recipe.rules.flow(); });
  plan.losses = possible_losses(c, model);
  plan.watch_every = c.watch.every;
  plan.overlap = c.watch.overlap;
  plan.energy_error = c.watch.energy_error;
  return plan;
}

}  // namespace vbond
