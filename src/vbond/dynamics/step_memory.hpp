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

/// Constants, state and scratch of a run of this body; tops, and images of a periodic body, count per
/// particle, as a mean over all.
MemoryUse memory_use(const Model& model, const State& state);

/// What each of so many ranks, >= 1, takes at least as the time loop begins, and as State is collected: all
/// have model and state of the whole body then; rows of particles, constants and index of bonds are shared
/// out.  [bytes]
double memory_of_each_rank(const Model& model, const State& state, int ranks);

}  // namespace vbond
