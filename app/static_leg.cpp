#include "static_leg.hpp"

#include <fmt/core.h>

#include <exception>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include "vbond/core/error.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/breaks_observer.hpp"
#include "vbond/observe/mode_frames.hpp"
#include "vbond/observe/table_text.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

void remove_file(const fs::path& path) {
  std::error_code e;
  fs::remove(path, e);
  if (e) throw IoError("cannot remove " + path.string() + ": " + e.message());
}

void add_stage(Campaign& campaign, const StageResult& result) {
  const State& state = campaign.run.current();
  const RangeCounts ranges = count_ranges(state);
  RunSummary& s = campaign.summary;
  s.bonds = static_cast<std::int64_t>(state.bonds.size());
  s.strained = ranges.strained;
  s.snapped = ranges.snapped;
  StageSummary summary;
  summary.name = result.name;
  summary.time = result.time;
  summary.statics = StaticSummary{result.kind, *result.statics, result.failure};
  s.stages.push_back(std::move(summary));
  save_summary(campaign);
  campaign.heartbeat->end_static_stage();
}

/// Leaves behind what there is: what the stage had found, the last balance, history and frames up to it, and
/// the reason.
void leave_failed(Campaign& campaign) {
  campaign.clear_progress();
  campaign.files.watch->watch().summarise();
  const StageResult& failed = campaign.run.results().back();
  const StaticResult& found = *failed.statics;
  std::string text;
  if (!found.critical_loads.empty() || !found.special_points.empty())
    text = static_report(failed.kind, found, "");
  text += "results up to there in " + campaign.plan.folder.string() + "\n";
  if (failed.steps > 0) {
    const fs::path path = campaign.plan.folder / "last_balance.h5";
    campaign.files.checkpoint->write(campaign.run.model(), campaign.run.current(), path);
    text += fmt::format("last balance, at load factor {:.8g}, in {}\n", found.load_factor, path.string());
  }
  add_stage(campaign, failed);
  say(text);
}

void record_breaks(Campaign& campaign, const Clock& start, const StaticResult& found) {
  if (campaign.files.breaks)
    campaign.files.breaks->add_breaks_at_rest(start, campaign.run.current(), found.fracture.breaks);
}

void write_modes(const Campaign& campaign, const StaticStage& stage, const StaticResult& found) {
  if (stage.frames_per_mode == 0 || !campaign.plan.writes_all()) return;
  const Model& model = campaign.run.model();
  const State& state = campaign.run.current();
  const auto write = [&](std::size_t k, const Shape& shape, const Shape& out_of_phase,
                         std::optional<double> load_factor) {
    const double factor = swing_factor(model, state, shape, stage.amplitude);
    if (factor > 0.0)
      write_mode_frames(campaign.plan.folder, stage.name, static_cast<int>(k) + 1, stage.frames_per_mode,
                        factor, model, state, {shape, out_of_phase}, load_factor,
                        campaign.plan.format_of_frames());
  };
  for (std::size_t k = 0; k < found.critical_loads.size(); ++k) {
    const CriticalLoad& c = found.critical_loads[k];
    write(k, c.mode, c.out_of_phase, c.load_factor);
  }
  for (std::size_t k = 0; k < found.modes.size(); ++k)
    if (!found.modes[k].rigid) write(k, found.modes[k].shape, found.modes[k].out_of_phase, {});
}

/// Runs the stage and adds its wall time, output apart, whichever way it ends.
StageResult solve(Campaign& campaign) {
  const auto start = WallClock::now();
  const double output_before = campaign.output_seconds();
  const auto stop = [&] {
    campaign.balancing += seconds_since(start) - (campaign.output_seconds() - output_before);
  };
  try {
    StageResult result = campaign.run.run_stage();
    stop();
    return result;
  } catch (...) {
    stop();
    throw;
  }
}

StageResult solve_or_leave(Campaign& campaign) {
  try {
    return solve(campaign);
  } catch (const IoError&) {  // no more can be written
    throw;
  } catch (const std::exception&) {  // no balance, a bond has closed up, or memory has run out
    leave_failed(campaign);
    throw;
  }
}

}  // namespace

bool run_static_leg(Campaign& campaign) {
  Run& run = campaign.run;
  const StaticStage stage = std::get<StaticStage>(run.prepare());
  const bool goes_on = run.under_way() != nullptr;
  if (campaign.plan.writes_all()) {
    if (!goes_on) campaign.files.checkpoint->write(run.model(), run.start_of_stage());
    remove_file(campaign.plan.folder / "last_balance.h5");
    remove_mode_frames(campaign.plan.folder, stage.name);
  }

  campaign.heartbeat->begin_stage();

  const Clock start = start_of_static_stage(run.clock());
  const StageResult result = solve_or_leave(campaign);
  campaign.files.watch->watch().summarise();
  if (!result.interrupted()) {
    say(static_report(stage.kind, *result.statics, run.model().units == UnitSystem::si ? " s" : ""));
    const auto writing = WallClock::now();
    write_modes(campaign, stage, *result.statics);
    campaign.balancing += seconds_since(writing);
    record_breaks(campaign, start, *result.statics);
  }
  add_stage(campaign, result);
  if (result.interrupted() && run.under_way()) write_within(campaign);
  if (result.interrupted()) return false;
  if (campaign.files.breaks)
    campaign.files.breaks->end_stage(run.model(), run.current(), run.clock().stage - 1);
  campaign.files.checkpoint->write(run.model(), run.current());
  return true;
}

}  // namespace vbond::app
