#include "vbond/setup/stage_resolver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "vbond/core/nearest.hpp"
#include "vbond/model/agreement.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/motion_stages.hpp"

namespace vbond {
namespace {

/// Every stage named by a bond set exists.
void check_stage_names(const Case& c, Problems& problems) {
  std::vector<std::string> known;
  for (const StageSpec& s : c.stages) known.push_back(s.name);
  for (const BondSpec& b : c.bonds)
    for (const auto& name : b.stages)
      if (std::find(known.begin(), known.end(), name.value) == known.end()) {
        const auto near = nearest_name(name.value, known);
        problems.add(name.place, fmt::format("there is no stage \"{}\"", name.value),
                     fmt::format("known stages: {}", fmt::join(known, ", ")),
                     near ? fmt::format("did you mean \"{}\"?", *near) : "use one of them");
      }
}

}  // namespace

double look_up_time(const CaseTime& time, const Model& model, const std::string& what,
                    const SourcePlace& place, Problems& problems) {
  if (time.in_T_0 && !(model.T_0 > 0.0))
    problems.add(place, fmt::format("{} = {} T0", what, time.value),
                 "without any bond there is no T0 = 2 pi sqrt(m / c_A)", "give it in seconds");
  return time.resolve(model.T_0);
}

double resolve_time(const CaseTime& time, const Model& model, const std::string& what,
                    const SourcePlace& place) {
  Problems problems;
  const double resolved = look_up_time(time, model, what, place, problems);
  problems.throw_if_any();
  return resolved;
}

std::vector<ParticleId> StageResolver::particles(const Placed<std::string>& group) const {
  const Group* g = look_up_group(group, model, problems);
  if (g == nullptr) return {};
  return g->particles;
}

std::optional<DistanceStop> StageResolver::distance_stop(const DistanceStopSpec& s) const {
  const auto i = look_up_particle(s.between[0], model, "stop.distance", s.place, problems);
  const auto j = look_up_particle(s.between[1], model, "stop.distance", s.place, problems);
  if (!i || !j) return std::nullopt;
  if (i == j)
    problems.add(s.place, fmt::format("stop.distance between particle {} and itself", i->value),
                 "a distance is between two particles", "name two different ones");
  return DistanceStop{*i, *j, s.value, s.below};
}

TimeFunction StageResolver::function(const TimeFunctionSpec& f, const SourcePlace& place) const {
  TimeFunction resolved;
  for (const auto& [t, factor] : f.points) {
    const double at = look_up_time(t, model, "factor", place, problems);
    if (!resolved.points.empty() && !(at > resolved.points.back().t))
      problems.add(place,
                   fmt::format("the factor's time {} does not come after {}", at, resolved.points.back().t),
                   "the times of a table increase", "sort the points");
    resolved.points.push_back({at, factor});
  }
  return resolved;
}

double StageResolver::time(const CaseTime& t, const char* what, const SourcePlace& place) const {
  return look_up_time(t, model, what, place, problems);
}

double StageResolver::positive_time(const CaseTime& t, const char* what, const SourcePlace& place) const {
  if (!(t.value > 0.0))
    problems.add(place, fmt::format("{} = {}", what, t.value), "must be > 0", "give a positive time");
  return time(t, what, place);
}

Vec3d StageResolver::direction(const Vec3d& d, const char* what, const SourcePlace& place) const {
  if (norm(d) > 0.0) return normalised(d);
  problems.add(place, fmt::format("the direction of {} is zero", what), "it must point somewhere",
               "use for instance direction = [1, 0, 0]");
  return d;
}

std::vector<Support> StageResolver::supports() const {
  std::vector<Support> resolved;
  for (const SupportSpec& s : spec.supports) {
    const HeldDirections d = directions_of(s);
    resolved.push_back({s.group.value, particles(s.group), d.held, at_rest() ? s.displacement : s.velocity,
                        at_rest() ? s.rotation : s.angular_velocity, function(s.factor, s.place), s.rigid,
                        s.pivot, d.axes});
  }
  check_supports(resolved);
  return resolved;
}

std::vector<PointLoad> StageResolver::loads() const {
  std::vector<PointLoad> resolved;
  for (const LoadSpec& l : spec.loads) {
    PointLoad load{l.group.value, particles(l.group), l.force, l.moment, function(l.factor, l.place)};
    load.force_by_mass = l.total_force / mass_of(load.particles);
    load.moment_by_mass = l.total_moment / mass_of(load.particles);
    load.follower = l.follower;
    load.constant = l.constant;
    resolved.push_back(std::move(load));
  }
  return resolved;
}

CellDrive StageResolver::cell_drive() const {
  CellDrive drive;
  if (!spec.cell) return drive;
  for (std::size_t k = 0; k < drive.component.size(); ++k) {
    const auto& given = spec.cell->component[k];
    if (!given) continue;
    using By = CellComponent::By;
    const std::optional<double>& strained = at_rest() ? given->strain : given->rate;
    drive.component[k] = {given->stress ? By::stress : By::strain,
                          given->stress.value_or(strained.value_or(0.0)),
                          function(given->factor, given->place)};
  }
  if (spec.cell->servo) drive.servo = *spec.cell->servo;
  return drive;
}

void StageResolver::check_supports(const std::vector<Support>& supports) const {
  for (std::size_t k = 0; k < supports.size(); ++k)
    if (supports[k].rigid && supports[k].particles.empty() && model.find_group(supports[k].group) != nullptr)
      problems.add(spec.supports[k].place,
                   fmt::format("the rigid support of group \"{}\" has no particles", supports[k].group),
                   "it moves particles as one rigid body", "name a group with particles, or leave it out");
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const Support& s = supports[k];
    if (is_free_grip(s) && s.pivot && !(s.held[0] && s.held[1] && s.held[2] && s.velocity == Vec3d{}))
      problems.add(spec.supports[k].place,
                   fmt::format("the rigid support of group \"{}\" has a pivot that would move", s.group),
                   "what is rigid and free in part turns about a pivot that stands still",
                   "leave pivot out, or fix x, y and z and leave the displacement or velocity out");
  }
  for (const Disagreement& d : disagreements(supports, model.particles())) {
    const std::string both = fmt::format("is held by two supports (groups \"{}\" and \"{}\")",
                                         supports[d.first].group, supports[d.second].group);
    if (d.oblique)
      problems.add(spec.supports[d.second].place,
                   fmt::format("particle {} {} along directions that are neither parallel nor perpendicular",
                               d.particle.value, both),
                   "one support may hold directions at any angle to each other, two of them may not",
                   "give all of them to one support, as in fix = [\"y\", [0.6, 0, 0.8]]");
    else if (is_free_grip(supports[d.first]) || is_free_grip(supports[d.second]))
      problems.add(spec.supports[d.second].place,
                   fmt::format("{} of particle {} {}, one of them rigid and free in part", d.dof,
                               d.particle.value, both),
                   "the particles of a rigid group that is free in part are in no other support",
                   "leave these particles out of the other group");
    else
      problems.add(
          spec.supports[d.second].place,
          fmt::format("{} of particle {} {} that do not move it alike", d.dof, d.particle.value, both),
          "supports may overlap where they agree: at rest, or with the same motion, factor and, of "
          "rigid ones that turn, axis",
          "take it out of one of them, or give both the same motion (and rigid ones the same pivot)");
  }
}

/// What a total of a load is shared in proportion to: the mass of its group.
double StageResolver::mass_of(const std::vector<ParticleId>& particles) const {
  double mass = 0.0;
  for (const ParticleId p : particles) mass += model.mass[p];
  return mass > 0.0 ? mass : 1.0;  // of no particles: nothing takes a share
}

bool StageResolver::anything_is_free(const std::vector<Support>& supports) const {
  std::size_t held = 0;
  for (const Hold& h : holds_of(supports))
    held += static_cast<std::size_t>(std::count(h.held.begin(), h.held.end(), true));
  return held < 6 * model.particles();
}

void check_stages(const Case& c, const Model& model, Problems& problems) {
  check_stage_names(c, problems);
  for (std::size_t k = 0; k < c.stages.size(); ++k)
    if (is_static(c.stages[k].kind))
      resolve_static_stage(c, model, k, problems);
    else
      resolve_stage(c, model, k, problems);
}

bool makes_bonds_as_it_begins(const BondSpec& set, const StageSpec& stage) {
  const auto here = [&](const Placed<std::string>& name) { return name.value == stage.name; };
  return set.when == BondTime::stage && std::any_of(set.stages.begin(), set.stages.end(), here);
}

void add_stage_bonds(const Case& c, std::size_t k, const Model& model, State& state, Problems& problems,
                     int threads) {
  SharedCells shared(threads);
  for (std::size_t set = 0; set < c.bonds.size(); ++set)
    if (makes_bonds_as_it_begins(c.bonds[set], c.stages[k]))
      add_bonds(c, set, model, state, problems, shared);
}

}  // namespace vbond
