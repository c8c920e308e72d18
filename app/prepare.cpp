#include "prepare.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "vbond/core/printable.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/model/swing_bound.hpp"
#include "vbond/report/facts.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/setup/outlook.hpp"
#include "vbond/setup/times.hpp"

namespace vbond::app {
namespace {

const char* time_unit(const Model& model) {
  return model.units == UnitSystem::si ? " s" : "";
}

}  // namespace

Stage expected_times(const StageSpec& spec, const Model& model, double dt) {
  Stage stage;
  stage.name = spec.name;
  stage.stops.duration = spec.duration.resolve(model.T_0);
  if (spec.strain) stage.strain.emplace().every = spec.strain->every.resolve(model.T_0);
  stage.dt = fitting_step(dt, stage.stops.duration, stage.strain ? stage.strain->every : 0.0);
  return stage;
}

std::vector<StepAhead> steps_ahead(const Case& c, const Run& run) {
  std::vector<StepAhead> ahead(c.stages.size());
  Outlook outlook = run.outlook();
  for (std::size_t k = run.stage_index() + 1; k < c.stages.size(); ++k) {
    const AnyStage later = run.stages().look_ahead(k, run.model(), outlook);
    const auto* stage = std::get_if<Stage>(&later);
    if (stage == nullptr) continue;
    ahead[k].dt = stage->dt;
    if (!c.time.given()) ahead[k].longest = fastest_swing(*stage).wanted_step();
  }
  return ahead;
}

std::vector<std::int64_t> steps_of_stages(const Case& c, const Model& model,
                                          const std::vector<StepAhead>& ahead, std::size_t now, double dt) {
  std::vector<std::int64_t> steps;
  for (std::size_t k = 0; k < c.stages.size(); ++k) {
    const bool is_known = k != now && ahead[k].dt > 0.0;
    const double dt_k = is_known ? ahead[k].dt : k == now ? dt : std::min(dt, ahead[k].longest);
    const Stage stage = is_static(c.stages[k].kind) ? Stage{} : expected_times(c.stages[k], model, dt_k);
    steps.push_back(is_static(c.stages[k].kind) ? 0 : steps_in(stage.stops.duration, stage.dt));
  }
  return steps;
}

namespace {
/// What the stage moves to and fro, beside the step: what chose it, or that it is coarse.
void print_swing(const Case& c, const Stage& stage, const char* unit) {
  const FastestSwing swing = fastest_swing(stage);
  if (!(stage.dt > (c.time.given() ? 1.0 : 0.5) * swing.wanted_step())) return;
  fmt::print("                 {:.3g} steps in a period of {:.6g}{} of {}{}\n", swing.period / stage.dt,
             swing.period, unit, printable(swing.source),
             stage.dt > swing.longest_step() ? ": TOO FEW, as the case insists; its work will be wrong"
             : stage.dt > swing.wanted_step()
                 ? fmt::format("; with {} of them work is right to some 2 %", steps_of_a_period)
                 : "");
}

}  // namespace

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) fmt::print("note             {}\n", printable(note));
  std::fflush(stdout);
}

void print_overview(const Case& c, const Model& model, const BodyPart& body) {
  const Bond* last = nullptr;  // the cells of a flat joint follow one another, and are of one pair
  const auto pairs = static_cast<double>(count_bonds(body, [&last](const Bond& b) {
    const Bond* const before = std::exchange(last, &b);
    return !(before != nullptr && before->i == b.i && before->j == b.j &&
             image_of_j(*before) == image_of_j(b) && before->set == b.set);
  }));
  const auto n = static_cast<double>(model.particles());
  if (!c.title.empty()) fmt::print("{}\n", printable(c.title));
  fmt::print("particles        {}\n", model.particles());
  const std::string neighbours = fmt::format("{:.3g}", n > 0 ? 2 * pairs / n : 0.0);
  fmt::print("bonds            {}, on average {} neighbour{} per particle\n", count_bonds(body), neighbours,
             neighbours == "1" ? "" : "s");
  fmt::print("contacts         {}\n", page::contacts_in_words(model));
  if (model.T_0 > 0) fmt::print("T0               {:.6g}{}\n", model.T_0, time_unit(model));
  std::fflush(stdout);
}

void print_step(const Case& c, const Model& model, const BodyPart& body, const Stage& stage) {
  const StepBound bound = step_bound(model, body, stage);
  const char* time = time_unit(model);
  const bool exact = c.time.step && !c.time.given();
  const bool flies = !exact && std::isinf(bound.dt) && !c.time.given();
  const double critical = exact || flies ? stage.critical : bound.dt;
  if (flies)
    fmt::print("critical step    none, nothing is elastic as the stage begins; T0/pi = {:.6g}{} is taken\n",
               critical, time);
  else if (exact)
    fmt::print("critical step    {:.6g}{}, exact; bound {:.6g}{}, from {}\n", critical, time, bound.dt, time,
               bound.source);
  else
    fmt::print("critical step    {:.6g}{}, from {}\n", critical, time, bound.source);
  fmt::print("time step        {:.6g}{}, {:.3g} of the critical step{}\n", stage.dt, time,
             stage.dt / critical,
             stage.dt > critical ? ": ABOVE it, as the case insists; the run will probably blow up" : "");
  if (const CaseTime* given = c.time.given(); given && stage.dt < given->resolve(model.T_0))
    fmt::print(
        "                 below the {:.6g}{} of the case, so that its times are whole numbers of steps\n",
        given->resolve(model.T_0), time);
  print_swing(c, stage, time);
  print_notes(times_not_met(stage));
}

std::optional<Stage> print_step_ahead(const Case& c, const Run& run, double dt) {
  Outlook outlook = run.outlook();
  for (std::size_t k = run.stage_index() + 1; k < run.stages().size(); ++k) {
    const AnyStage stage = run.stages().look_ahead(k, run.model(), outlook);
    const auto* motion = std::get_if<Stage>(&stage);
    if (motion == nullptr) continue;
    Stage ahead = *motion;
    if (ahead.dt == 0.0) ahead.dt = dt;
    fmt::print("in stage {}, as the body stands now:\n", printable(ahead.name));
    print_step(c, run.model(), run.current(), ahead);
    return ahead;
  }
  return std::nullopt;
}

void print_machine(const Case& c, int threads) {
  fmt::print("instruction set  {}, {}{} thread{}\n", instruction_set(), threads == 1 ? "" : "up to ", threads,
             threads == 1 ? "" : "s");
  if (any_statics(c)) fmt::print("BLAS kernel      {}\n", kernel_of_blas());
  std::fflush(stdout);
}

}  // namespace vbond::app
