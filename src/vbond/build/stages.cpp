#include "vbond/build/stages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "vbond/build/bonds.hpp"
#include "vbond/build/groups.hpp"
#include "vbond/core/nearest.hpp"
#include "vbond/model/make_bond.hpp"

namespace vbond {
namespace {

/// Turns the parts of one stage from names into numbers.
struct StageResolver {
  const Case& c;
  const Model& model;
  const StageSpec& spec;
  Problems& problems;

  std::vector<ParticleId> particles(const Placed<std::string>& group) const {
    const Group* g = look_up_group(group, model, problems);
    return g == nullptr ? std::vector<ParticleId>{} : g->particles;
  }

  double time(const CaseTime& t, const char* what, const SourcePlace& place) const {
    return look_up_time(t, model, what, place, problems);
  }

  double positive_time(const CaseTime& t, const char* what, const SourcePlace& place) const {
    if (!(t.value > 0.0))
      problems.add(place, fmt::format("{} = {}", what, t.value), "must be > 0", "give a positive time");
    return time(t, what, place);
  }

  Vec3d direction(const Vec3d& d, const char* what, const SourcePlace& place) const {
    if (norm(d) > 0.0) return normalised(d);
    problems.add(place, fmt::format("the direction of {} is zero", what), "it must point somewhere",
                 "use for instance direction = [1, 0, 0]");
    return d;
  }

  TimeFunction function(const TimeFunctionSpec& f, const SourcePlace& place) const {
    TimeFunction resolved;
    for (const auto& [t, factor] : f.points) {
      const double at = time(t, "factor", place);
      if (!resolved.points.empty() && !(at > resolved.points.back().t))
        problems.add(place,
                     fmt::format("the factor's time {} does not come after {}", at, resolved.points.back().t),
                     "the times of a table increase", "sort the points");
      resolved.points.push_back({at, factor});
    }
    return resolved;
  }

  std::vector<Support> supports() const {
    std::vector<Support> resolved;
    for (const SupportSpec& s : spec.supports)
      resolved.push_back({s.group.value, particles(s.group), s.held, s.velocity, s.angular_velocity,
                          function(s.factor, s.place)});
    check_held_once(resolved);
    return resolved;
  }

  void check_held_once(const std::vector<Support>& supports) const {
    static constexpr const char* dof_names[6] = {
        "x", "y", "z", "rotation about x", "rotation about y", "rotation about z"};
    std::vector<std::array<int, 6>> holder(model.particles(), {-1, -1, -1, -1, -1, -1});
    for (std::size_t s = 0; s < supports.size(); ++s) {
      bool reported = false;  // one pair of supports, one report
      for (const ParticleId p : supports[s].particles)
        for (std::size_t dof = 0; dof < 6; ++dof) {
          if (!supports[s].held[dof]) continue;
          int& by = holder[p.value][dof];
          if (by >= 0 && !reported) {
            reported = true;
            problems.add(spec.supports[s].place,
                         fmt::format("{} of particle {} is held by two supports (groups \"{}\" and \"{}\")",
                                     dof_names[dof], p.value, supports[static_cast<std::size_t>(by)].group,
                                     supports[s].group),
                         "a degree of freedom has one support at most", "take it out of one of them");
          }
          by = static_cast<int>(s);
        }
    }
  }

  std::vector<PointLoad> loads() const {
    std::vector<PointLoad> resolved;
    for (const LoadSpec& l : spec.loads)
      resolved.push_back({l.group.value, particles(l.group), l.force, l.moment, function(l.factor, l.place)});
    return resolved;
  }

  StrainProgram strain(const StrainSpec& s) const {
    StrainProgram resolved{particles(s.group),
                           direction(s.direction, "strain", s.place),
                           {},
                           s.increment,
                           positive_time(s.every, "strain.every", s.place)};
    for (const ParticleId p : resolved.particles) resolved.centre += model.r_0[p];
    if (!resolved.particles.empty())
      resolved.centre = resolved.centre / static_cast<double>(resolved.particles.size());
    return resolved;
  }

  std::optional<DistanceStop> distance_stop(const DistanceStopSpec& s) const {
    const auto i = look_up_particle(s.between[0], model, "stop.distance", s.place, problems);
    const auto j = look_up_particle(s.between[1], model, "stop.distance", s.place, problems);
    if (!i || !j) return std::nullopt;
    if (i == j)
      problems.add(s.place, fmt::format("stop.distance between particle {} and itself", i->value),
                   "a distance is between two particles", "name two different ones");
    return DistanceStop{*i, *j, s.value, s.below};
  }

  PeakStop peak_stop(const PeakStopSpec& s, const std::vector<Support>& held) const {
    PeakStop stop{s.quantity, particles(s.group), s.direction, s.drop,
                  positive_time(s.average_over, "stop.peak.average_over", s.place)};
    if (s.quantity == PeakQuantity::reaction && !stop.particles.empty()) {
      stop.direction = direction(s.direction, "stop.peak", s.place);
      const auto pushes = [&](const Support& support) {
        return (support.held[0] || support.held[1] || support.held[2]) &&
               std::any_of(support.particles.begin(), support.particles.end(), [&](ParticleId p) {
                 return std::binary_search(stop.particles.begin(), stop.particles.end(), p);
               });
      };
      if (std::none_of(held.begin(), held.end(), pushes))
        problems.add(s.place, fmt::format("the reaction of group \"{}\" is always zero", s.group.value),
                     "no support of this stage holds a translation of it", "name a group that is held");
    }
    return stop;
  }

  std::vector<BondingRule> bonding(std::size_t k) const {
    std::vector<BondingRule> rules;
    for (std::size_t set = 0; set < c.bonds.size(); ++set) {
      const BondSpec& b = c.bonds[set];
      const auto here = [&](const Placed<std::string>& name) { return name.value == c.stages[k].name; };
      if (b.when != BondTime::approach) continue;
      if (!b.stages.empty() && std::none_of(b.stages.begin(), b.stages.end(), here)) continue;
      const Group* first = look_up_group(b.between[0], model, problems);
      const Group* second = look_up_group(b.between[1], model, problems);
      const auto* within = std::get_if<WithinDistance>(&b.select.value);
      if (within == nullptr)
        problems.add(b.place, fmt::format("bonds \"{}\" are made on approach but not by distance", b.name),
                     "only a distance says when particles have come close", "select by distance");
      if (first == nullptr || second == nullptr || within == nullptr) continue;
      BondingRule rule{b.name, membership(*first, model), membership(*second, model), within->distance,
                       b.recipe};
      rule.recipe.set = static_cast<std::uint32_t>(set);
      check_length(b, *within, *first, *second);
      rules.push_back(std::move(rule));
    }
    return rules;
  }

  /// A rule whose bonds would have no length even at its full distance can never make one.
  void check_length(const BondSpec& b, const WithinDistance& within, const Group& first,
                    const Group& second) const {
    const auto smallest = [&](const Group& g) {
      double R = INFINITY;
      for (const ParticleId p : g.particles) R = std::min(R, model.radius[p]);
      return R;
    };
    double R = 0.0;
    if (b.recipe.attachment == Attachment::surfaces) R = smallest(first) + smallest(second);
    if (b.recipe.attachment == Attachment::given) R = b.recipe.R_i + b.recipe.R_j;
    if (!(within.distance > R))
      problems.add(b.place,
                   fmt::format("bonds \"{}\": distance {} with R_i + R_j = {}", b.name, within.distance, R),
                   "no length is left for a bond: a = distance - R_i - R_j must be > 0",
                   "use a larger distance, or bond at the centres");
  }
};

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

/// A time as a user may compare it with the case: also in T_0 where there is one.
std::string in_words(double time, const Model& model) {
  const std::string text = fmt::format("{:.6g}", time);
  return model.T_0 > 0.0 ? text + fmt::format(" ({:.4g} T0)", time / model.T_0) : text;
}

void choose_step(const Case& c, const Model& model, const State& state, Stage& stage, Problems& problems) {
  const StepBound bound = step_bound(model, state, stage.bonding);
  if (!(bound.dt > 0.0)) {
    problems.add(
        {c.file, 0, 0}, fmt::format("stage \"{}\" has the critical step {}", stage.name, bound.dt),
        "a mass, an inertia or a stiffness is so far out of range that no step is left: " + bound.source,
        "look for a missing or misplaced unit");
  } else if (c.time.step) {
    const auto& [given, place] = *c.time.step;
    stage.dt = look_up_time(given, model, "time.step", place, problems);
    if (!(stage.dt > 0.0))
      problems.add(place, fmt::format("time.step = {}", given.value), "must be > 0", "give a positive time");
    else if (stage.dt > bound.dt && !c.time.insist)
      problems.add(
          place, fmt::format("time.step = {} in stage \"{}\"", in_words(stage.dt, model), stage.name),
          fmt::format("above {} the run may blow up: {}", in_words(bound.dt, model), bound.source),
          fmt::format("use at most {}, better 0.2 of it; or insist = true", in_words(bound.dt, model)));
  } else if (std::isinf(bound.dt)) {
    problems.add({c.file, 0, 0}, fmt::format("stage \"{}\" has no natural time step", stage.name),
                 bound.source, "give time.step");
  } else {
    stage.dt = c.time.fraction * bound.dt;
  }
}

/// Times that must span a step, and a mean force that needs bonds: known only when the step and bonds are.
void check_against_step(const StageSpec& spec, const State& state, const Stage& stage, Problems& problems) {
  const auto too_short = [&](const SourcePlace& place, const char* what, double time) {
    if (time < stage.dt)
      problems.add(place, fmt::format("{} = {:.6g}", what, time),
                   fmt::format("the time step is {:.6g}", stage.dt), "use a longer time or a smaller step");
  };
  too_short(spec.place, "duration", stage.stops.duration);
  if (stage.strain) too_short(spec.strain->place, "strain.every", stage.strain->every);
  if (!stage.stops.peak) return;
  const PeakStop& peak = *stage.stops.peak;
  too_short(spec.stop_peak->place, "stop.peak.average_over", peak.average_over);
  const auto has = [&](ParticleId p) {
    return std::binary_search(peak.particles.begin(), peak.particles.end(), p);
  };
  const auto inside = [&](const Bond& b) { return has(b.i) && has(b.j); };
  if (peak.quantity == PeakQuantity::compressive_force && stage.bonding.empty() &&
      std::none_of(state.bonds.begin(), state.bonds.end(), inside))
    problems.add(spec.stop_peak->place, fmt::format("group \"{}\" has no bonds", spec.stop_peak->group.value),
                 "its mean force is taken over the bonds with both ends in the group", "name a bonded group");
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

Stage resolve_stage(const Case& c, const Model& model, std::size_t k, Problems& problems) {
  const StageSpec& spec = c.stages.at(k);
  const StageResolver resolver{c, model, spec, problems};
  if (k == 0) check_stage_names(c, problems);
  Stage stage;
  stage.name = spec.name;
  stage.insist = c.time.insist;
  stage.gravity = spec.gravity;
  stage.b_translation = spec.b_translation;
  stage.b_rotation = spec.b_rotation;
  stage.supports = resolver.supports();
  stage.loads = resolver.loads();
  if (spec.strain) stage.strain = resolver.strain(*spec.strain);
  stage.bonding = resolver.bonding(k);
  stage.stops.duration = resolver.positive_time(spec.duration, "duration", spec.place);
  if (spec.stop_distance) stage.stops.distance = resolver.distance_stop(*spec.stop_distance);
  if (spec.stop_peak) stage.stops.peak = resolver.peak_stop(*spec.stop_peak, stage.supports);
  if (spec.stop_rest)
    stage.stops.rest =
        RestStop{spec.stop_rest->kinetic_energy_below,
                 resolver.positive_time(spec.stop_rest->during, "stop.rest.during", spec.stop_rest->place)};
  return stage;
}

Stage build_stage(const Case& c, const Model& model, int k, State& state) {
  Problems problems;
  const auto index = static_cast<std::size_t>(k);
  Stage stage = resolve_stage(c, model, index, problems);
  problems.throw_if_any();
  if (state.clock.stage_step > 0) {  // under way: bonds made since must not change its step
    stage.dt = state.clock.dt;
    return stage;
  }
  for (std::size_t set = 0; set < c.bonds.size(); ++set) {
    const BondSpec& b = c.bonds[set];
    const auto here = [&](const Placed<std::string>& name) { return name.value == stage.name; };
    if (b.when == BondTime::stage && std::any_of(b.stages.begin(), b.stages.end(), here))
      add_bonds(c, set, model, state, problems);
  }
  problems.throw_if_any();
  choose_step(c, model, state, stage, problems);
  problems.throw_if_any();
  check_against_step(c.stages[index], state, stage, problems);
  problems.throw_if_any();
  return stage;
}

}  // namespace vbond
