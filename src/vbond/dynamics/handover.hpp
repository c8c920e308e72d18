#pragma once
#include <optional>
#include <vector>

#include "vbond/dynamics/part_bonds.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/model/state.hpp"

/// What a Simulation gives to a Partition, and to another Simulation.
namespace vbond {

/// What a part of a body has beside a state of its own particles and bonds alone.
struct PartHandedOver {
  PartBonds bonds;
  SharedByBonds shared;
  std::vector<ParticleId> particles;  ///< its own that are present, in increasing order
  double mass_of_all = 0;             ///< of the whole body  [mass]
};

/// What another Simulation of the stage goes on from.
struct Handover {
  State state;
  Passage passed;                           ///< what a visit has done
  std::optional<PartHandedOver> part = {};  ///< if given, state and model are those of a part
};

}  // namespace vbond
