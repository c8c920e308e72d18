#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "prepare.hpp"
#include "signals.hpp"
#include "vbond/build/build.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/observe/report.hpp"
#include "vbond/observe/summary.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Everything a run in progress has at hand.
struct Campaign {
  const Case& c;
  const Model& model;
  OutputPlan plan;
  int threads = 1;
  FileObservers files;
  std::shared_ptr<TableObserver> table;
  std::shared_ptr<ProgressObserver> progress;  // null unless stderr is a terminal
  RunSummary summary;
  double building = 0;  // seconds
};

RunSummary first_summary(const Case& c, const Model& model) {
  RunSummary s;
  s.title = c.title;
  s.version = VBOND_VERSION;
  s.units = model.units;
  s.particles = static_cast<std::int64_t>(model.particles());
  s.T_0 = model.T_0;
  return s;
}

/// Opens the output, new or continued, and sets up the terminal.
Campaign open_campaign(const Case& c, const Model& model, OutputPlan plan, int threads,
                       const Checkpoint* resume, double dt) {
  Campaign campaign{c, model, std::move(plan), threads, {}, {}, {}, first_summary(c, model), 0.0};
  if (isatty(STDERR_FILENO))
    campaign.progress = std::make_shared<ProgressObserver>(stderr, steps_of_stages(c, model, dt));
  const auto progress = campaign.progress;
  const auto tell = [progress](const std::string& report) {
    if (progress) progress->clear();
    fmt::print(stderr, "{}\n", report);
  };
  campaign.files = open_output(campaign.plan, tell, VBOND_VERSION, resume);
  campaign.table = std::make_shared<TableObserver>(stdout);
  return campaign;
}

void save_summary(Campaign& campaign, const State& state) {
  RunSummary& s = campaign.summary;
  s.bonds = static_cast<std::int64_t>(state.bonds.size());
  s.energy_balance_error = campaign.files.history->largest_balance_error();
  const RangeCounts ranges = count_ranges(state);
  s.strained = ranges.strained;
  s.snapped = ranges.snapped;
  s.ever_strained = campaign.files.watch->watch().record().strained;
  s.ever_snapped = campaign.files.watch->watch().record().snapped;
  double output = campaign.table->seconds();
  s.wall_time = {{"build", campaign.building}, {"steps", 0.0}};
  for (const auto& [name, seconds] : campaign.files.seconds()) {
    s.wall_time.push_back({name, seconds});
    output += seconds;
  }
  s.wall_time.push_back({"terminal", campaign.table->seconds()});
  s.wall_time[1].seconds = std::max(0.0, s.stepping_seconds - output);
  write_summary(campaign.plan.folder / "run.json", s);
}

/// Runs one stage from this state and returns why it stopped; the state is moved on.
StopReason run_stage(Campaign& campaign, Stage stage, State& state) {
  Simulation run(campaign.model, std::move(stage), std::move(state), campaign.threads);
  for (const auto& o : campaign.files.all()) run.add_observer(o);
  run.add_observer(campaign.table);
  if (campaign.progress) run.add_observer(campaign.progress);

  const std::int64_t first = run.state().clock.step;
  const auto start = Clock::now();
  StopReason why = StopReason::running;
  try {
    why = run.run([] { return caught_signal() != 0; });
  } catch (const Diverged&) {
    if (campaign.progress) campaign.progress->clear();
    campaign.files.watch->watch().summarise();
    fmt::print("results up to there in {}\n", campaign.plan.folder.string());
    throw;
  }
  campaign.summary.stepping_seconds += seconds_since(start);
  campaign.summary.bond_steps +=
      (run.state().clock.step - first) * static_cast<std::int64_t>(run.state().bonds.size());
  campaign.summary.stages.push_back(summarise_stage(run, why));
  state = run.state();
  return why;
}

void say_end(const Campaign& campaign, StopReason why) {
  const RunSummary& s = campaign.summary;
  for (const StageSummary& stage : s.stages)
    if (stage.critical_force)
      fmt::print("critical force of stage \"{}\": {:.6g}\n", stage.name, *stage.critical_force);
  fmt::print("largest error of the energy balance: {:.2g}\n", s.energy_balance_error);
  if (s.ever_snapped > 0)
    fmt::print("{} bonds snapped on the way, {} are at the end: see docs/theory.md\n", s.ever_snapped,
               s.snapped);
  fmt::print("{}", timing_table(s.wall_time));
  fmt::print("results in {}\n", campaign.plan.folder.string());
  if (why == StopReason::interrupted)
    fmt::print(stderr, "stopped by a signal; go on with: vbond resume {}\n", campaign.plan.folder.string());
}

/// Runs from the state's stage to the last one. `prepared` is the stage the state is in.
int run_stages(Campaign& campaign, Stage prepared, State state) {
  catch_signals();
  const auto stages = static_cast<std::int32_t>(campaign.c.stages.size());
  StopReason why = StopReason::running;
  while (true) {
    if (campaign.c.stages.size() > 1) fmt::print("stage {}\n", prepared.name);
    why = run_stage(campaign, std::move(prepared), state);
    save_summary(campaign, state);
    if (why == StopReason::interrupted || state.clock.stage + 1 == stages) break;
    state.clock = {.step = state.clock.step,
                   .stage_step = 0,
                   .stage = state.clock.stage + 1,
                   .stage_start = state.clock.time(),
                   .dt = 0};
    prepared = build_stage(campaign.c, campaign.model, state.clock.stage, state);
  }
  say_end(campaign, why);
  if (why != StopReason::interrupted) return done;
  return caught_signal() == SIGTERM ? on_sigterm : on_sigint;
}

/// Removes what a run writes, and nothing else that may be in the folder.
void remove_output(const fs::path& folder) {
  for (const char* name : {"history.csv", "run.json", "resolved.toml", "checkpoint.h5", "particles.pvd",
                           "bonds.pvd", "dump.lammpstrj", "frames"})
    fs::remove_all(folder / name);
}

/// Makes the folder, or with force clears what an earlier run left in it. Throws CaseError or IoError.
void claim_folder(const fs::path& folder, bool force) {
  std::error_code e;
  const bool occupied = fs::exists(folder, e) && !(fs::is_directory(folder, e) && fs::is_empty(folder, e));
  if (occupied && !force)
    throw CaseError({{},
                     folder.string() + " already exists",
                     "an earlier output is never overwritten by itself",
                     "choose another folder with -o, or replace this one with --force"});
  if (occupied) remove_output(folder);
  fs::create_directories(folder, e);
  if (e) throw IoError(folder.string() + ": cannot be created: " + e.message());
}

}  // namespace

int run(const RunOptions& options) {
  const auto start = Clock::now();
  const Case c = read_case(options.case_file);
  Built built = build(c);
  Stage first = build_stage(c, built.model, 0, built.state);
  const fs::path folder = options.folder.value_or(options.case_file.stem().string() + ".out");
  OutputPlan plan = plan_output(c, built.model, folder);

  claim_folder(folder, options.force);
  replace_file(folder / "resolved.toml", to_toml(c));
  print_overview(c, built.model, built.state, first);
  Campaign campaign = open_campaign(c, built.model, std::move(plan), options.threads, nullptr, first.dt);
  campaign.building = seconds_since(start);
  return run_stages(campaign, std::move(first), std::move(built.state));
}

int resume(const fs::path& folder, int threads) {
  const auto start = Clock::now();
  const Case c = read_case(folder / "resolved.toml");
  const Built built = build(c);
  Checkpoint checkpoint = read_checkpoint(folder / "checkpoint.h5", built.model);
  State& state = checkpoint.state;
  Stage stage = build_stage(c, built.model, state.clock.stage, state);

  Campaign campaign =
      open_campaign(c, built.model, plan_output(c, built.model, folder), threads, &checkpoint, stage.dt);
  if (fs::exists(folder / "run.json"))
    campaign.summary.stages = read_stages_before(folder / "run.json", state.clock.stage);
  campaign.building = seconds_since(start);
  fmt::print("resumed at step {} of stage {}\n", state.clock.stage_step, stage.name);
  return run_stages(campaign, std::move(stage), std::move(state));
}

}  // namespace vbond::app
