#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "vbond/core/vec3.hpp"

namespace vbond::packing {

/// Triangles of points, by their numbers, counter-clockwise as seen from outside.
struct Skin {
  std::vector<std::array<std::size_t, 3>> triangles;
  std::vector<std::size_t> outside;  ///< points that are no corner of what is filled, in increasing order
};

/// The outer boundary of what points fill: of their Delaunay tetrahedra, those with a circumscribed sphere of
/// no larger radius than this, and all that these enclose (alpha shape; Edelsbrunner and Muecke, ACM Trans.
/// Graphics 13 (1994) 43). It is closed; parts of it may meet in points and edges. Points that stand in
/// lattices have more than one such set of tetrahedra: one is chosen as if they stood apart by 1e-5 of the
/// radius, always the same. Nothing if cells do not agree on one, which points in each other's places do.
std::optional<Skin> skin_of(const std::vector<Vec3d>& r, double radius);

}  // namespace vbond::packing
