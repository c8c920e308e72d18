#include "vbond/setup/detail/build_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/setup/bond_pairs.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/motion_stages.hpp"
#include "vbond/setup/stage_step.hpp"

namespace vbond {

namespace {

/// Whether one of some particles is nearer than this to one of a higher number.
bool any_together(const Model& model, const State& state, double distance, const PerParticle<char>& some) {
  const std::vector<char> all(model.particles(), 1);
  try {
    return !pairs_within(model, state, {distance, 0.0}, all, all, 1.0, some).empty();
  } catch (const std::length_error&) {  // more than one
    return true;
  }
}

}  // namespace

void check_distinct(const Case& c, const Model& model, const State& state, const PerParticle<char>* some,
                    Problems& problems) {
  constexpr std::size_t enough = 1000;  // of many particles at one place all pairs would take hours
  std::size_t found = 0, first_i = 0, first_j = 0;
  Image of_j;
  const CellEdges cell = cell_at_start(model);
  const double size = box_around(model.r_0).diagonal();
  if (some != nullptr && !any_together(model, state, 1e-9 * size, *some)) return;
  for_near_images(cell, model.cell.periodic, model.r_0.values(), 1e-9 * size,
                  [&](std::size_t i, std::size_t j, const Image& n, double) {
                    if (!stood_together(model, ParticleId{i}, ParticleId{j})) return true;
                    if (found++ == 0) first_i = i, first_j = j, of_j = n;
                    return found < enough;
                  });
  if (found == 0) return;
  const SourcePlace& place = c.specimens[model.specimen[ParticleId{first_j}]].place;
  const std::string pairs = fmt::format("{} such pairs{}", found, found < enough ? "" : " at least");
  const double apart = norm(between(model.r_0, cell, ParticleId{first_i}, ParticleId{first_j}, of_j));
  if (apart == 0.0)
    problems.add(
        place, fmt::format("particles {} and {} are at the same place ({})", first_i, first_j, pairs),
        "no bond or contact can be set up between them", "move a specimen or remove the double particles");
  else
    problems.add(place,
                 fmt::format("particles {} and {} are {:.6g} apart in a case that is {:.6g} wide ({})",
                             first_i, first_j, apart, size, pairs),
                 "below 1e-9 of the size of the case no direction can be told from two places",
                 "remove double particles, or move specimens that are far away");
}

void check_contact(const Case& c, const Model& model, Problems& problems) {
  if (c.contact.law == ContactLaw::none) return;
  for (const ParticleId p : model.radius.ids())
    if (!(model.radius[p] > 0.0))
      return problems.add(c.specimens[model.specimen[p]].place,
                          fmt::format("contact: particle {} has radius {}", p.value, model.radius[p]),
                          "contacts need radii > 0", "give every specimen a radius, or leave out [contact]");
}

namespace {

/// The rigid bodies of each stage.
std::vector<RigidBodies> bodies_of_stages(const Case& c, const Model& model) {
  std::vector<RigidBodies> of_stages;
  for (const StageSpec& stage : c.stages) {
    std::vector<Support> rigid;
    for (const SupportSpec& s : stage.supports)
      for (const Group& g : model.groups)
        if (s.rigid && g.name == s.group.value) {
          Support& body = rigid.emplace_back();
          body.particles = g.particles, body.rigid = true;
        }
    of_stages.emplace_back(model.particles(), carried_by(rigid));
  }
  return of_stages;
}

}  // namespace

void check_overlaps(const Case& c, const Built& built, const BodyPart& body, Problems& problems) {
  constexpr double most = 0.5;  // of the smaller radius, as for walls
  const auto later = [](const BondSpec& b) { return b.when != BondTime::start; };
  if (std::any_of(c.bonds.begin(), c.bonds.end(), later)) return;
  const PerParticle<double>& R = built.model.radius;
  struct Deep {
    ParticleId i, j;
    Image of_j;
    double part;
    auto pair() const { return std::tuple(i, j, of_j); }
  };
  std::vector<Deep> deep;
  for_touching_pairs(built.model, body, [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
    const double part = overlap / std::min(R[i], R[j]);
    if (part > most * (1.0 + 1e-9)) deep.push_back({i, j, n, part});
  });
  if (deep.empty()) return;
  const std::vector<RigidBodies> of_stages = bodies_of_stages(c, built.model);
  std::erase_if(deep, [&of_stages](const Deep& d) {  // they never touch
    return !of_stages.empty() && std::all_of(of_stages.begin(), of_stages.end(), [&d](const RigidBodies& b) {
      return b.are_one(d.i, d.j, d.of_j);
    });
  });
  std::set<std::tuple<ParticleId, ParticleId, Image>> pairs, bonded;
  for (const Deep& d : deep) pairs.insert(d.pair());
  body.for_bonded([&](ParticleId i, ParticleId j, const Image& n, bool) {  // seen from either end
    for (const auto& pair : {std::tuple(i, j, n), std::tuple(j, i, -n)})
      if (pairs.count(pair) > 0) bonded.insert(pair);
  });
  struct {
    double part = 0;
    ParticleId i, j;
    std::size_t count = 0;
  } worst;
  for (const Deep& d : deep) {
    if (bonded.count(d.pair()) > 0) continue;
    ++worst.count;
    if (d.part > worst.part) worst.part = d.part, worst.i = d.i, worst.j = d.j;
  }
  if (worst.count == 0) return;
  problems.add(
      c.specimens[built.model.specimen[worst.j]].place,
      fmt::format("particles {} and {}, which are not bonded, overlap by {:.3g} of the smaller radius "
                  "({} such pairs)",
                  worst.i.value, worst.j.value, worst.part, worst.count),
      fmt::format("at the start particles that touch overlap by at most {} of it", most),
      "move a specimen, use smaller radii, bond them, or contact.pairs = \"none\"");
}

void check_durations(const Case& c, const Built& built, Problems& problems) {
  const double dt = expected_step(c, built.model, built.body());
  if (!(dt > 0.0)) return;
  for (const StageSpec& s : c.stages)
    if (!is_static(s.kind)) check_number_of_steps(s, s.duration.resolve(built.model.T_0), dt, problems);
}

void check_output(const Case& c, const Model& model, Problems& problems) {
  for (const auto& name : c.output.reactions) look_up_group(name, model, problems);
  for (const auto& name : c.output.axial_force) look_up_group(name, model, problems);
  look_up_groups_or_particles(c.output.displacements, "displacements", model, problems);
  look_up_groups_or_particles(c.output.velocities, "velocities", model, problems);
  for (const StressSpec& s : c.output.stresses) look_up_volume(s, model, problems);
  const SourcePlace place{c.file, 0, 0};
  if (c.output.frames && c.output.frames->stress)
    for (const ParticleId p : model.radius.ids())
      if (!(model.radius[p] > 0.0)) {
        problems.add(c.specimens[model.specimen[p]].place,
                     fmt::format("output.frames.stress: particle {} has no radius", p.value),
                     "its stress has no volume to divide by",
                     "give the particles a radius, or write history.stress of a group with a volume");
        break;
      }
  if (c.output.frames && c.output.frames->contacts && c.contact.law == ContactLaw::none)
    problems.add({c.file, 0, 0}, "output.frames.contacts = true",
                 "nothing touches: the case has no [contact]", "add [contact], or leave it out");
  if (!c.any_dynamics()) return;  // no stage has intervals
  look_up_time(c.output.history_every, model, "output.history.every", place, problems);
  if (c.output.frames && c.output.frames->every)
    look_up_time(*c.output.frames->every, model, "output.frames.every", place, problems);
  if (c.output.checkpoint_every)
    look_up_time(*c.output.checkpoint_every, model, "output.checkpoint.every", place, problems);
}

}  // namespace vbond
