#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "folder.hpp"
#include "prepare.hpp"
#include "signals.hpp"
#include "vbond/build/build.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/bond_look.hpp"
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

/// Prints in any case: a terminal that has gone away, as on SIGHUP, must not end a run.
void say(const std::string& text, std::FILE* out = stdout) {
  std::fwrite(text.data(), 1, text.size(), out);
  std::fflush(out);
}

/// Everything a run in progress has at hand.
struct Campaign {
  const Case& c;
  const Model& model;
  OutputPlan plan;
  int threads = 1;
  std::string program;  // as it was called
  FileObservers files;
  std::shared_ptr<TableObserver> table;
  std::shared_ptr<ProgressObserver> progress;  // null unless stderr is a terminal
  RunSummary summary;
  double building = 0, running = 0;  // seconds; running: steps and what observers do between them
  StepTimes times;
};

RunSummary first_summary(const Case& c, const Model& model, int threads) {
  RunSummary s;
  s.title = c.title;
  s.version = VBOND_VERSION;
  s.units = model.units;
  s.particles = static_cast<std::int64_t>(model.particles());
  s.T_0 = model.T_0;
  s.instruction_set = instruction_set();
  s.threads = threads;
  return s;
}

/// Opens the output, new or continued, and sets up the terminal.
Campaign open_campaign(const Case& c, const Model& model, OutputPlan plan, int threads,
                       const std::string& program, const Checkpoint* resume, double dt) {
  Campaign campaign{.c = c,
                    .model = model,
                    .plan = std::move(plan),
                    .threads = threads,
                    .program = program,
                    .files = {},
                    .table = {},
                    .progress = {},
                    .summary = first_summary(c, model, threads),
                    .times = {}};
  if (isatty(STDERR_FILENO))
    campaign.progress = std::make_shared<ProgressObserver>(stderr, steps_of_stages(c, model, dt));
  const auto progress = campaign.progress;
  const auto tell = [progress](const std::string& report) {
    if (progress) progress->clear();
    say(report + "\n", stderr);
  };
  campaign.files = open_output(campaign.plan, tell, VBOND_VERSION, resume);
  campaign.table = std::make_shared<TableObserver>(stdout);
  return campaign;
}

/// Wall time by phase; the steps get what observers leave of the time in which they ran.
void save_summary(Campaign& campaign) {
  RunSummary& s = campaign.summary;
  s.energy_balance_error = campaign.files.history->largest_balance_error();
  s.ever_strained = campaign.files.watch->watch().record().strained;
  s.ever_snapped = campaign.files.watch->watch().record().snapped;
  std::vector<PhaseTime> output;
  for (const auto& [name, seconds] : campaign.files.seconds()) output.push_back({name, seconds});
  const double progress = campaign.progress ? campaign.progress->seconds() : 0.0;
  output.push_back({"terminal", campaign.table->seconds() + progress});
  double between_steps = 0.0;
  for (const PhaseTime& p : output) between_steps += p.seconds;
  s.stepping_seconds = std::max(0.0, campaign.running - between_steps);
  s.wall_time = split_steps(s.stepping_seconds, campaign.times);
  s.wall_time.insert(s.wall_time.begin(), {"build", campaign.building});
  s.wall_time.insert(s.wall_time.end(), output.begin(), output.end());
  write_summary(campaign.plan.folder / "run.json", s);
}

/// Adds a stage that has come to an end, whichever way, to the summary.
void add_stage(RunSummary& s, const Simulation& run, StopReason why, std::int64_t first_step) {
  const RangeCounts ranges = count_ranges(run);
  s.bonds = count_bonds(run);
  s.threads_used = run.threads();
  s.strained = ranges.strained;
  s.snapped = ranges.snapped;
  s.bond_steps += (run.clock().step - first_step) * s.bonds;
  s.stages.push_back(summarise_stage(run, why));
}

/// Runs one stage from this state and returns why it stopped; the state is moved on.
StopReason run_stage(Campaign& campaign, Stage stage, State& state) {
  const auto entered = Clock::now();
  Simulation run(campaign.model, std::move(stage), std::move(state), campaign.threads);
  campaign.building += seconds_since(entered);
  for (const auto& o : campaign.files.all()) run.add_observer(o);
  run.add_observer(campaign.table);
  if (campaign.progress) run.add_observer(campaign.progress);

  const std::int64_t first = run.clock().step;
  const auto start = Clock::now();
  const auto stopped = [&](StopReason why) {
    campaign.running += seconds_since(start);
    campaign.times.bonds += run.times().bonds;
    campaign.times.contacts += run.times().contacts;
    campaign.times.integrate += run.times().integrate;
    add_stage(campaign.summary, run, why, first);
    save_summary(campaign);
  };
  StopReason why = StopReason::running;
  try {
    why = run.run([] { return caught_signal() != 0; });
  } catch (const Diverged&) {
    if (campaign.progress) campaign.progress->clear();
    campaign.files.watch->watch().summarise();
    stopped(StopReason::diverged);
    say(fmt::format("results up to there in {}\n", campaign.plan.folder.string()));
    throw;
  }
  stopped(why);
  state = std::move(run).take_state();
  return why;
}

void say_end(const Campaign& campaign, StopReason why) {
  const RunSummary& s = campaign.summary;
  const std::string folder = campaign.plan.folder.string();
  std::string text;
  for (const StageSummary& stage : s.stages)
    if (stage.critical_force)
      text += fmt::format("critical force of stage \"{}\": {:.6g}\n", stage.name, *stage.critical_force);
  text += fmt::format("largest error of the energy balance: {:.2g}\n", s.energy_balance_error);
  if (s.ever_snapped > 0)
    text += fmt::format("{} bonds snapped on the way, {} are at the end: see docs/theory.md\n",
                        s.ever_snapped, s.snapped);
  say(text + timing_table(s.wall_time) + "results in " + folder + "\n");
  if (why == StopReason::interrupted)
    say("stopped by a signal; go on with: " + campaign.program + " resume " + folder + "\n", stderr);
}

/// Runs from the state's stage to the last one. `prepared` is the stage the state is in.
int run_stages(Campaign& campaign, Stage prepared, State state) {
  catch_signals();
  const auto stages = static_cast<std::int32_t>(campaign.c.stages.size());
  StopReason why = StopReason::running;
  while (true) {
    if (campaign.c.stages.size() > 1) say("stage " + prepared.name + "\n");
    why = run_stage(campaign, std::move(prepared), state);
    if (why == StopReason::interrupted || state.clock.stage + 1 == stages) break;
    state.clock = {.step = state.clock.step,
                   .stage_step = 0,
                   .stage = state.clock.stage + 1,
                   .stage_start = state.clock.time(),
                   .dt = 0};
    const auto start = Clock::now();
    prepared = build_stage(campaign.c, campaign.model, state.clock.stage, state);
    campaign.building += seconds_since(start);
  }
  say_end(campaign, why);
  if (why != StopReason::interrupted) return done;
  return caught_signal() == SIGTERM ? on_sigterm : caught_signal() == SIGHUP ? on_sighup : on_sigint;
}

/// What may not be edited before going on. An elastic bond keeps its constants for good: the bonds of the
/// start must be those the run began with.
void check_edits(const Case& c, const State& start, const State& now, const fs::path& case_file) {
  if (static_cast<std::size_t>(now.clock.stage) >= c.stages.size())
    throw CaseError(
        {{case_file.string(), 0, 0},
         fmt::format("resolved.toml was edited: it has {} stages, and the checkpoint is in stage {}",
                     c.stages.size(), now.clock.stage + 1),
         "stages that have begun cannot be left out",
         "undo the edit"});
  const auto &made = start.bonds, &kept = now.bonds;
  if (made.size() <= kept.size() && std::equal(made.begin(), made.end(), kept.begin())) return;
  throw CaseError(
      {{case_file.string(), 0, 0},
       "resolved.toml was edited: its bonds are not those of the checkpoint",
       "bonds are made once and kept with their constants; durations, loads and output may be edited",
       "undo the edit, or start a new run of the edited case with vbond run"});
}

}  // namespace

int run(const RunOptions& options) {
  const auto start = Clock::now();
  const Case c = read_case(options.case_file);
  Built built = build(c);
  Stage first = build_stage(c, built.model, 0, built.state);
  OutputPlan plan = plan_output(c, built.model, {});  // all that may be wrong with the case is known by now

  plan.folder = claim_folder(options.case_file, options.folder, options.force);
  replace_file(plan.folder / "resolved.toml", to_toml(c));
  say("output folder    " + plan.folder.string() + "\n");
  print_overview(c, built.model, built.state, first);
  print_machine(options.threads);
  Campaign campaign =
      open_campaign(c, built.model, std::move(plan), options.threads, options.program, nullptr, first.dt);
  campaign.building = seconds_since(start);
  return run_stages(campaign, std::move(first), std::move(built.state));
}

int resume(const fs::path& folder, int threads, const std::string& program) {
  const auto start = Clock::now();
  std::error_code e;
  if (!fs::exists(folder / "resolved.toml", e))
    throw IoError(folder.string() + ": is not an output folder of vbond run: it has no resolved.toml");
  if (!fs::exists(folder / "checkpoint.h5", e))
    throw IoError(folder.string() + "/checkpoint.h5: there is none, the run was stopped before its first " +
                  "checkpoint; set output.checkpoint = {every = ...} in the case and run it again");
  const Case c = read_case(folder / "resolved.toml");
  const Built built = build(c);
  Checkpoint checkpoint = read_checkpoint(folder / "checkpoint.h5", built.model);
  State& state = checkpoint.state;
  check_edits(c, built.state, state, folder / "resolved.toml");
  Stage stage = build_stage(c, built.model, state.clock.stage, state);

  Campaign campaign = open_campaign(c, built.model, plan_output(c, built.model, folder), threads, program,
                                    &checkpoint, stage.dt);
  if (fs::exists(folder / "run.json"))
    campaign.summary.stages = read_stages_before(folder / "run.json", state.clock.stage);
  campaign.building = seconds_since(start);
  say(fmt::format("resumed at step {} of stage {}, output folder {}\n", state.clock.stage_step, stage.name,
                  folder.string()));
  print_machine(threads);
  return run_stages(campaign, std::move(stage), std::move(state));
}

}  // namespace vbond::app
