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

/// The step that dynamics will have, if it begins as the body stands now: an estimate after static stages.
double expected_step(const Case& c, const Model& model, const State& state) {
  const CaseTime* given = c.time.given();
  return given ? given->resolve(model.T_0) : c.time.fraction * step_bound(model, state, {}).dt;
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
  }
  return std::accumulate(steps.begin(), steps.end(), std::int64_t{0});
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
  std::optional<Stage> dynamics;  // the first stage, if it is that
  std::optional<StaticStage> statics;
  if (is_static(c.stages[0].kind))
    statics = build_static_stage(c, built.model, 0, built.state);
  else
    dynamics = build_stage(c, built.model, 0, built.state, exact_step());
  plan_output(c, built.model, {});
  print_overview(c, built.model, built.state);
  if (dynamics) print_step(c, built.model, built.state, *dynamics);
  print_machine(threads);
  print_body(built.model, built.state);
  print_overlaps(built.model, built.state);

  const double dt = dynamics ? dynamics->dt : expected_step(c, built.model, built.state);
  const std::int64_t steps = print_stages(c, built.model, dt, dynamics || c.time.given());
  print_memory(built.model, built.state);
  if (statics)
    fmt::print("solver           {}\n",
               solver_in_words(*statics, solver_of(built.model, *statics, built.state)));
  if (dynamics) print_wall_time(steps, built.model, *dynamics, built.state, threads);
  fmt::print("{}: no mistakes found\n", printable(case_file.string()));
  return done;
}

}  // namespace vbond::app
