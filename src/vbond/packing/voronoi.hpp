#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/packing/vessel.hpp"

/// Voronoi cells of spheres, by the cells of voro++ (Rycroft, Chaos 19, 041111, 2009).
namespace vbond::packing {

/// What cells fill: what lies on the inner side of all planes, and repeats along some edges.
struct VoronoiSpace {
  Periodic periodic{};  ///< along which edges
  /// A parallelepiped that holds it; of edges that repeat those of the cell, a right-handed system.
  Vec3d corner;
  std::array<Vec3d, 3> edges{};
  std::vector<Plane> planes;
};

/// Planes around a cylinder of radius 1 about the axis, a unit vector, through the origin, and around a
/// sphere of radius 1 about the origin, at the distance that leaves its volume: 256 and 4000 of them.
std::vector<Plane> planes_around_cylinder(const Vec3d& axis);
std::vector<Plane> planes_around_ball();

/// The vessel, with these planes in place of curved walls. Nothing if it has a wall that planes do not stand
/// for: of a mesh, or around an obstacle.
std::optional<VoronoiSpace> space_of(const Vessel& vessel);

/// Around spheres: the cell along the edges that repeat, and along open directions what two planes hold
/// between them, which are `margin` > 0 away from the outermost centres, or outside of their spheres if these
/// are larger; without a cell the box along the axes. At least one sphere.
VoronoiSpace space_around(const std::vector<Vec3d>& r, const std::vector<double>& radius, double margin,
                          const CellEdges& cell, const Periodic& periodic);

/// Where two cells meet.
struct VoronoiFace {
  std::size_t of = 0;  ///< the particle on its other side
  Image image{};       ///< of that particle
  double area = 0;     ///< > 0  [length^2]
};

/// The cell of particle i has the faces first[i] to first[i + 1] - 1.
struct VoronoiCells {
  std::vector<double> volume;      ///< [length^3]; 0: spheres around it have taken all of its place
  std::vector<std::size_t> first;  ///< one more than there are particles
  std::vector<VoronoiFace> faces;  ///< those with other cells, in order of (particle, image)
  std::span<const VoronoiFace> faces_of(std::size_t i) const {
    return std::span(faces).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// The radical (Laguerre, power) cells of spheres: a place belongs to the sphere of which distance^2 -
/// radius^2 is least. With equal radii they are the Voronoi cells. Particles may stand anywhere along edges
/// that repeat, and must be within the parallelepiped along others. Edges shorter than some 1e-11 of the mean
/// spacing of particles count as points, as they do in lattices. The result does not depend on the number of
/// threads.
VoronoiCells voronoi_cells(const VoronoiSpace& space, const std::vector<Vec3d>& r,
                           const std::vector<double>& radius, int threads = 1);

/// Four particles, in increasing order.
using Tetrahedron = std::array<std::size_t, 4>;

/// The Delaunay tetrahedra of points, which are the corners of their Voronoi cells: those whose circumscribed
/// spheres have their middles in this space, without edges that repeat. Nothing if more than four points lie
/// on such a sphere to some 1e-11 of the spacing, so that cells do not agree.
std::optional<std::vector<Tetrahedron>> delaunay_tetrahedra(const VoronoiSpace& space,
                                                            const std::vector<Vec3d>& r);

}  // namespace vbond::packing
