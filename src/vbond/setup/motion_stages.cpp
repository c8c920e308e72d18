#include "vbond/setup/motion_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "vbond/model/capsules.hpp"
#include "vbond/model/held_tops.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/swing_bound.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/case_sources.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/stage_resolver.hpp"
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
      rule.recipe.set = static_cast<std::uint32_t>(set);
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
                 fmt::format("bonds \"{}\" follow radii: particle {} has radius {}", b.name, bare->value,
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

/// A time as a user may compare it with the case: also in T_0 where there is one.
std::string in_words(double time, const Model& model) {
  const std::string text = fmt::format("{:.6g}", time);
  return model.T_0 > 0.0 ? text + fmt::format(" ({:.4g} T0)", time / model.T_0) : text;
}

void take_given_step(const Case& c, const Model& model, const CaseTime& given, const StepBound& bound,
                     Stage& stage, Problems& problems) {
  const SourcePlace& place = c.time.step->place;
  stage.dt = look_up_time(given, model, "time.step", place, problems);
  if (!(stage.dt > 0.0))
    problems.add(place, fmt::format("time.step = {}", given.value), "must be > 0", "give a positive time");
  else if (stage.dt > bound.dt && !c.time.insist)
    problems.add(
        place, fmt::format("time.step = {} in stage \"{}\"", in_words(stage.dt, model), stage.name),
        fmt::format("above {} the run may blow up: {}", in_words(bound.dt, model), bound.source),
        fmt::format("use at most {}, better 0.2 of it; or insist = true", in_words(bound.dt, model)));
}

/// Whether nothing is elastic because bonds have all broken or are still to come: for the flight of such
/// particles the step of the first bond does, 2 / omega of omega = 2 pi / T0.
bool flies_freely(const Case& c, const Model& model, const State& state) {
  const auto holds = [](const Bond& b) { return !b.broken; };
  return !c.bonds.empty() && model.T_0 > 0.0 && std::none_of(state.bonds.begin(), state.bonds.end(), holds);
}

void take_fraction(const Case& c, const StageSpec& spec, const StepBound& critical, Stage& stage,
                   Problems& problems) {
  if (std::isinf(critical.dt))
    problems.add(spec.place, fmt::format("stage \"{}\" has no natural time step", stage.name),
                 critical.source, "give time.step");
  else
    stage.dt = std::min(c.time.fraction * critical.dt, fastest_swing(stage).wanted_step());
}

/// A step that is given may be too long for what the stage moves to and fro.
void check_swings(const Case& c, const StageSpec& spec, const Model& model, const Stage& stage,
                  Problems& problems) {
  const CaseTime* given = c.time.given();
  if (given == nullptr || c.time.insist) return;
  const double dt = given->resolve(model.T_0);
  const FastestSwing swing = fastest_swing(stage);
  if (!(dt > swing.longest_step())) return;
  problems.add(c.time.step->place,
               fmt::format("time.step = {} in stage \"{}\"", in_words(dt, model), spec.name),
               fmt::format("that is {:.3g} steps in a period of {:.6g} of {}; {} are the fewest",
                           swing.period / dt, swing.period, swing.source, fewest_of_a_period),
               fmt::format("use {}, {} steps a period, or leave step out; or insist = true",
                           in_words(swing.wanted_step(), model), steps_of_a_period));
}

/// The critical step of the body as it stands.
StepBound exact_bound(const Case& c, const Model& model, const State& state, const Stage& stage,
                      const ExactCriticalStep& exact_step, Problems& problems) {
  const SourcePlace& place = c.time.step->place;
  refuse_exact_with_bonding(c, stage, problems);
  const bool capsules = any_capsules(model.contact, state.bonds);
  if (capsules || !model.walls.empty())
    problems.add(place, "time.step = \"exact\"",
                 capsules ? "bonds touch as capsules, which the exact step does not know"
                          : "the case has walls, which the exact step does not know",
                 "leave step out: the automatic one counts them");
  if (!exact_step)
    problems.add(place, "time.step = \"exact\"", "this vbond was built without statics",
                 "leave step out, or give a time");
  problems.throw_if_any();
  StepBound bound{.dt = 0.0, .bond = {}, .source = "nothing is elastic"};
  try {
    bound.dt = exact_step(model, state, stage);
  } catch (const NoConvergence& e) {
    problems.add(place, "time.step = \"exact\"", e.what(), "leave step out, or give a time");
    problems.throw_if_any();
  }
  return within_turns(bound, model, state, stage);
}

void choose_step(const Case& c, const StageSpec& spec, const Model& model, const State& state,
                 const ExactCriticalStep& exact_step, Stage& stage, Problems& problems) {
  const Spins spins = c.time.given() ? spins_against_given_step(state) : Spins::counted;
  StepBound critical = step_is_exact(c) ? exact_bound(c, model, state, stage, exact_step, problems)
                                        : step_bound(model, state, stage, spins);
  if (!c.time.given() && flies_freely(c, model, state) &&
      std::isinf(step_bound(model, state, stage.bonding, stage.walls).dt))
    critical = within_turns(
        {model.T_0 / std::numbers::pi, std::nullopt, "T0/pi: nothing is elastic as the stage begins"}, model,
        state, stage, spins);
  stage.critical = critical.dt;
  if (!(critical.dt > 0.0))
    problems.add(
        spec.place, fmt::format("stage \"{}\" has the critical step {}", stage.name, critical.dt),
        "a mass, an inertia or a stiffness is so far out of range that no step is left: " + critical.source,
        "look for a missing or misplaced unit");
  else if (const CaseTime* given = c.time.given())
    take_given_step(c, model, *given, critical, stage, problems);
  else
    take_fraction(c, spec, critical, stage, problems);
}

/// A cell that gives way to a stress faster than the body answers swings from step to step.
void check_servo_of_cell(const StageSpec& spec, const Model& model, const State& state, const Stage& stage,
                         Problems& problems) {
  if (!stage.cell.any_stress() || state.bonds.empty()) return;
  const CellServo& servo = stage.cell.servo;
  const double C = affine_modulus(model.cell, state), change = C * stage.dt / (servo.modulus * servo.time);
  if (change < 1.0) return;
  problems.add(
      spec.place,
      fmt::format("stage \"{}\": cell.servo: modulus {:.4g} times time {:.4g}", spec.name, servo.modulus,
                  servo.time),
      fmt::format("a step of {:.4g} would change the stress by up to {:.3g} of what is missing: the "
                  "stiffness of the bonds while particles follow the cell is up to {:.4g}",
                  stage.dt, change, C),
      fmt::format("use modulus = {:.4g}, and a time of at least {:.3g}, better more", C, 10.0 * stage.dt));
}

/// Times that must span a step, and a mean force that needs bonds: known only when the step and bonds are.
void check_against_step(const StageSpec& spec, const Model& model, const State& state, const Stage& stage,
                        Problems& problems) {
  check_servo_of_cell(spec, model, state, stage, problems);
  const auto too_short = [&](const SourcePlace& place, const char* what, double time) {
    if (time < stage.dt)
      problems.add(place, fmt::format("{} = {:.6g}", what, time),
                   fmt::format("the time step is {:.6g}", stage.dt), "use a longer time or a smaller step");
  };
  too_short(spec.place, "duration", stage.stops.duration);
  if (stage.stops.breaks && stage.bonding.empty()) {
    const auto left = std::count_if(state.bonds.begin(), state.bonds.end(),
                                    [](const Bond& b) { return !has_failed(b) && can_break(b); });
    if (left < stage.stops.breaks->count)
      problems.add(spec.stop_breaks->place, fmt::format("stop.breaks.count = {}", stage.stops.breaks->count),
                   fmt::format("only {} bonds may break in stage \"{}\"", left, spec.name),
                   "use a smaller count");
  }
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

/// Takes the step down to one that the times of the stage are whole numbers of.
void fit_step(const StageSpec& spec, Stage& stage, Problems& problems) {
  stage.dt = fitting_step(stage.dt, stage.stops.duration, stage.strain ? stage.strain->every : 0.0);
  check_number_of_steps(spec, stage.stops.duration, stage.dt, problems);
}

void put_on_steps(Stage& stage) {
  const std::int64_t last = steps_in(stage.stops.duration, stage.dt);
  for (Support& s : stage.supports) s.factor = on_steps(s.factor, stage.dt, last);
  for (PointLoad& l : stage.loads) l.factor = on_steps(l.factor, stage.dt, last);
  for (Pressure& p : stage.pressures) p.factor = on_steps(p.factor, stage.dt, last);
  for (Heating& h : stage.heating) h.factor = on_steps(h.factor, stage.dt, last);
  for (CellComponent& c : stage.cell.component) c.factor = on_steps(c.factor, stage.dt, last);
  for (WallDrive& w : stage.walls) {
    w.factor = on_steps(w.factor, stage.dt, last);
    if (w.servo) w.servo->factor = on_steps(w.servo->factor, stage.dt, last);
  }
}

}  // namespace

double expected_step(const Case& c, const Model& model, const State& state) {
  const CaseTime* given = c.time.given();
  return given ? given->resolve(model.T_0) : c.time.fraction * step_bound(model, state).dt;
}

void check_number_of_steps(const StageSpec& spec, double duration, double dt, Problems& problems) {
  constexpr double most = 1e15;  // three years of ten million steps a second; counts are exact as doubles
  if (duration <= most * dt) return;
  problems.add(
      spec.place, fmt::format("stage \"{}\": duration = {:.6g}", spec.name, duration),
      fmt::format("that is {:.2g} steps of {:.6g}; {:.0e} are the most", duration / dt, dt, most),
      "look for a missing or misplaced unit; with a stop condition, too, give a duration within reach");
}

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

bool step_is_exact(const Case& c) {
  return c.time.step && !c.time.given();
}

void refuse_exact_with_bonding(const Case& c, const Stage& stage, Problems& problems) {
  if (!step_is_exact(c) || stage.bonding.empty()) return;
  problems.add(c.time.step->place, fmt::format("time.step = \"exact\" in stage \"{}\"", stage.name),
               fmt::format("bonds \"{}\" may still be made in it, which the exact step does not know",
                           stage.bonding.front().name),
               "leave step out: the automatic one leaves room for them");
}

void choose_fitting_step(const Case& c, std::size_t k, const Model& model, const State& state,
                         const ExactCriticalStep& exact_step, Stage& stage) {
  Problems problems;
  choose_step(c, c.stages[k], model, state, exact_step, stage, problems);
  problems.throw_if_any();
  check_against_step(c.stages[k], model, state, stage, problems);
  fit_step(c.stages[k], stage, problems);
  problems.throw_if_any();
}

Stage build_stage(const Case& c, const Model& model, int k, State& state, const ExactCriticalStep& exact_step,
                  int threads) {
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
  complete_terms({c, model, c.stages[index], problems}, state, stage);
  problems.throw_if_any();
  choose_fitting_step(c, index, model, state, exact_step, stage);
  put_on_steps(stage);
  return stage;
}

}  // namespace vbond
