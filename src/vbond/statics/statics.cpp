#include "vbond/statics/statics.hpp"

#include <stdexcept>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/detail/one_blas_thread.hpp"

namespace vbond {
namespace {

StaticOutcome run_kind(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks) {
  switch (stage.kind) {
    case StageKind::dynamics: break;
    case StageKind::equilibrium: return find_equilibrium(model, stage, std::move(state), hooks);
    case StageKind::path: return follow_path(model, stage, std::move(state), hooks);
    case StageKind::buckling: return find_critical_loads(model, stage, std::move(state), hooks);
    case StageKind::modes: return find_modes(model, stage, std::move(state), hooks);
  }
  throw std::invalid_argument("run_static_stage: a dynamic stage is run by a Simulation");
}

}  // namespace

StaticOutcome run_static_stage(const Model& model, const StaticStage& stage, State state,
                               const StaticHooks& hooks) {
  require_consistent("run_static_stage", model, stage, state);
  const OneBlasThread alone;
  try {
    return run_kind(model, stage, std::move(state), hooks);
  } catch (const NoEquilibrium&) {
    throw;
  } catch (...) {
    throw current_failure(stage);
  }
}

void refuse_free_bodies(const Model& model, const StaticStage& stage, const State& state) {
  require_consistent("refuse_free_bodies", model, stage, state);
  const StaticBody body(model, stage, state);
  if (stage.kind != StageKind::equilibrium) refuse_nothing_free(body);
  if (stage.kind != StageKind::modes) refuse_rigid_motions(body);
}

SolverChoice choose_solver(const Model& model, const StaticStage& stage, const State& state) {
  require_consistent("choose_solver", model, stage, state);
  const StaticBody body(model, stage, state);
  const bool modes = stage.kind == StageKind::modes;  // they are not asked
  TangentSolver solver(modes ? LinearSolver::direct : stage.newton.solver);
  solver.prepare(body);
  return {!solver.iterative(), solver.last_factor().bytes()};
}

}  // namespace vbond
