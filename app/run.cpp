#include <fmt/core.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "campaign.hpp"
#include "commands.hpp"
#include "folder.hpp"
#include "inputs.hpp"
#include "lock.hpp"
#include "memory.hpp"
#include "prepare.hpp"
#include "report.hpp"
#include "shell.hpp"
#include "signals.hpp"
#include "statics.hpp"
#include "vbond/build/build.hpp"
#include "vbond/build/times.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/report.hpp"
#include "vbond/observe/summary.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// A stage that is about to begin, or to go on.
struct Leg {
  std::variant<Stage, StaticStage> stage;
  State start;  // of a static stage: before its bonds were made; dynamics: empty
};

bool is_static(const Leg& leg) {
  return std::holds_alternative<StaticStage>(leg.stage);
}

/// Builds the stage that the state's clock stands in.
Leg prepare(const Case& c, const Model& model, State& state) {
  const std::int32_t k = state.clock.stage;
  if (!is_static(c.stages[static_cast<std::size_t>(k)].kind))
    return {build_stage(c, model, k, state, exact_step()), {}};
  State start = state;
  return {build_static_stage(c, model, k, state), std::move(start)};
}

/// Adds a stage that has come to an end, whichever way, to the summary.
void add_stage(RunSummary& s, const Simulation& run, StopReason why, std::int64_t first_step,
               const std::string& failure) {
  const RangeCounts ranges = count_ranges(run);
  s.bonds = count_bonds(run);
  s.threads_used = run.threads();
  s.strained = ranges.strained;
  s.snapped = ranges.snapped;
  s.bond_steps += (run.clock().step - first_step) * s.bonds;
  s.stages.push_back(summarise_stage(run, why));
  s.stages.back().failure = failure;
}

/// Says what step the run has, once it is known, and of every stage which times it does not meet.
void begin_dynamics(Campaign& campaign, const Stage& stage, const State& state) {
  const bool known = std::exchange(campaign.step_known, true), begins = state.clock.stage_step == 0;
  if (!known && campaign.progress)
    campaign.progress->expect(steps_of_stages(campaign.c, campaign.model, stage.dt));
  if (begins && state.clock.stage == 0) return;  // told before the run
  if (begins && !known) return print_step(campaign.c, campaign.model, state, stage);
  for (const std::string& line : times_not_met(stage)) campaign.tell(line);
}

/// Runs a stage of dynamics from this state, which is moved on. Returns true if it has come to its end: the
/// clock is then that of the next stage; false if it was interrupted.
bool run_dynamics_leg(Campaign& campaign, Stage stage, State& state) {
  begin_dynamics(campaign, stage, state);
  const auto entered = WallClock::now();
  Simulation run(campaign.model, std::move(stage), std::move(state), campaign.threads);
  campaign.building += seconds_since(entered);
  for (const auto& o : campaign.files.all()) run.add_observer(o);
  run.add_observer(campaign.table);
  if (campaign.progress) run.add_observer(campaign.progress);

  const std::int64_t first = run.clock().step;
  const auto start = WallClock::now();
  const double output_before = campaign.output_seconds();
  const auto stopped = [&](StopReason why, const std::string& failure) {
    campaign.stepping += seconds_since(start) - (campaign.output_seconds() - output_before);
    campaign.times.bonds += run.times().bonds;
    campaign.times.contacts += run.times().contacts;
    campaign.times.integrate += run.times().integrate;
    add_stage(campaign.summary, run, why, first, failure);
    save_summary(campaign);
  };
  StopReason why = StopReason::running;
  try {
    why = run.run([] { return caught_signal() != 0; });
  } catch (const Diverged& e) {
    campaign.clear_progress();
    campaign.files.watch->watch().summarise();
    stopped(StopReason::diverged, e.what());
    say(fmt::format("results up to there in {}\n", campaign.plan.folder.string()));
    throw;
  }
  stopped(why, {});
  state = std::move(run).take_state();
  if (why == StopReason::interrupted) return false;
  begin_next_stage(state.clock);
  return true;
}

std::string resume_command(const Campaign& campaign) {
  return shell_word(campaign.program) + " resume " + shell_word(campaign.plan.folder.string());
}

void say_end(const Campaign& campaign, bool interrupted) {
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
  if (s.ever_stretched > 0)
    text += fmt::format("{} bond{} longer than twice the length at rest on the way: see docs/theory.md\n",
                        s.ever_stretched, s.ever_stretched == 1 ? " was" : "s were");
  if (s.ever_overlapping > 0)
    text += fmt::format("{} pair{} of particles without a bond overlapped: see docs/theory.md\n",
                        s.ever_overlapping, s.ever_overlapping == 1 ? "" : "s");
  say(text + timing_table(s.wall_time) + "results in " + folder + "\n");
  if (interrupted) say("stopped by a signal; go on with: " + resume_command(campaign) + "\n", stderr);
}

/// A signal that came between two stages: the checkpoint is that of the state before the next one's bonds.
void stop_before_stage(Campaign& campaign, const State& state) {
  campaign.files.checkpoint->write(campaign.model, state);
  save_summary(campaign);
  say_end(campaign, true);
}

int status_of_signal() {
  switch (caught_signal()) {
    case SIGTERM: return on_sigterm;
    case SIGHUP: return on_sighup;
    case SIGPIPE: return on_sigpipe;
    default: return on_sigint;
  }
}

/// Runs from the state's stage to the last one. `leg` is the stage the state is in.
int run_stages(Campaign& campaign, Leg leg, State state) {
  catch_signals();
  const auto stages = static_cast<std::int32_t>(campaign.c.stages.size());
  while (true) {
    if (stages > 1)
      say("stage " + campaign.c.stages[static_cast<std::size_t>(state.clock.stage)].name + "\n");
    const bool ended = is_static(leg)
                           ? run_static_leg(campaign, std::get<StaticStage>(leg.stage), leg.start, state)
                           : run_dynamics_leg(campaign, std::get<Stage>(std::move(leg.stage)), state);
    if (!ended || state.clock.stage == stages) {
      say_end(campaign, !ended);
      if (ended) return done;
      return status_of_signal();
    }
    if (caught_signal() != 0) {
      stop_before_stage(campaign, state);
      return status_of_signal();
    }
    const auto start = WallClock::now();
    leg = prepare(campaign.c, campaign.model, state);
    campaign.building += seconds_since(start);
  }
}

/// What may not be edited before going on. An elastic bond keeps its constants for good: the bonds of the
/// start must be those the run began with.
void check_edits(const Case& c, const State& start, const State& now, const fs::path& case_file) {
  const auto stage = static_cast<std::size_t>(now.clock.stage);
  if (stage > c.stages.size() || (stage == c.stages.size() && now.clock.stage_step > 0))
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

/// A failure to write, such as a full disk, with the way to go on.
IoError with_way_on(const Campaign& campaign, const IoError& failure) {
  campaign.clear_progress();
  std::string text = failure.what();
  std::error_code e;
  if (fs::exists(campaign.plan.folder / "checkpoint.h5", e))
    text += "\n  once that is mended, go on from the last checkpoint with: " + resume_command(campaign);
  return IoError(text);
}

/// A report is worth less than the run: it is only told why there is none.
void report_on(const fs::path& folder) {
  try {
    say("report in " + write_report(folder).page.string() + "\n");
  } catch (const std::exception& e) {
    const std::string why = e.what();
    say("no report: " + why.substr(0, why.find('\n')) + "\n  vbond report " + shell_word(folder.string()) +
            " says more, and writes it once that is put right\n",
        stderr);
  }
}

/// Told before the run, which may take hours, and can go on meanwhile.
void warn_if_no_page() {
  try {
    require_page();
  } catch (const IoError& e) {
    say(std::string("warning: there will be no report: ") + e.what() + "\n", stderr);
  }
}

/// The lock of a folder that a run can be resumed in. Throws IoError.
FolderLock lock_old_output(const fs::path& folder) {
  std::error_code e;
  require_free(folder, run_lock);  // a run that has only begun has none of the files yet
  if (!fs::exists(folder / "resolved.toml", e))
    throw IoError(folder.string() + ": is not an output folder of vbond run: it has no resolved.toml");
  FolderLock lock(folder, run_lock);
  if (!fs::exists(folder / "checkpoint.h5", e))
    throw IoError(folder.string() + "/checkpoint.h5: there is none, the run was stopped before its first " +
                  "checkpoint; set output.checkpoint = {every = ...} in the case and run it again");
  return lock;
}

}  // namespace

int run(const RunOptions& options) {
  const auto start = WallClock::now();
  Case c = read_case(options.case_file);
  require_statics(c);
  require_memory(c);
  Built built = build(c);
  require_memory(c, built.model, built.state);
  Leg first = prepare(c, built.model, built.state);
  OutputPlan plan = plan_output(c, built.model, {});  // all that may be wrong with the case is known by now

  if (options.report) warn_if_no_page();
  const ClaimedFolder claimed = claim_folder(options.case_file, options.folder, options.force);
  plan.folder = claimed.path;
  catch_broken_pipe();
  replace_file(plan.folder / "resolved.toml", to_toml(keep_inputs(c, plan.folder, claimed.old_inputs)));
  say("output folder    " + plan.folder.string() + "\n");
  print_overview(c, built.model, built.state);
  print_notes(built.notes);
  if (const Stage* dynamics = std::get_if<Stage>(&first.stage))
    print_step(c, built.model, built.state, *dynamics);
  print_machine(options.threads);
  Campaign campaign =
      open_campaign(c, built.model, std::move(plan), options.threads, options.program, nullptr);
  campaign.building = seconds_since(start);
  try {
    const int status = run_stages(campaign, std::move(first), std::move(built.state));
    if (options.report && status == done) report_on(campaign.plan.folder);
    return status;
  } catch (const IoError& e) {  // no more can be written
    throw with_way_on(campaign, e);
  } catch (const std::exception&) {
    if (options.report) report_on(campaign.plan.folder);
    throw;
  }
}

int resume(const fs::path& folder, int threads, const std::string& program) {
  const auto start = WallClock::now();
  const FolderLock lock = lock_old_output(folder);
  catch_broken_pipe();
  const Case c = read_case(folder / "resolved.toml");
  require_statics(c);
  require_memory(c);
  const Built built = build(c);
  Checkpoint checkpoint = read_checkpoint(folder / "checkpoint.h5", built.model);
  State& state = checkpoint.state;
  check_edits(c, built.state, state, folder / "resolved.toml");
  if (static_cast<std::size_t>(state.clock.stage) == c.stages.size()) {
    say("the run is complete, results in " + folder.string() + "\n");
    return done;
  }
  Leg leg = prepare(c, built.model, state);

  Campaign campaign =
      open_campaign(c, built.model, plan_output(c, built.model, folder), threads, program, &checkpoint);
  if (fs::exists(folder / "run.json"))
    campaign.summary.stages = read_stages_before(folder / "run.json", state.clock.stage);
  campaign.building = seconds_since(start);
  say(fmt::format("resumed at step {} of stage {}, output folder {}\n", state.clock.stage_step,
                  c.stages[static_cast<std::size_t>(state.clock.stage)].name, folder.string()));
  print_machine(threads);
  try {
    return run_stages(campaign, std::move(leg), std::move(state));
  } catch (const IoError& e) {
    throw with_way_on(campaign, e);
  }
}

}  // namespace vbond::app
