#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {

/// Triangles of a surface, by the numbers of their corners.
using Triangles = std::vector<std::array<std::int64_t, 3>>;

/// Gives the points the edges as bonds, each once, and each particle its share of the surface: a third of
/// every triangle that it is a corner of.
void add_surface(const Triangles& triangles, SpecimenPoints& points);

/// The shares of a flat sheet in rows, triangular (odd rows half a spacing farther) or square.
void add_shares(const SheetSpecimen& s, SpecimenPoints& points);

/// Turns the points about the origin by the shortest rotation that takes z to the axis, then moves them.
void place_on_axis(const Vec3d& axis, const Vec3d& origin, const SourcePlace& place, SpecimenPoints& points);

/// The mass of each particle on a wall of this thickness, and the moment of inertia of its piece, a hexagonal
/// plate, about a diameter: m (h^2/12 + 5/72 l^2), the same about all axes. Masses as a file would give them.
void give_wall(double thickness, double density, bool with_inertia, SpecimenPoints& points);

}  // namespace vbond
