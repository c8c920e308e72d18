#pragma once
#include "vbond/model/passage.hpp"
#include "vbond/model/state.hpp"

/// What a Simulation gives to a Partition, and to another Simulation.
namespace vbond {

/// What another Simulation of the stage goes on from.
struct Handover {
  State state;
  Passage passed;  ///< what a visit has done
};

}  // namespace vbond
