#include <cmath>
#include <utility>

#include "vbond/physics/bond_step.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/statics/blas_kernel.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond {

bool has_statics() {
  return true;
}

StaticOutcome solve_static_stage(const Model& model, const StaticStage& stage, State state,
                                 const StaticHooks& hooks) {
  return run_static_stage(model, stage, std::move(state), hooks);
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

/// What pressure adds is a bound, as of the automatic step: its stiffness changes with its factor.
ExactCriticalStep exact_step() {
  return [](const Model& model, const State& state, const Stage& stage) {
    const double exact = exact_critical_step(model, state, stage.supports);
    const double pressed = lambda_of_pressures(stage.pressures, model.mass, state.r, stage.stops.duration);
    return pressed > 0.0 && std::isfinite(exact) ? critical_step(sq(2.0 / exact) + pressed) : exact;
  };
}

}  // namespace vbond
