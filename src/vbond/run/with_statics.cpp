#include <optional>
#include <utility>

#include "vbond/model/step_bound.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/statics/blas_kernel.hpp"

namespace vbond {

bool has_statics() {
  return true;
}

StaticOutcome solve_static_stage(const Model& model, const StaticStage& stage, State state,
                                 const StaticHooks& hooks, const FractureUnderWay* then) {
  return run_static_stage(model, stage, std::move(state), hooks, then);
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

std::string kernel_of_blas() {
  return blas_kernel();
}

std::string better_kernel_of_blas() {
  return better_blas_kernel();
}

/// What terms add is a bound, as of the automatic step: their stiffness may change with a factor.
ExactCriticalStep exact_step() {
  return [](const Model& model, const State& state, const Stage& stage) {
    const double exact = exact_critical_step(model, state, stage.supports);
    return with_terms({exact, std::nullopt, ""}, model, state, stage).dt;
  };
}

}  // namespace vbond
