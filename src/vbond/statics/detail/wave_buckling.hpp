#pragma once
#include "vbond/statics/detail/kinds.hpp"

namespace vbond {

/// The load factors at which a wave of the stage meets no stiffness any more, along the balance of the body
/// whose images move alike, from where it stands at load factor 0. Returns the state at load factor 0.
State find_critical_waves(const Model& model, const StaticStage& stage, State balanced,
                          const StaticHooks& hooks, StaticResult& result);

}  // namespace vbond
