#include <stdexcept>

#include "vbond/run/static_solver.hpp"

namespace vbond {
namespace {

[[noreturn]] void refuse(const StaticStage& stage) {
  throw std::invalid_argument("stage \"" + stage.name + "\" is static: this vbond was built without statics");
}

}  // namespace

bool has_statics() {
  return false;
}

StaticOutcome solve_static_stage(const Model&, const StaticStage& stage, State, const StaticHooks&,
                                 const FractureUnderWay*) {
  refuse(stage);
}

std::optional<NoEquilibrium> refusal_of(const Model&, const StaticStage& stage, const State&) {
  refuse(stage);
}

SolverChoice solver_of(const Model&, const StaticStage& stage, const State&) {
  refuse(stage);
}

std::string kernel_of_blas() {
  return {};
}

std::string better_kernel_of_blas() {
  return {};
}

ExactCriticalStep exact_step() {
  return {};
}

}  // namespace vbond
