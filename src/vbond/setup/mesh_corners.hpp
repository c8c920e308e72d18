#pragma once
#include <cstddef>
#include <vector>

#include "vbond/core/triangle_mesh.hpp"

namespace vbond {

/// What became of corners that nearly coincide.
struct JoinedCorners {
  std::size_t count = 0;  ///< places that another one stands for
  double farthest = 0;    ///< from such a place to the one that stands for it  [diagonal of the mesh]
};

/// Corners closer than this are one.  [diagonal of the box around the mesh]
constexpr double same_corner = 1e-6;

/// Joins corners at the same place, and places that differ by rounding: closer than `same_corner`, or than
/// two units of the last of 32 bits where the mesh lies far from the origin, whichever is more; but never
/// farther than a quarter of the shortest side of the triangles that have the corner, so that a small part of
/// a large mesh keeps its shape. Sides below a thousandth of their triangle's longest that are shorter than
/// the distance of joining are taken for rounding, too. What is joined to the same place is one. Triangles
/// stay, some with equal corners; the corner of lowest number stands for the others. Coordinates are finite.
JoinedCorners join_corners(TriangleMesh& mesh);

/// Gives the mesh those of these corners that its triangles have, numbered by their first use.
void take_corners(const std::vector<Vec3d>& corners, TriangleMesh& mesh);

}  // namespace vbond
