#pragma once
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/time_function.hpp"

namespace vbond {

/// The temperature of particles, times a factor; those that no stage heats have 0. At rest it is what the
/// temperature that the stage finds changes by until load factor 1: changes of groups that overlap add up.
struct Heating {
  std::vector<ParticleId> particles;
  double temperature = 0;  ///< [temperature]
  TimeFunction factor = {};
};

}  // namespace vbond
