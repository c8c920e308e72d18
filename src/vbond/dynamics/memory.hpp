#pragma once
#include "vbond/model/state.hpp"

namespace vbond {

/// Memory that a run takes at least in the time loop; neighbour lists and what a stage adds (damping) are
/// extra.  [bytes]
struct MemoryUse {
  double per_particle = 0;
  double per_bond = 0;
};

/// Constants, state and scratch of a run of this body; tops count per particle, as a mean over all.
MemoryUse memory_use(const Model& model, const State& state);

}  // namespace vbond
