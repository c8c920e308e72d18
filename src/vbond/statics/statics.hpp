#pragma once
#include <functional>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/fracture_under_way.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// What a static stage tells while it works, and asks.
struct StaticHooks {
  std::function<void(const StaticPoint&)> point;  ///< each balance that was found; may be empty
  std::function<void(const std::string&)> tell;   ///< one report, without a line end; may be empty
  std::function<bool()> interrupted;              ///< asked between steps, and within; may be empty
  /// What the stage is at, one line every few seconds, without a line end; may be empty.
  std::function<void(const std::string&)> progress = {};
  /// What a stage of fracture knows beside the state of the last point, after each point; may be empty.
  std::function<void(FractureUnderWay)> under_way = {};
  /// The point from which a stage of fracture goes on, which was handed to `point` before it was stopped; may
  /// be empty.
  std::function<void(const StaticPoint&)> goes_on = {};
  /// That sum up what bonds do, and of solutions with a factor that a stage of fracture keeps. What a stage
  /// finds does not depend on their number; more than eight are not used.
  int threads = 1;
};

struct StaticOutcome {
  StaticResult result;
  State state;  ///< in balance, at rest
};

/// Runs a static stage of any kind from this state. On return the state is the last balance found: of an
/// equilibrium the one at load factor 1, of a path its last point, of buckling and modes the one they started
/// from. The clock counts one step per point. Throws NoEquilibrium, which names the load factor reached and
/// what stood in the way; every balance up to there has been handed to hooks.point. Throws
/// std::invalid_argument if model, stage or state have a mistake (model/mistakes.hpp). The energy books of
/// the state are left alone; a Run (run/run.hpp) opens them anew.
///
/// then: a stage of fracture goes on where hooks.under_way told this, in the state of the last point before
/// it. All that it finds, and the last bit of it, is as if it had not been stopped.
StaticOutcome run_static_stage(const Model& model, const StaticStage& stage, State state,
                               const StaticHooks& hooks, const FractureUnderWay* then = nullptr);

/// Throws NoEquilibrium, naming them, if parts of the body can move freely, as run_static_stage does when a
/// stage of balance, path or buckling begins, or if supports hold everything, which only a balance and a
/// fracture take. Modes take free bodies.
void refuse_free_bodies(const Model& model, const StaticStage& stage, const State& state);

/// With what a static stage solves its linear equations.
struct SolverChoice {
  bool direct = true;
  bool multigrid = false;   ///< neither: the factor does not fit into memory
  double factor_bytes = 0;  ///< of the direct solver's factor, also where it does not fit; infinite: it has
                            ///< more than 2^31 entries, and cannot be made; 0: not looked at
  bool quicker_by_multigrid = false;  ///< direct, but a build with multigrid would be much quicker
};

/// The choice for a stage that begins in this state: works out the pattern of its tangent and the order of
/// elimination, but no factor.
SolverChoice choose_solver(const Model& model, const StaticStage& stage, const State& state);

/// The largest stable step of leap-frog for small motions about this state, 2 / omega_max of the assembled
/// body with present contacts and these held degrees of freedom. Particles that just touch, to rounding,
/// count as touching, and of bonds with two slopes the larger one; where bonds damp, which takes smaller
/// steps, the bound of the single bonds if that is less.  [time] Infinite if nothing is elastic; throws
/// NoConvergence, and std::invalid_argument as run_static_stage does.
double exact_critical_step(const Model& model, const State& state, const std::vector<Support>& supports);

}  // namespace vbond
