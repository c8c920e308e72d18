// A static stage of a run.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "vbond/model/bond_sums.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/run/run.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/statics/point_view.hpp"

namespace vbond {
namespace {

bool is_zero(const Vec3d& x) {
  return x == Vec3d{};
}

bool moves(const State& s) {
  return !std::all_of(s.v.begin(), s.v.end(), is_zero) ||
         !std::all_of(s.omega.begin(), s.omega.end(), is_zero);
}

}  // namespace

/// The clock counts points; books and records begin anew. A point takes 1, so that time is its number, or
/// where there are stages of dynamics one T_0, so that it is of the size of their times.
StageResult Run::run_static() {
  const auto& stage = std::get<StaticStage>(*stage_);
  if (!state_.dropped.empty())
    refuse("Run", {fmt::format("stage \"{}\" is static, and {} particles were dropped before it: "
                               "a balance is looked for with all particles",
                               stage.name, state_.dropped.size())});
  tell_notes_once();
  if (!state_.waiting.empty())
    refuse("Run", {fmt::format("stage \"{}\" is static, and {} particles have not come in yet: a balance is "
                               "looked for with all particles",
                               stage.name, state_.waiting.size())});
  if (under_way_) return run_on(stage);
  if (restart_) state_ = *std::exchange(restart_, {});
  if (moves(state_) && hooks_.tell)
    hooks_.tell(
        fmt::format("stage \"{}\": the body was moving; a static stage begins and ends at rest", stage.name));
  state_.clock.dt = any_dynamics() && model_.T_0 > 0.0 ? model_.T_0 : 1.0;
  state_.books = {};
  state_.peak = {};
  state_.rest = {};
  state_.breaks = 0;
  state_.pressed.clear();
  return run_on(stage);
}

void Run::go_on_within(std::shared_ptr<const FractureUnderWay> then) {
  const auto require = [](bool holds, const char* rule) {
    if (!holds) throw std::invalid_argument(std::string("Run::go_on_within: ") + rule);
  };
  require(then && then->begun && then->pattern, "there is nothing to go on with");
  require(!complete() && stages_->kind(stage_index()) == StageKind::fracture && !simulation_ && !under_way_,
          "the state is not of a stage of fracture");
  require(then->found.points == state_.clock.stage_step, "the state is of another point of the stage");
  refuse("Run::go_on_within", mistakes_in(model_, *then->begun));
  under_way_ = std::move(then);
}

/// From the state as it is to the end of the stage, or to an interruption.
StageResult Run::run_on(const StaticStage& stage) {
  StageResult result = find_balance(stage);
  if (result.interrupted()) return result;
  state_.books = opened_books(state_, potential_energies(model_, state_).total());
  under_way_.reset();
  stage_.reset();
  begin_next_stage(state_.clock);
  results_.push_back(result);
  return result;
}

/// Solves the stage and leaves its state, whichever way it ends; keeps what a stage that fails has found.
StageResult Run::find_balance(const StaticStage& stage) {
  StageResult result;
  result.name = stage.name;
  result.kind = stage.kind;
  StaticResult found;
  const State start = state_;
  const std::shared_ptr<const FractureUnderWay> then = under_way_;
  const std::int64_t first = then ? 0 : state_.clock.stage_step;
  const auto leave = [&] {
    result.steps = state_.clock.stage_step - first;
    result.time = state_.clock.time();
    result.statics = std::move(found);
  };
  double load_factor = 0.0;
  StaticHooks hooks{{}, hooks_.tell, hooks_.interrupted, hooks_.progress, {}, {}, threads_};
  hooks.point = [&](const StaticPoint& point) {
    const PointView view(model_, point);
    for (const auto& o : observers_) o->observe_balance(view, *view.balance());
    if (hooks_.balance) hooks_.balance(view);
    state_ = point.state;  // the last balance that is sound
    load_factor = point.load_factor;
  };
  hooks.under_way = [&](FractureUnderWay now) {
    under_way_ = std::make_shared<const FractureUnderWay>(std::move(now));
    if (hooks_.under_way) hooks_.under_way();
  };
  if (hooks_.goes_on)
    hooks.goes_on = [&](const StaticPoint& point) { hooks_.goes_on(PointView(model_, point)); };
  const auto failed = [&](const std::string& why) {
    fail(why);
    leave();
    result.failure = failure_;
    result.statics->ended = "failed";
    if (result.steps > 0) {
      result.statics->load_factor = load_factor;
      result.statics->points = static_cast<int>(result.steps);
    }
    results_.push_back(std::move(result));
  };
  try {
    exchange().together([&] {  // each process for itself, and only one may hear of an interruption
      StaticOutcome outcome = solve_static_stage(model_, stage, start, hooks, then.get());
      found = std::move(outcome.result);
      // of a stage that can go on the last point stays, which is that of under_way_
      if (!(under_way_ && found.ended == "interrupted")) state_ = std::move(outcome.state);
    });
    leave();
    if (exchange().leader_says(result.statics->ended == "interrupted")) {
      result.stop = StopReason::interrupted;
      if (!under_way_) restart_ = start;
    } else if (result.steps == 0) {
      throw std::logic_error("stage \"" + stage.name + "\" ended without a point of balance");
    }
    return result;
  } catch (const StaticStageFailed& e) {
    found = e.found;
    failed(e.what());
    throw;
  } catch (const std::exception& e) {  // no balance, a bond has closed up, memory has run out, a full disk
    failed(e.what());
    throw;
  }
}

}  // namespace vbond
