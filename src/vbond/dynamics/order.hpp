#pragma once
#include "vbond/dynamics/rows.hpp"

namespace vbond {

/// Which particle stands in which row, and back.
struct Order {
  PerRow<ParticleId> particle;
  PerParticle<Row> row;
};

/// Sorts particles by layers one spacing thick: first along the body's longest direction, then the next,
/// then the shortest. Neighbours then lie in a few streams that memory delivers ahead of need; sorting by
/// cells was slower (docs/decisions/data-layout.md). The order depends on the positions alone: from the first
/// positions of a model it is the same for every stage and after a checkpoint.
Order spatial_order(const PerParticle<Vec3d>& r);

}  // namespace vbond
