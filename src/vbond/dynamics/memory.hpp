#pragma once
#include "vbond/model/model.hpp"
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

/// What each of so many ranks takes at least in the time loop: all have the whole body, the constants of
/// bonds are shared out, and the first has a second state, for observers.  [bytes]
struct RankMemory {
  double each = 0;
  double first = 0;
};

/// ranks >= 1.
RankMemory memory_of_ranks(const Model& model, const State& state, int ranks);

}  // namespace vbond
