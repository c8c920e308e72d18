#include <fmt/core.h>

#include <csignal>
#include <exception>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "failure.hpp"
#include "folder.hpp"
#include "inputs.hpp"
#include "lock.hpp"
#include "prepare.hpp"
#include "processes.hpp"
#include "report_command.hpp"
#include "resume_from.hpp"
#include "shell.hpp"
#include "signals.hpp"
#include "static_leg.hpp"
#include "status.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/summary.hpp"
#include "vbond/observe/table_text.hpp"
#include "vbond/run/memory_needed.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/run/run.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/own_bonds.hpp"
#include "vbond/setup/times.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// Adds a stage that has come to an end, whichever way, to the summary.
void add_stage(RunSummary& s, const Simulation& run, StopReason why, std::int64_t first_step,
               const std::string& failure) {
  const RangeCounts ranges = count_ranges(run);
  s.bonds = count_bonds(run.part(Show::bonds));
  s.threads_used = run.times().threads;
  s.strained = ranges.strained;
  s.snapped = ranges.snapped;
  s.bond_steps += (run.clock().step - first_step) * s.bonds;
  s.stages.push_back(summarise_stage(run, why));
  s.stages.back().failure = failure;
}

/// Says what step the run has, once it is known, and of every stage which times it does not meet. Steps to
/// come are counted anew by the step of each stage.
void begin_dynamics(Campaign& campaign, const Stage& stage) {
  const Clock& clock = campaign.run.clock();
  const bool known = !campaign.ahead.empty(), begins = clock.stage_step == 0;
  if (!known) campaign.ahead = steps_ahead(campaign.c, campaign.run);
  campaign.progress->expect(steps_of_stages(campaign.c, campaign.run.model(), campaign.ahead,
                                            campaign.run.stage_index(), stage.dt));
  if (begins && clock.stage == 0) return;  // told before the run
  if (begins && !known)
    return print_step(campaign.c, campaign.run.model(), campaign.run.body_at_start(), stage);
  for (const std::string& line : times_not_met(stage)) campaign.tell(line);
}

/// Runs the stage of dynamics that was prepared. Returns true if it has come to its end, false if it was
/// interrupted.
bool run_dynamics_leg(Campaign& campaign) {
  Run& run = campaign.run;
  begin_dynamics(campaign, std::get<Stage>(run.prepare()));
  const auto entered = WallClock::now();
  run.begin();
  campaign.building += seconds_since(entered);
  campaign.heartbeat->begin_stage();

  const std::int64_t first = run.clock().step;
  const auto start = WallClock::now();
  const double output_before = campaign.output_seconds();
  campaign.stage_end = [&](const Simulation& stage, StopReason why, const std::string& failure) {
    if (why == StopReason::diverged) {
      campaign.clear_progress();
      campaign.files.watch->watch().summarise();
    }
    campaign.stepping += seconds_since(start) - (campaign.output_seconds() - output_before);
    campaign.times.bonds += stage.times().bonds;
    campaign.times.contacts += stage.times().contacts;
    campaign.times.integrate += stage.times().integrate;
    campaign.times.anew += stage.times().anew;
    add_stage(campaign.summary, stage, why, first, failure);
    save_summary(campaign);
  };
  try {
    return !run.run_stage().interrupted();
  } catch (const Diverged&) {
    say(fmt::format("results up to there in {}\n", campaign.plan.folder.string()));
    throw;
  }
}

std::vector<PackingSummary> summarise(const std::vector<std::pair<std::string, packing::Packing>>& packings) {
  std::vector<PackingSummary> all;
  for (const auto& [name, p] : packings) {
    const packing::Measured& is = p.is;
    PackingSummary s;
    s.name = name;
    s.grains = static_cast<std::int64_t>(p.kind.size());
    s.rattlers = static_cast<std::int64_t>(is.rattlers);
    s.removed = static_cast<std::int64_t>(p.removed), s.grown = static_cast<std::int64_t>(p.grown);
    s.porosity = is.porosity, s.core_porosity = is.core_porosity;
    s.least_radius = is.least_radius, s.mean_radius = is.mean_radius, s.largest_radius = is.largest_radius;
    s.size_factor = p.size_factor, s.sizes_off = p.sizes_off;
    s.contacts = is.contacts, s.backbone_contacts = is.backbone_contacts;
    s.overlap = std::max(is.largest_overlap, is.largest_wall_overlap), s.pressure = p.pressure;
    if (is.cells) {
      s.least_cell_volume = is.cells->least, s.mean_cell_volume = is.cells->mean;
      s.largest_cell_volume = is.cells->largest, s.cell_faces = is.cells->faces;
      s.least_local_porosity = is.cells->least_porosity, s.mean_local_porosity = is.cells->mean_porosity;
      s.largest_local_porosity = is.cells->largest_porosity;
    }
    for (std::size_t k = 0; k < is.gaps.size(); ++k) s.neighbours.push_back({is.gaps[k], is.neighbours[k]});
    s.rdf_step = packing::Measured::rdf_step, s.rdf = is.rdf;
    all.push_back(std::move(s));
  }
  return all;
}

std::string resume_command(const Campaign& campaign) {
  return shell_word(campaign.program) + " resume " + shell_word(campaign.plan.folder.string());
}

void say_end(const Campaign& campaign, bool interrupted) {
  const RunSummary& s = campaign.summary;
  std::string text, folder = campaign.plan.folder.string();
  for (const StageSummary& stage : s.stages)
    if (stage.critical_force)
      text += fmt::format("peak force of stage \"{}\": {:.6g}{}\n", stage.name, *stage.critical_force,
                          s.units == UnitSystem::si ? " N" : "");
  if (any_dynamics(s))
    text += fmt::format("largest error of the energy balance: {:.2g}\n", s.energy_balance_error);
  if (s.breaks && s.breaks->broken > 0)
    text += fmt::format("{} bond{} broke: vbond breaks {} says why\n", s.breaks->broken,
                        s.breaks->broken == 1 ? "" : "s", shell_word(folder));
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
  if (!interrupted) return;
  const Run& run = campaign.run;
  const bool at_rest = is_static(run.stages().kind(run.stage_index())) && !run.under_way();
  say(std::string("stopped by a signal; ") + (at_rest ? "a static stage begins from its start; " : "") +
          "go on with: " + resume_command(campaign) + "\n",
      stderr);
}

/// A signal that came between two stages: the checkpoint is that of the state before the next one's bonds.
void stop_before_stage(Campaign& campaign) {
  campaign.files.checkpoint->write(campaign.run.model(), campaign.run.current());
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

/// Runs from the stage that was prepared to the last one.
int run_stages(Campaign& campaign) {
  Run& run = campaign.run;
  listen(campaign);
  while (true) {
    const std::size_t k = run.stage_index();
    if (run.stages().size() > 1) say("stage " + run.stages().name(k) + "\n");
    const bool ended =
        is_static(run.stages().kind(k)) ? run_static_leg(campaign) : run_dynamics_leg(campaign);
    if (!ended || run.complete()) {
      say_end(campaign, !ended);
      if (ended) return done;
      return status_of_signal();
    }
    if (run.exchange().leader_says(caught_signal() != 0)) {
      stop_before_stage(campaign);
      return status_of_signal();
    }
    const auto start = WallClock::now();
    run.prepare();
    campaign.building += seconds_since(start);
  }
}

/// The same, with its end in status.json.
int run_to_end(Campaign& campaign, std::FILE* status_lines) {
  campaign.heartbeat->print_to(status_lines);
  try {
    const int status = run_stages(campaign);
    campaign.heartbeat->end(status == done ? RunState::complete : RunState::interrupted);
    return status;
  } catch (...) {
    campaign.heartbeat->end(RunState::failed, failure_under_way().text);
    throw;
  }
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

/// From here on all processes step the run together.
void spread(Processes& processes, const Case& c, Run& run) {
  require_memory(c, run.model(), run.body_at_start(), processes.here());
  processes.begin_together(c);
  Partition* const partition = processes.partition();
  if (partition == nullptr) return;
  run.spread_over(*partition);
  say(fmt::format("ranks            {}\n", partition->ranks()));
}

/// The body of the case; of several processes each keeps its own bonds alone, where that can be.
Built build_for(Processes& processes, const Case& c, int threads) {
  Partition* const partition = processes.partition();
  if (partition == nullptr) return build(c, threads);
  return build(
      c, threads,
      {.all = *partition,
       .meet = [&processes] { processes.meet(); },
       .spread = [partition](
                     const Model& model, const State& state, const PerParticle<std::uint32_t>& bonds,
                     double longest) { return partition->spread_first(model, state, bonds, longest); }});
}

/// What one process does for all.
void do_for_all(Processes& processes, const std::function<void()>& work) {
  processes.exchange().together([&] {
    if (processes.leads()) work();
  });
}

Writes writes_here(Processes& processes) {
  return processes.leads() ? Writes::everything : Writes::own_parts;
}

}  // namespace

int run(const RunOptions& options) {
  const auto start = WallClock::now();
  Processes& processes = *options.processes;
  if (has_ranks && options.case_file == "-")
    throw std::invalid_argument("every rank reads the case: give a file, not the standard input");
  Case c = read_case(options.case_file, options.changes);
  require_statics(c);
  require_memory(c);
  require_memory(c, processes.here());
  Built built = build_for(processes, c, options.threads);
  require_memory(c, built.model, built.body());
  Run run(std::move(built.model), std::move(built.state), stages_of(c, options.threads, built.own),
          options.threads);
  run.begin_with_own_bonds(std::move(built.own));
  run.check();
  bonds_to_come(c, run);  // throws if they cannot fit into memory
  spread(processes, c, run);
  OutputPlan plan = plan_output(c, run.model(), {});  // all that may be wrong with the case is known by now

  if (options.report) warn_if_no_page();
  plan.writes = writes_here(processes);
  std::optional<ClaimedFolder> claimed;
  catch_broken_pipe();
  do_for_all(processes, [&] {
    claimed.emplace(claim_folder(c.file, options.folder, options.force));
    plan.folder = claimed->path;
    replace_file(plan.folder / "resolved.toml", to_toml(keep_inputs(c, plan.folder, claimed->old_inputs)));
  });
  plan.folder = processes.text_of_leader(plan.folder.string());
  say("output folder    " + plan.folder.string() + "\n");
  print_overview(c, run.model(), run.body_at_start());
  print_notes(built.notes);
  if (const Stage* dynamics = std::get_if<Stage>(&run.prepare()))
    print_step(c, run.model(), run.body_at_start(), *dynamics);
  print_machine(c, options.threads);
  Campaign campaign =
      open_campaign(c, run, std::move(plan), options.threads, options.program, nullptr, start);
  campaign.summary.packings = summarise(built.packings);
  campaign.summary.specimens = std::move(built.figures);
  campaign.building = seconds_since(start);
  try {
    const int status = run_to_end(campaign, options.status_lines);
    if (options.report && status == done && campaign.plan.writes_all()) report_on(campaign.plan.folder);
    say(processes.remarks());
    return status;
  } catch (const IoError& e) {  // no more can be written
    throw with_way_on(campaign, e);
  } catch (const std::exception&) {
    if (options.report && campaign.plan.writes_all()) report_on(campaign.plan.folder);
    throw;
  }
}

int resume(const fs::path& folder, const RunOptions& options) {
  const auto start = WallClock::now();
  Processes& processes = *options.processes;
  std::optional<FolderLock> lock;
  if (processes.leads()) lock.emplace(lock_old_output(folder));
  catch_broken_pipe();
  const Case c = read_case(folder / "resolved.toml");
  require_statics(c);
  require_memory(c);
  require_memory(c, processes.here());
  // bonds of particles that sinks took out have no first particle any more whose process could keep them
  Built built = c.sinks.empty() ? build_for(processes, c, options.threads) : build(c, options.threads);
  Checkpoint checkpoint = resume_from(processes, c, built, folder);
  const Clock clock = checkpoint.state.clock;  // all of the state that observers go on from
  Run run(std::move(built.model), std::move(checkpoint.state), stages_of(c, options.threads, built.own),
          options.threads);
  run.begin_with_own_bonds(std::move(built.own));
  checkpoint.state.clock = clock;
  if (checkpoint.under_way) run.go_on_within(checkpoint.under_way);
  const bool complete = run.complete();
  if (!complete) run.check();
  spread(processes, c, run);
  if (complete) {
    say("the run is complete, results in " + folder.string() + "\n");
    return done;
  }

  OutputPlan plan = plan_output(c, run.model(), folder);
  plan.writes = writes_here(processes);
  Campaign campaign =
      open_campaign(c, run, std::move(plan), options.threads, options.program, &checkpoint, start);
  campaign.summary.specimens = std::move(built.figures);
  if (fs::exists(folder / "run.json"))
    campaign.summary.stages = read_stages_before(folder / "run.json", run.clock().stage);
  campaign.summary.packings = summarise(built.packings);
  campaign.building = seconds_since(start);
  say(fmt::format("resumed at step {} of stage {}, output folder {}\n", run.clock().stage_step,
                  run.stages().name(run.stage_index()), folder.string()));
  print_machine(c, options.threads);
  try {
    const int status = run_to_end(campaign, options.status_lines);
    say(processes.remarks());
    return status;
  } catch (const IoError& e) {
    throw with_way_on(campaign, e);
  }
}

}  // namespace vbond::app
