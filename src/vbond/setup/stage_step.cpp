#include "vbond/setup/stage_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "vbond/model/capsules.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/swing_bound.hpp"
#include "vbond/setup/motion_stages.hpp"
#include "vbond/setup/times.hpp"

namespace vbond {
namespace {

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
bool flies_freely(const Case& c, const Model& model, const BodyPart& body) {
  return !c.bonds.empty() && model.T_0 > 0.0 &&
         count_bonds(body, [](const Bond& b) { return !b.broken; }) == 0;
}

void take_fraction(const Case& c, const StageSpec& spec, const StepBound& critical, Stage& stage,
                   Problems& problems) {
  if (std::isinf(critical.dt))
    problems.add(spec.place, fmt::format("stage \"{}\" has no natural time step", stage.name),
                 critical.source, "give time.step");
  else
    stage.dt = std::min(c.time.fraction * critical.dt, fastest_swing(stage).wanted_step());
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

void choose_step(const Case& c, const StageSpec& spec, const Model& model, const BodyPart& body,
                 const ExactCriticalStep& exact_step, Stage& stage, Problems& problems) {
  const State& state = body.state;
  const Spins spins = c.time.given() ? spins_against_given_step(state) : Spins::counted;
  StepBound critical = step_is_exact(c) ? exact_bound(c, model, state, stage, exact_step, problems)
                                        : step_bound(model, body, stage, spins);
  if (!c.time.given() && flies_freely(c, model, body) &&
      std::isinf(step_bound(model, body, stage.bonding, stage.walls).dt))
    critical = within_turns(
        {model.T_0 / std::numbers::pi, std::nullopt, "T0/pi: nothing is elastic as the stage begins"}, model,
        body, stage, spins);
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

/// A stress that is seen with what the rate before has added to it: the rates go as the powers of z with
/// z^2 + (a + h - 1) z - h = 0, a the part of a change that a step makes, h = eta/(modulus time). Both |z| <
/// 1 where a/2 + h < 1.
void check_servo_against_damping(const StageSpec& spec, const Model& model, const State& state,
                                 const Stage& stage, double a, Problems& problems) {
  const CellServo& servo = stage.cell.servo;
  const double eta = affine_viscosity(model.cell, state, stage.cell);
  if (0.5 * a + eta / (servo.modulus * servo.time) < 1.0) return;
  problems.add(
      spec.place,
      fmt::format("stage \"{}\": cell.servo: modulus {:.4g} times time {:.4g}", spec.name, servo.modulus,
                  servo.time),
      fmt::format(
          "the damping of bonds adds up to {:.4g} of the rate to the stress that the servo sees: below "
          "that the rate flips from step to step",
          eta),
      fmt::format("use a time of at least {:.3g}, better more, or less damping",
                  2.0 * (eta / servo.modulus + 0.5 * a * servo.time)));
}

/// A cell that gives way to a stress faster than the body answers swings from step to step.
void check_servo_of_cell(const StageSpec& spec, const Model& model, const State& state, const Stage& stage,
                         Problems& problems) {
  if (!stage.cell.any_stress() || state.bonds.empty()) return;
  const CellServo& servo = stage.cell.servo;
  const double C = affine_modulus(model.cell, state), change = C * stage.dt / (servo.modulus * servo.time);
  if (change < 1.0) return check_servo_against_damping(spec, model, state, stage, change, problems);
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
void check_against_step(const StageSpec& spec, const Model& model, const BodyPart& body, const Stage& stage,
                        Problems& problems) {
  const State& state = body.state;
  check_servo_of_cell(spec, model, state, stage, problems);
  const auto too_short = [&](const SourcePlace& place, const char* what, double time) {
    if (time < stage.dt)
      problems.add(place, fmt::format("{} = {:.6g}", what, time),
                   fmt::format("the time step is {:.6g}", stage.dt), "use a longer time or a smaller step");
  };
  too_short(spec.place, "duration", stage.stops.duration);
  if (stage.stops.breaks && stage.bonding.empty()) {
    const auto left = count_bonds(body, [](const Bond& b) { return !has_failed(b) && can_break(b); });
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
      count_bonds(body, inside) == 0)
    problems.add(spec.stop_peak->place, fmt::format("group \"{}\" has no bonds", spec.stop_peak->group.value),
                 "its mean force is taken over the bonds with both ends in the group", "name a bonded group");
}

/// Takes the step down to one that the times of the stage are whole numbers of.
void fit_step(const StageSpec& spec, Stage& stage, Problems& problems) {
  stage.dt = fitting_step(stage.dt, stage.stops.duration, stage.strain ? stage.strain->every : 0.0);
  check_number_of_steps(spec, stage.stops.duration, stage.dt, problems);
}

}  // namespace

double expected_step(const Case& c, const Model& model, const BodyPart& body) {
  const CaseTime* given = c.time.given();
  return given ? given->resolve(model.T_0) : c.time.fraction * step_bound(model, body).dt;
}

void check_number_of_steps(const StageSpec& spec, double duration, double dt, Problems& problems) {
  constexpr double most = 1e15;  // three years of ten million steps a second; counts are exact as doubles
  if (duration <= most * dt) return;
  problems.add(
      spec.place, fmt::format("stage \"{}\": duration = {:.6g}", spec.name, duration),
      fmt::format("that is {:.2g} steps of {:.6g}; {:.0e} are the most", duration / dt, dt, most),
      "look for a missing or misplaced unit; with a stop condition, too, give a duration within reach");
}

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

void choose_fitting_step(const Case& c, std::size_t k, const Model& model, const BodyPart& body,
                         const ExactCriticalStep& exact_step, Stage& stage) {
  Problems problems;
  choose_step(c, c.stages[k], model, body, exact_step, stage, problems);
  problems.throw_if_any();
  check_against_step(c.stages[k], model, body, stage, problems);
  fit_step(c.stages[k], stage, problems);
  problems.throw_if_any();
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

}  // namespace vbond
