#pragma once
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Memory that a run takes in the time loop, neighbour lists apart.  [bytes]
struct MemoryUse {
  double per_particle = 0;
  double per_bond = 0;
};

/// Constants, state, the copy of it between stages, and scratch of a run of this body.
MemoryUse memory_use(const Model& model, const State& state);

}  // namespace vbond
