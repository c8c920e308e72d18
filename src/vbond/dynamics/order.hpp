#pragma once
#include <cstddef>
#include <vector>

#include "vbond/dynamics/rows.hpp"

namespace vbond {

/// Which particle stands in which row, and back. All particles have a row. Of a body that is stepped in
/// parts, each by a process of its own, the first rows are those of the part, at their end those that are
/// ghosts of other parts; then come its own ghosts, particles of other parts that it may touch or is bonded
/// to; what stands in the rows of all others is not known.
struct Order {
  PerRow<ParticleId> particle;
  PerParticle<Row> row;
  std::size_t inner = 0;  ///< rows [0, inner) concern no other part
  std::size_t own = 0;    ///< rows [0, own) are moved here
  std::size_t known = 0;  ///< rows [0, known) have the pose of now

  bool has(ParticleId p) const { return row[p].value < own; }
  bool knows(ParticleId p) const { return row[p].value < known; }
};

/// Whether the pair of these known rows is the concern of this part: that of its first particle.
inline bool is_worked_out_here(const Order& order, Row i, Row j) {
  return order.particle[i] < order.particle[j] ? i.value < order.own : j.value < order.own;
}

/// Sorts particles by layers one spacing thick: first along the body's longest direction, then the next,
/// then the shortest. Neighbours then lie in a few streams that memory delivers ahead of need; sorting by
/// cells was slower (docs/decisions/data-layout.md). The order depends on the positions alone: from the first
/// positions of a model it is the same for every stage and after a checkpoint.
Order spatial_order(const PerParticle<Vec3d>& r);

/// The particles that a part of a body has, and its ghosts. Of its own, some are ghosts of other parts.
struct Holding {
  std::vector<ParticleId> own, sent, ghosts;
};

/// The order of a part of a body: otherwise as that of the whole.
Order part_of(const Order& whole, const Holding& holding);

}  // namespace vbond
