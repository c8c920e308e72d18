// What a case with sources and sinks cannot have.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "vbond/model/passage.hpp"
#include "vbond/setup/case_sources.hpp"
#include "vbond/setup/stage_step.hpp"

namespace vbond {

void check_stage_of_sources(const StageSpec& spec, const Model& model, Problems& problems) {
  if (model.sources.empty()) return;
  const auto refuse = [&](const std::string& group, const SourcePlace& place, const std::string& what,
                          const char* way_out) {
    if (const auto p = first_that_comes_in(group, model))
      problems.add(place, fmt::format("stage \"{}\": {} of group \"{}\"", spec.name, what, group),
                   of_source(model, *p) + ", and this is for particles that are there from the start",
                   way_out);
  };
  for (const SupportSpec& s : spec.supports)
    refuse(s.group.value, s.place, "a support", "hold a group without it, or use walls");
  for (const LoadSpec& l : spec.loads)
    if (!(l.total_force == Vec3d{}) || !(l.total_moment == Vec3d{}))
      refuse(l.group.value, l.place, "a total load",
             "use force and moment, which act on each particle that is there");
  if (spec.strain)
    refuse(spec.strain->group.value, spec.strain->place, "strain", "strain a group without it");
  if (spec.stop_distance)
    for (const std::int64_t p : spec.stop_distance->between)
      if (p >= 0 && p < static_cast<std::int64_t>(model.particles()) &&
          comes_in(model, ParticleId{static_cast<std::size_t>(p)}))
        problems.add(spec.stop_distance->place, fmt::format("stage \"{}\": stop.distance", spec.name),
                     of_source(model, ParticleId{static_cast<std::size_t>(p)}) +
                         ", and this is for particles that are there from the start",
                     "name other particles");
}

void check_case_of_sources(const Case& c, Problems& problems) {
  if (c.sources.empty() && c.sinks.empty()) return;
  const SourcePlace& place = !c.sources.empty() ? c.sources.front().place : c.sinks.front().place;
  const auto moves = [](const StageSpec& s) { return !is_static(s.kind); };
  if (std::none_of(c.stages.begin(), c.stages.end(), moves))
    problems.add(place, "a source or sink without a stage of dynamics",
                 "particles come and go in dynamics only",
                 "add a stage of kind \"dynamics\", or leave it out");
  const auto motion = std::find_if(c.stages.begin(), c.stages.end(), moves);
  for (auto s = c.stages.begin(); s != c.stages.end(); ++s) {
    if (moves(*s)) continue;
    if (!c.sources.empty() && s < motion)
      problems.add(
          s->place, fmt::format("stage \"{}\" is static, and particles wait to come in", s->name),
          "a balance is looked for with all particles",
          "let a stage of dynamics come before it in which all come in, or leave it to another case");
    else if (!c.sinks.empty() && s > motion)
      problems.add(s->place,
                   fmt::format("stage \"{}\" is static and follows one in which a sink may act", s->name),
                   "a balance is looked for with all particles", "leave the static stage to another case");
  }
  for (const StageSpec& s : c.stages)
    for (const LoadSpec& l : s.loads)
      if (!c.sinks.empty() && moves(s) && !(l.total_force == Vec3d{} && l.total_moment == Vec3d{}))
        problems.add(l.place,
                     fmt::format("stage \"{}\": a total load of group \"{}\"", s.name, l.group.value),
                     "it is shared by all particles of the group, and a sink may take some of them",
                     "use force and moment, which act on each particle that is there");
  for (const BondSpec& b : c.bonds)
    if (b.recipe.capsule)
      problems.add(place, fmt::format("bonds \"{}\" touch as capsules", b.name),
                   "capsules are not followed through the coming and going of particles",
                   "leave capsule_radius out, or source and sink to a case without capsules");
  if (step_is_exact(c))
    problems.add(c.time.step->place, "time.step = \"exact\"",
                 "bodies still come in or go, which the exact step does not know",
                 "leave step out: the automatic one counts their bonds");
}

void check_output_of_sources(const Case& c, const Model& model, Problems& problems) {
  if (model.sources.empty()) return;
  const SourcePlace file{c.file, 0, 0};
  for (const auto& name : c.output.displacements) {
    std::optional<ParticleId> wrong = first_that_comes_in(name.value, model);
    if (model.find_group(name.value) == nullptr && name.value.size() < 10 &&
        name.value.find_first_not_of("0123456789") == std::string::npos && !name.value.empty())
      if (const ParticleId p{static_cast<std::size_t>(std::stoul(name.value))};
          p.value < model.particles() && comes_in(model, p))
        wrong = p;
    if (wrong)
      problems.add(name.place, fmt::format("output.history.displacements: \"{}\"", name.value),
                   of_source(model, *wrong) + ": it has no place at the start to be displaced from",
                   "name a group without it, or use velocities");
  }
  for (const StressSpec& s : c.output.stresses)
    if (std::holds_alternative<StressVolume>(s.volume))
      if (const auto p = first_that_comes_in(s.group.value, model))
        problems.add(
            s.place, fmt::format("output.history.stress of group \"{}\"", s.group.value),
            of_source(model, *p) + ": the volume that the group takes up at the start does not count it",
            "give the volume as a number");
}

}  // namespace vbond
