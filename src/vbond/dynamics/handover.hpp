#pragma once
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/model/state.hpp"

/// What a Simulation gives to writers, to a Partition, and to another Simulation.
namespace vbond {

/// What one process steps of a body.
struct OwnPart {
  std::vector<ParticleId> particles;  ///< in increasing order
  std::vector<BondId> bonds;          ///< of which one is the first end, broken ones too, in increasing order
  const State& state;  ///< up to date for these alone, and for where both ends of the bonds are
};

/// What another Simulation of the stage goes on from.
struct Handover {
  State state;
  Passage passed;  ///< what a visit has done
};

}  // namespace vbond
