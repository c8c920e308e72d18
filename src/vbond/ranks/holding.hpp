#pragma once
#include <cstddef>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// The motion of a particle.
struct Motion {
  Vec3d r;
  Quatd q;
  Vec3d v, omega;
};

/// A bond between two particles of a rank, by their places in Holding::particles.
struct HeldBond {
  BondId bond;
  ParticleId i, j;
};

/// What a rank has of a body: its own particles, then those of other ranks that its bonds reach (ghosts). A
/// bond belongs to one rank, that of its first particle.
struct Holding {
  std::vector<ParticleId> particles;  ///< in the numbering of the model
  std::vector<Motion> own;            ///< of the first particles
  std::vector<HeldBond> bonds;
};

}  // namespace vbond
