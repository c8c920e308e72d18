#pragma once
#include "vbond/dynamics/rows.hpp"

namespace vbond {

/// Which particle stands in which row, and back.
struct Order {
  PerRow<ParticleId> particle;
  PerParticle<Row> row;
};

/// Sorts particles so that neighbours in space are near in memory: cells of some eight spacings a side, those
/// of one cross-section of the body after one another, and inside a cell layer by layer. It depends on the
/// positions alone: from the first positions of a model it is the same for every stage and after a
/// checkpoint.
Order spatial_order(const PerParticle<Vec3d>& r);

}  // namespace vbond
