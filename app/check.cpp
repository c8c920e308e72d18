#include <fmt/core.h>

#include <chrono>
#include <numeric>
#include <string>

#include "commands.hpp"
#include "prepare.hpp"
#include "vbond/build/build.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/report.hpp"

namespace vbond::app {
namespace {

/// Bytes that particles and bonds take: constants, state, a copy of it between stages, and scratch.
double memory(const Model& model, const State& state) {
  constexpr double per_particle =
      4 * sizeof(double) + sizeof(Vec3d) + 2 * (3 * sizeof(Vec3d) + sizeof(Quatd)) + 2 * sizeof(Vec3d);
  constexpr double per_bond = 2 * sizeof(Bond) + sizeof(BondLoads<double>) + 2 * sizeof(BondIndex::Entry);
  return per_particle * static_cast<double>(model.particles()) +
         per_bond * static_cast<double>(state.bonds.size());
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

}  // namespace

int check(const std::filesystem::path& case_file, int threads) {
  const Case c = read_case(case_file);
  Built built = build(c);
  const Stage first = build_stage(c, built.model, 0, built.state);
  plan_output(c, built.model, {});
  print_overview(c, built.model, built.state, first);

  const std::vector<std::int64_t> steps = steps_of_stages(c, built.model, first.dt);
  for (std::size_t k = 0; k < steps.size(); ++k)
    fmt::print("stage {:<10} at most {} steps\n", c.stages[k].name, steps[k]);
  fmt::print("memory           {:.3g} MB for particles and bonds\n", 1e-6 * memory(built.model, built.state));
  const auto total = std::accumulate(steps.begin(), steps.end(), std::int64_t{0});
  try {
    const double seconds =
        static_cast<double>(total) * seconds_per_step(built.model, first, built.state, threads);
    fmt::print("wall time        about {} without output, if no stage ends early (a few steps were timed)\n",
               hours(seconds));
  } catch (const Diverged& e) {  // the case is as its author wants it: whether to run it is not for us to say
    const std::string what = e.what();  // its second line is advice for a run: there are no frames to look at
    fmt::print("wall time        unknown, the trial for it went unphysical at {}\n",
               what.substr(0, what.find('\n')));
  }
  fmt::print("{}: no mistakes found\n", case_file.string());
  return done;
}

}  // namespace vbond::app
