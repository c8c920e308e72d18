#pragma once
#include <optional>
#include <string>

#include "vbond/core/error.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/statics/statics.hpp"

/// Static stages as far as this library was built with them: with_statics.cpp or no_statics.cpp. Without,
/// has_statics() is false and the others throw std::invalid_argument.
namespace vbond {

bool has_statics();

/// run_static_stage().
StaticOutcome solve_static_stage(const Model& model, const StaticStage& stage, State state,
                                 const StaticHooks& hooks, const FractureUnderWay* then);

/// Why a stage that begins in this state is refused: its bodies can move freely, or nothing is free.
std::optional<NoEquilibrium> refusal_of(const Model& model, const StaticStage& stage, const State& state);

/// How a stage that begins in this state will be solved.
SolverChoice solver_of(const Model& model, const StaticStage& stage, const State& state);

/// blas_kernel() and better_blas_kernel() (statics/blas_kernel.hpp); empty without statics, which alone use
/// it.
std::string kernel_of_blas();
std::string better_kernel_of_blas();

/// The exact critical step for build_stage(); empty without statics.
ExactCriticalStep exact_step();

}  // namespace vbond
