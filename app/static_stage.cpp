#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "signals.hpp"
#include "statics.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/mode_frames.hpp"
#include "vbond/observe/report.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// The last point of balance that was found.
struct LastPoint {
  State state;
  double load_factor = 0;
  int number = 0;
  Energies energies;
};

void remove_file(const fs::path& path) {
  std::error_code e;
  fs::remove(path, e);
  if (e) throw IoError("cannot remove " + path.string() + ": " + e.message());
}

bool is_zero(const Vec3d& x) {
  return x == Vec3d{};
}

void tell_of_motion(const Campaign& campaign, const StaticStage& stage, const State& s) {
  if (!std::all_of(s.v.begin(), s.v.end(), is_zero) || !std::all_of(s.omega.begin(), s.omega.end(), is_zero))
    campaign.tell(
        fmt::format("stage \"{}\": the body was moving; a static stage begins and ends at rest", stage.name));
}

/// The clock counts points; books and records begin anew. A point takes 1, so that time is its number, or
/// where there are stages of dynamics one T_0, so that it is of the size of their times.
void begin(const Campaign& campaign, State& state) {
  const double T_0 = campaign.model.T_0;
  state.clock.dt = campaign.c.any_dynamics() && T_0 > 0.0 ? T_0 : 1.0;
  state.books = {};
  state.peak = {};
  state.rest = {};
}

StaticHooks hooks_of(Campaign& campaign, std::optional<LastPoint>& last) {
  StaticHooks hooks;
  hooks.point = [&campaign, &last](const StaticPoint& point) {
    campaign.files.record(campaign.model, point);
    campaign.table->print(point);
    last = {point.state, point.load_factor, last ? last->number + 1 : 1, point.energies};
  };
  hooks.tell = [&campaign](const std::string& report) { campaign.tell(report); };
  hooks.interrupted = [] { return caught_signal() != 0; };
  return hooks;
}

void add_stage(Campaign& campaign, const StaticStage& stage, const State& state, StaticSummary statics) {
  const RangeCounts ranges = count_ranges(state);
  RunSummary& s = campaign.summary;
  s.bonds = static_cast<std::int64_t>(state.bonds.size());
  s.strained = ranges.strained;
  s.snapped = ranges.snapped;
  StageSummary summary;
  summary.name = stage.name;
  summary.time = state.clock.time();
  summary.statics = std::move(statics);
  s.stages.push_back(std::move(summary));
  save_summary(campaign);
}

/// Leaves behind what there is: what the stage had found, the last balance, history and frames up to it, and
/// the reason.
void leave_failed(Campaign& campaign, const StaticStage& stage, const State& start,
                  const std::optional<LastPoint>& last, StaticResult found, const std::string& why) {
  campaign.clear_progress();
  campaign.files.watch->watch().summarise();
  StaticSummary failed{.kind = stage.kind, .result = std::move(found), .failure = why};
  failed.result.ended = "failed";
  std::string text;
  if (!failed.result.critical_loads.empty() || !failed.result.special_points.empty())
    text = static_report(stage.kind, failed.result, "");
  text += "results up to there in " + campaign.plan.folder.string() + "\n";
  if (last) {
    failed.result.load_factor = last->load_factor;
    failed.result.points = last->number;
    const fs::path path = campaign.plan.folder / "last_balance.h5";
    campaign.files.checkpoint->write(campaign.model, last->state, path);
    text += fmt::format("last balance, at load factor {:.8g}, in {}\n", last->load_factor, path.string());
  }
  add_stage(campaign, stage, last ? last->state : start, std::move(failed));
  say(text);
}

void write_modes(const Campaign& campaign, const StaticStage& stage, const StaticOutcome& outcome) {
  if (stage.frames_per_mode == 0) return;
  const auto write = [&](std::size_t k, const Shape& shape, std::optional<double> load_factor) {
    const double factor = swing_factor(campaign.model, outcome.state, shape, stage.amplitude);
    if (factor > 0.0)
      write_mode_frames(campaign.plan.folder, stage.name, static_cast<int>(k) + 1, stage.frames_per_mode,
                        factor, campaign.model, outcome.state, shape, load_factor,
                        campaign.plan.frame_format);
  };
  const StaticResult& r = outcome.result;
  for (std::size_t k = 0; k < r.critical_loads.size(); ++k)
    write(k, r.critical_loads[k].mode, r.critical_loads[k].load_factor);
  for (std::size_t k = 0; k < r.modes.size(); ++k)
    if (!r.modes[k].rigid) write(k, r.modes[k].shape, {});
}

/// Runs the stage and adds its wall time, output apart, whichever way it ends.
StaticOutcome solve(Campaign& campaign, const StaticStage& stage, State state, const StaticHooks& hooks) {
  const auto start = WallClock::now();
  const double output_before = campaign.output_seconds();
  const auto stop = [&] {
    campaign.balancing += seconds_since(start) - (campaign.output_seconds() - output_before);
  };
  try {
    StaticOutcome outcome = run_static_stage(campaign.model, stage, std::move(state), hooks);
    stop();
    return outcome;
  } catch (...) {
    stop();
    throw;
  }
}

StaticOutcome solve_or_leave(Campaign& campaign, const StaticStage& stage, State state,
                             std::optional<LastPoint>& last) {
  const State start = state;
  try {
    return solve(campaign, stage, std::move(state), hooks_of(campaign, last));
  } catch (const IoError&) {  // no more can be written
    throw;
  } catch (const StaticStageFailed& e) {
    leave_failed(campaign, stage, start, last, e.found, e.what());
    throw;
  } catch (const std::exception& e) {  // no balance, a bond has closed up, or memory has run out
    leave_failed(campaign, stage, start, last, {}, e.what());
    throw;
  }
}

}  // namespace

void require_statics(const Case&) {}

ExactCriticalStep exact_step() {
  return [](const Model& model, const State& state, const Stage& stage) {
    return exact_critical_step(model, state, stage.supports);
  };
}

std::optional<NoEquilibrium> refusal_of(const Model& model, const StaticStage& stage, const State& state) {
  try {
    refuse_free_bodies(model, stage, state);
  } catch (const NoEquilibrium& e) {
    return e;
  }
  return std::nullopt;
}

SolverChoice solver_of(const Model& model, const StaticStage& stage, const State& state) {
  return choose_solver(model, stage, state);
}

bool run_static_leg(Campaign& campaign, const StaticStage& stage, const State& start, State& state) {
  campaign.files.checkpoint->write(campaign.model, start);
  remove_file(campaign.plan.folder / "last_balance.h5");
  remove_mode_frames(campaign.plan.folder, stage.name);
  tell_of_motion(campaign, stage, state);
  begin(campaign, state);

  std::optional<LastPoint> last;
  StaticOutcome outcome = solve_or_leave(campaign, stage, std::move(state), last);
  campaign.files.watch->watch().summarise();
  const bool ended = outcome.result.ended != "interrupted";
  if (ended) {
    if (!last) throw std::logic_error("stage \"" + stage.name + "\" ended without a point of balance");
    say(static_report(stage.kind, outcome.result, campaign.model.units == UnitSystem::si ? " s" : ""));
    const auto writing = WallClock::now();
    write_modes(campaign, stage, outcome);
    campaign.balancing += seconds_since(writing);
    outcome.state.books = {.at_start = last->energies.total()};
  }
  state = std::move(outcome.state);
  add_stage(campaign, stage, state, {.kind = stage.kind, .result = std::move(outcome.result), .failure = {}});
  if (!ended) return false;
  begin_next_stage(state.clock);
  campaign.files.checkpoint->write(campaign.model, state);
  return true;
}

}  // namespace vbond::app
