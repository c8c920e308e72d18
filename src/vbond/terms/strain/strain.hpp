#pragma once
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Every `every` time units, x -> x + increment e (e . (x - c)), c the group's centroid at the start;
/// orientations and velocities stay.
struct StrainProgram {
  std::vector<ParticleId> particles;
  Vec3d direction;       ///< unit vector e
  Vec3d centre;          ///< c  [length]
  double increment = 0;  ///< engineering strain per application
  double every = 0;      ///< [time]
};

}  // namespace vbond
