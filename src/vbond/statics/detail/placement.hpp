#pragma once
#include "vbond/core/cell.hpp"
#include "vbond/core/column.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Where all particles are, and the load factor they are there at.
struct Placement {
  PerParticle<Vec3d> r;
  PerParticle<Quatd> q;
  double load_factor = 0;
  CellEdges cell = {};
};

/// The pose of a bond as its particles stood there.
inline BondPose<double> bond_pose(const Bond& b, const Placement& at) {
  return bond_pose(b, between(at.r, at.cell, b), at.q[b.i], at.q[b.j]);
}

/// The largest movement of a particle between the two, or turn of one times this length. Where a cell has
/// changed: movement beside what the cell carries all particles by, as the first one sees it, and the largest
/// part by which an edge has changed, times this length.  [length]
double distance(const Placement& a, const Placement& b, double length);

}  // namespace vbond
