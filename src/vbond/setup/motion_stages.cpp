#include "vbond/setup/motion_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include "vbond/model/capsules.hpp"
#include "vbond/model/held_tops.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/swing_bound.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/case_cell.hpp"
#include "vbond/setup/case_sources.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/setup/stage_step.hpp"
#include "vbond/setup/times.hpp"
#include "vbond/terms/setup_terms.hpp"
#include "vbond/terms/walls/setup_walls.hpp"

namespace vbond {
namespace {

/// Turns the parts of one dynamics stage from names into numbers.
struct DynamicsResolver : StageResolver {
  std::vector<Support> supports() const {
    std::vector<Support> resolved = StageResolver::supports();
    for (std::size_t k = 0; k < resolved.size(); ++k)
      for (const ParticleId p : resolved[k].particles)
        if (is_free_grip(resolved[k]) && model.is_top(p)) {
          problems.add(spec.supports[k].place,
                       fmt::format("particle {} of the rigid group \"{}\" has three moments of inertia",
                                   p.value, resolved[k].group),
                       "rigid groups that are free in part are of particles with one moment of inertia",
                       "leave fix out, or give the specimen a single inertia");
          break;
        }
    if (const auto top = partly_held_top(model, resolved))
      problems.add(spec.supports[top->support].place,
                   fmt::format("particle {} of group \"{}\"", top->p.value, resolved[top->support].group),
                   partly_held_top_rule, "hold rotation x, y and z, or leave rotations out");
    return resolved;
  }

  PeakStop peak_stop(const PeakStopSpec& s, const std::vector<Support>& held) const {
    const bool of_wall = s.quantity == PeakQuantity::wall_force;
    PeakStop stop{.quantity = s.quantity,
                  .particles = of_wall ? std::vector<ParticleId>{} : particles(s.group),
                  .direction = s.direction,
                  .drop = s.drop,
                  .average_over = positive_time(s.average_over, "stop.peak.average_over", s.place),
                  .wall = 0,
                  .above = s.above};
    if (of_wall) {
      stop.direction = direction(s.direction, "stop.peak", s.place);
      stop.wall = look_up_wall(s.wall, model, problems).value_or(0);
    }
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

  BreakStop break_stop(const BreakStopSpec& s) const {
    const auto may_break = [](const BondSpec& b) { return b.recipe.rules.can_break(); };
    if (std::none_of(c.bonds.begin(), c.bonds.end(), may_break))
      problems.add(s.place, fmt::format("stop.breaks.count = {}", s.count), "no bonds of this case break",
                   "give some bonds a strength, or leave stop.breaks out");
    return {s.count};
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
      const std::optional<BondReach> reach = b.reach();
      if (!reach)
        problems.add(b.place, fmt::format("bonds \"{}\" are made on approach but not by distance", b.name),
                     "only a distance or a gap says when particles have come close",
                     "select by distance, gap or gap_factor");
      if (first == nullptr || second == nullptr || !reach) continue;
      BondingRule rule{b.name,
                       membership(*first, model),
                       membership(*second, model),
                       reach->distance,
                       b.recipe,
                       reach->factor,
                       b.share};
      rule.recipe.set = static_cast<std::uint16_t>(set);
      if (!check_radii(b, *reach, *first) || !check_radii(b, *reach, *second)) continue;
      check_length(b, *reach, *first, *second);
      if (breaks_by_prestrain(rule, model))
        refuse_broken_by_prestrain(
            b, fmt::format("a bond made at the distance {}", (*reach)(smallest(*first), smallest(*second))),
            problems);
      check_capsule(b, *reach, *first, *second);
      rules.push_back(std::move(rule));
    }
    return rules;
  }

  /// What follows radii needs some.
  bool check_radii(const BondSpec& b, const BondReach& reach, const Group& g) const {
    if (!(reach.factor > 0.0) && !b.recipe.needs_radii()) return true;
    const auto bare = std::find_if(g.particles.begin(), g.particles.end(),
                                   [this](ParticleId p) { return !(model.radius[p] > 0.0); });
    if (bare == g.particles.end()) return true;
    problems.add(b.place,
                 fmt::format("bonds \"{}\" follow radii: particle {} has radius {}", b.name, (*bare).value,
                             model.radius[*bare]),
                 "every particle of the two groups needs a radius > 0",
                 "give the specimen a radius, or select by distance with attach = \"centres\"");
    return false;
  }

  double smallest(const Group& g) const {
    double R = INFINITY;
    for (const ParticleId p : g.particles) R = std::min(R, model.radius[p]);
    return R;
  }

  /// The largest that the smaller radius of a pair of the two groups may be.
  double largest_of_pairs(const Group& first, const Group& second) const {
    const auto largest_two = [this](const Group& g) {
      std::array<std::pair<double, ParticleId>, 2> two{};
      for (const ParticleId p : g.particles) {
        const std::pair<double, ParticleId> next{model.radius[p], p};
        if (next.first > two[0].first)
          two[1] = std::exchange(two[0], next);
        else if (next.first > two[1].first)
          two[1] = next;
      }
      return two;
    };
    double R = 0.0;
    for (const auto& [R_i, i] : largest_two(first))
      for (const auto& [R_j, j] : largest_two(second))
        if (i != j) R = std::max(R, std::min(R_i, R_j));
    return R;
  }

  void check_capsule(const BondSpec& b, const BondReach& reach, const Group& first,
                     const Group& second) const {
    if (!b.recipe.capsule) return;
    const double R =
        b.recipe.capsule_radius > 0.0 ? b.recipe.capsule_radius : largest_of_pairs(first, second);
    const double distance = reach(smallest(first), smallest(second));
    if (const auto mistake = capsule_mistake(model.contact, R, distance))
      problems.add(
          b.place,
          fmt::format("bonds \"{}\": capsules of radius {} at a distance of {}", b.name, R, distance),
          mistake->rule, mistake->way_out);
  }

  /// A rule whose bonds would have no length even at its full distance can never make one.
  void check_length(const BondSpec& b, const BondReach& reach, const Group& first,
                    const Group& second) const {
    const BondRadii radii{smallest(first), smallest(second)};
    const double distance = reach(radii.i, radii.j), a = bond_lengths(b.recipe, distance, radii).a;
    if (!(a > 0.0))
      problems.add(
          b.place,
          fmt::format("bonds \"{}\": distance {} with R_i + R_j = {}", b.name, distance, distance - a),
          "no length is left for a bond: a = distance - R_i - R_j must be > 0",
          "use a larger distance or gap, attach = \"neck\", or bond at the centres");
    if (!(a > 0.0) || !b.softening) return;
    const double longest =
        longest_softening_bond(b.recipe.rules.softening, stiffness_of(b.recipe, a, radii).c_A, a);
    if (!(a < longest))
      refuse_snap_back(b, fmt::format("bonds at that distance are {:.6g} long", a), longest, problems);
  }
};

}  // namespace

Stage resolve_stage(const Case& c, const Model& model, std::size_t k, Problems& problems) {
  const StageSpec& spec = c.stages.at(k);
  const DynamicsResolver resolver{{c, model, spec, problems}};
  Stage stage;
  stage.name = spec.name;
  stage.insist = c.time.insist;
  stage.on_unphysical = c.watch.on_unphysical;
  stage.gravity = spec.gravity;
  stage.b_translation = spec.b_translation;
  stage.local_damping = spec.local_damping;
  stage.b_rotation = spec.b_rotation;
  stage.supports = resolver.supports();
  stage.loads = resolver.loads();
  stage.cell = resolver.cell_drive();
  resolve_terms(resolver, stage);
  if (const auto p = strained_and_gripped(stage))
    problems.add(spec.strain->place,
                 fmt::format("strain moves particle {}, which is in a rigid support", p->value),
                 "a rigid support takes its particles where it goes, and would take back any strain",
                 "strain a group without it, or leave rigid out");
  check_stage_of_sources(spec, model, problems);
  resolve_passage(c, model, k, stage, problems);
  stage.bonding = resolver.bonding(k);
  stage.stops.duration = resolver.positive_time(spec.duration, "duration", spec.place);
  if (spec.stop_distance) stage.stops.distance = resolver.distance_stop(*spec.stop_distance);
  if (spec.stop_peak) stage.stops.peak = resolver.peak_stop(*spec.stop_peak, stage.supports);
  if (spec.stop_breaks) stage.stops.breaks = resolver.break_stop(*spec.stop_breaks);
  if (spec.stop_rest)
    stage.stops.rest =
        RestStop{spec.stop_rest->kinetic_energy_below,
                 resolver.positive_time(spec.stop_rest->during, "stop.rest.during", spec.stop_rest->place)};
  check_swings(c, spec, model, stage, problems);
  return stage;
}

std::vector<BondingRule> bonding_rules(const Case& c, const Model& model, std::size_t k) {
  Problems problems;
  const StageSpec& spec = c.stages.at(k);
  std::vector<BondingRule> rules = DynamicsResolver{{c, model, spec, problems}}.bonding(k);
  problems.throw_if_any();
  return rules;
}

Stage build_stage(const Case& c, const Model& model, int k, State& state, const ExactCriticalStep& exact_step,
                  int threads, const std::shared_ptr<const BondsFromSetUp>& own) {
  Problems problems;
  const auto index = static_cast<std::size_t>(k);
  if (is_static(c.stages.at(index).kind)) throw std::logic_error("build_stage: the stage is static");
  Stage stage = resolve_stage(c, model, index, problems);
  problems.throw_if_any();
  if (state.clock.stage_step > 0) {  // under way: bonds made since must not change its step
    stage.dt = state.clock.dt;
    put_on_steps(stage);
    return stage;
  }
  add_stage_bonds(c, index, model, state, problems, threads);
  refuse_turned_through_face(c.stages[index], stage.supports, state, false, problems);
  complete_terms({c, model, c.stages[index], problems}, state, stage);
  problems.throw_if_any();
  choose_fitting_step(c, index, model, body_of(state, own), exact_step, stage);
  put_on_steps(stage);
  return stage;
}

}  // namespace vbond
