#pragma once
#include <optional>

#include "campaign.hpp"
#include "vbond/build/build.hpp"
#include "vbond/case/case.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/statics.hpp"

/// What the program does with static stages. There are two files of these functions: static_stage.cpp, and
/// no_statics.cpp for a program without that library.
namespace vbond::app {

/// Throws CaseError if the case needs statics and this program was built without.
void require_statics(const Case& c);

/// The exact critical step for build_stage; empty if this program cannot tell.
ExactCriticalStep exact_step();

/// Why a stage that begins in this state would be refused: its bodies can move freely.
std::optional<NoEquilibrium> refusal_of(const Model& model, const StaticStage& stage, const State& state);

/// How a stage that begins in this state will be solved.
SolverChoice solver_of(const Model& model, const StaticStage& stage, const State& state);

/// Runs a static stage as a whole, with its output. `start` is the state before the stage's bonds were made:
/// what its checkpoint holds until it has ended. Returns true if it has come to its end: the state is then
/// the balance it leaves, and its clock that of the next stage; false if it was interrupted. Throws
/// NoEquilibrium or Diverged, with results up to there written.
bool run_static_leg(Campaign& campaign, const StaticStage& stage, const State& start, State& state);

}  // namespace vbond::app
