#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "commands.hpp"
#include "memory.hpp"
#include "prepare.hpp"
#include "statics.hpp"
#include "vbond/build/build.hpp"
#include "vbond/build/times.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/dynamics/memory.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/observe/report.hpp"
#include "vbond/observe/summary.hpp"

namespace vbond::app {
namespace {

constexpr std::int64_t few_steps = 10;

void print_memory(const Model& model, const State& state) {
  const MemoryUse use = memory_use(state);
  const double total = use.per_particle * static_cast<double>(model.particles()) +
                       use.per_bond * static_cast<double>(state.bonds.size());
  fmt::print("memory           {}: {:.0f} bytes per particle, {:.0f} per bond; neighbour lists are extra\n",
             in_units(total), use.per_particle, use.per_bond);
}

std::string solver_in_words(const StaticStage& stage, const SolverChoice& choice) {
  const std::string factor = in_units(choice.factor_bytes);
  const bool too_large = std::isinf(choice.factor_bytes);
  if (choice.direct && !too_large)
    return fmt::format("direct, with a factor of {} in stage {}", factor, stage.name);
  if (choice.direct || stage.kind != StageKind::equilibrium)
    return fmt::format("none: stage {} will be refused, its factor of {} does not fit", stage.name, factor);
  if (choice.factor_bytes > 0.0) return fmt::format("iterative: a factor of {} would not fit", factor);
  return "iterative";
}

/// Wall time of one step, measured on the case itself for a quarter of a second. Throws Diverged.
double seconds_per_step(const Model& model, const Stage& stage, const State& state, int threads) {
  using Clock = std::chrono::steady_clock;
  Simulation trial(model, stage, state, threads);
  trial.step();  // neighbour lists and threads are set up
  const auto start = Clock::now();
  double seconds = 0.0;
  std::int64_t steps = 0;
  while (seconds < 0.25 && steps < 10000) {
    trial.step();
    ++steps;
    seconds = std::chrono::duration<double>(Clock::now() - start).count();
  }
  return seconds / static_cast<double>(steps);
}

/// What a wrong unit or a misplaced specimen would show in first.
void print_body(const Model& model, const State& state) {
  const bool si = model.units == UnitSystem::si;
  const char *metre = si ? " m" : "", *kilogram = si ? " kg" : "";
  if (model.particles() == 0) return;
  const BoundingBox box = box_around(state.r);
  fmt::print("extent           x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g}{} (centres)\n",
             box.low.x, box.high.x, box.low.y, box.high.y, box.low.z, box.high.z, metre);
  fmt::print("total mass       {:.6g}{}\n", std::accumulate(model.mass.begin(), model.mass.end(), 0.0),
             kilogram);
  if (state.bonds.empty()) return;
  const auto [shortest, longest] =
      std::minmax_element(state.bonds.begin(), state.bonds.end(),
                          [](const Bond& one, const Bond& other) { return one.a < other.a; });
  fmt::print("bond lengths     {:.6g} to {:.6g}{}\n", shortest->a, longest->a, metre);
}

/// Overlaps that the case starts with: their energy flies the body apart if they were not meant.
void print_overlaps(const Model& model, const State& state) {
  double U = 0.0;
  std::int64_t pairs = 0;
  for_touching_pairs(model, state, [&](ParticleId i, ParticleId j, double overlap) {
    U += contact_energy(contact_law(model.contact, model.radius[i], model.radius[j]), overlap);
    ++pairs;
  });
  if (pairs > 0)
    fmt::print("contact energy   at the start {:.6g}{} from {} overlapping pairs\n", U,
               model.units == UnitSystem::si ? " J" : "", pairs);
}

/// Degrees of freedom that a static stage leaves free; each is held once at most.
std::int64_t unknowns_of(const StageSpec& stage, const Model& model) {
  auto free = 6 * static_cast<std::int64_t>(model.particles());
  for (const SupportSpec& s : stage.supports)
    for (const Group& g : resolve_groups({s.group}, model))
      free -= static_cast<std::int64_t>(g.particles.size()) * std::count(s.held.begin(), s.held.end(), true);
  return free;
}

/// Each stage with its size; returns the steps of all of them.
std::int64_t print_stages(const Case& c, const Model& model, double dt, bool dt_is_known) {
  const std::vector<std::int64_t> steps = steps_of_stages(c, model, dt);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const StageSpec& stage = c.stages[k];
    if (is_static(stage.kind))
      fmt::print("stage {:<10} {}, {} unknowns\n", printable(stage.name), to_text(stage.kind),
                 unknowns_of(stage, model));
    else
      fmt::print("stage {:<10} at most {}{} steps{}\n", printable(stage.name), dt_is_known ? "" : "about ",
                 steps[k], steps[k] < few_steps ? ": so few; is a unit missing, such as T0?" : "");
    if (k > 0 && !is_static(stage.kind) && c.time.given())  // of the first stage it is told with its step
      print_notes(times_not_met(expected_times(stage, model, dt)));
  }
  return std::accumulate(steps.begin(), steps.end(), std::int64_t{0});
}

/// A load is given for each particle, and easily taken for that on the group.
void print_loads(const Case& c, const Model& model) {
  const bool si = model.units == UnitSystem::si;
  for (const StageSpec& stage : c.stages)
    for (const LoadSpec& load : stage.loads) {
      const std::size_t n = resolve_groups({load.group}, model).front().particles.size();
      const auto print = [&](const char* what, double each, const char* unit) {
        if (n > 1 && each > 0.0)
          fmt::print(
              "load             stage {}: {} of {:.6g}{} on each of {} particles of {}, total {:.6g}{}\n",
              stage.name, what, each, si ? unit : "", n, load.group.value, static_cast<double>(n) * each,
              si ? unit : "");
      };
      print("force", norm(load.force), " N");
      print("moment", norm(load.moment), " N*m");
    }
}

/// Intervals of output that no stage lasts for: mostly a time without its unit.
void print_output_remarks(const Case& c, const OutputPlan& plan, const Model& model) {
  double total = 0.0;
  for (const StageSpec& s : c.stages)
    if (!is_static(s.kind)) total += s.duration.resolve(model.T_0);
  if (total == 0.0) return;
  const char* unit = model.units == UnitSystem::si ? " s" : "";
  const auto look = [&](const char* key, double every) {
    if (std::isfinite(every) && every > total)
      fmt::print(
          "output           {} = {:.6g}{} is longer than the run, {:.6g}{}: is a unit missing, such as T0?\n",
          key, every, unit, total, unit);
  };
  look("history.every", plan.history_every);
  if (plan.frames_every) look("frames.every", *plan.frames_every);
  if (plan.checkpoint_every) look("checkpoint.every", *plan.checkpoint_every);
}

/// Static stages whose bodies can move freely, which `run` would refuse as they begin: of later stages as the
/// body stands now, where neither bonds nor contacts are to come.
void check_held(const Case& c, const Model& model, const State& state) {
  const bool all_known = c.contact.law == ContactLaw::none &&
                         std::all_of(c.bonds.begin(), c.bonds.end(),
                                     [](const BondSpec& b) { return b.when == BondTime::start; });
  std::vector<Problem> problems;
  for (std::size_t k = 0; k < c.stages.size(); ++k) {
    if (!is_static(c.stages[k].kind) || (k > 0 && !all_known)) continue;
    State at_start = state;
    const StaticStage stage = build_static_stage(c, model, static_cast<int>(k), at_start);
    const auto refusal = refusal_of(model, stage, at_start);
    if (!refusal) continue;
    const std::string text = refusal->what();  // the finding, and on a line of its own a way out
    const std::size_t end = text.find("\n  ");
    problems.push_back({c.stages[k].place, text.substr(0, end), "run will refuse the stage as it begins",
                        end == std::string::npos ? "hold the body" : text.substr(end + 3)});
  }
  if (!problems.empty()) throw CaseError(problems);
}

void print_wall_time(std::int64_t steps, const Model& model, const Stage& first, const State& state,
                     int threads) {
  try {
    const double seconds = static_cast<double>(steps) * seconds_per_step(model, first, state, threads);
    fmt::print("wall time        about {} without output, if no stage ends early (a few steps were timed)\n",
               hours(seconds));
  } catch (const Diverged& e) {  // the case is as its author wants it: whether to run it is not for us to say
    const std::string what = e.what();  // its second line is advice for a run: there are no frames to look at
    fmt::print("wall time        unknown, the trial for it went unphysical at {}\n",
               what.substr(0, what.find('\n')));
  }
}

}  // namespace

int check(const std::filesystem::path& case_file, int threads) {
  const Case c = read_case(case_file);
  require_statics(c);
  require_memory(c);
  Built built = build(c);
  require_memory(c, built.model, built.state);
  check_held(c, built.model, built.state);
  std::optional<Stage> dynamics;  // the first stage, if it is that
  std::optional<StaticStage> statics;
  if (is_static(c.stages[0].kind))
    statics = build_static_stage(c, built.model, 0, built.state);
  else
    dynamics = build_stage(c, built.model, 0, built.state, exact_step());
  const OutputPlan plan = plan_output(c, built.model, {});
  print_overview(c, built.model, built.state);
  print_notes(built.notes);
  if (dynamics) print_step(c, built.model, built.state, *dynamics);
  print_machine(threads);
  print_body(built.model, built.state);
  print_overlaps(built.model, built.state);

  const bool fitted = dynamics && !c.time.given();  // other stages may have another step of their own
  const double dt = fitted ? dynamics->dt : expected_step(c, built.model, built.state);
  const std::int64_t steps = print_stages(c, built.model, dt, dynamics || c.time.given());
  print_loads(c, built.model);
  print_output_remarks(c, plan, built.model);
  print_memory(built.model, built.state);
  if (statics)
    fmt::print("solver           {}\n",
               solver_in_words(*statics, solver_of(built.model, *statics, built.state)));
  if (dynamics) print_wall_time(steps, built.model, *dynamics, built.state, threads);
  fmt::print("{}: no mistakes found\n", printable(case_file.string()));
  return done;
}

}  // namespace vbond::app
