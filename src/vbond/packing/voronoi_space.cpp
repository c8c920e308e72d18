// Where Voronoi cells end: planes around vessels and around particles.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <voro++/voro++.hh>

#include "vbond/core/images.hpp"
#include "vbond/packing/voronoi.hpp"

namespace vbond::packing {
namespace {

double volume_of(const std::vector<Plane>& planes, double side) {
  voro::voronoicell cell;
  cell.init(-side, side, -side, side, -side, side);
  for (const Plane& p : planes) cell.nplane(p.normal.x, p.normal.y, p.normal.z, 2.0 * p.at, 0);
  return cell.volume();
}

/// Two planes normal to `across`, at this distance from the outermost centres, and outside of all spheres.
void add_slab(const std::vector<Vec3d>& r, const std::vector<double>& radius, const Vec3d& across,
              double margin, VoronoiSpace& space) {
  const Vec3d n = normalised(across);
  double low = dot(r[0], n), high = low;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double at = dot(r[i], n), outside = std::max(margin, 1.001 * radius[i]);
    low = std::min(low, at - outside), high = std::max(high, at + outside);
  }
  space.planes.push_back({-n, -low});
  space.planes.push_back({n, high});
}

}  // namespace

std::vector<Plane> planes_around_cylinder(const Vec3d& axis) {
  constexpr int count = 256;
  constexpr double angle = std::numbers::pi / count;
  const Vec3d other = std::abs(axis.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalised(cross(axis, other)), v = cross(axis, u);
  std::vector<Plane> planes;
  for (int k = 0; k < count; ++k)
    planes.push_back(
        {std::cos(2.0 * angle * k) * u + std::sin(2.0 * angle * k) * v, std::sqrt(angle / std::tan(angle))});
  return planes;
}

std::vector<Plane> planes_around_ball() {
  constexpr int count = 4000;
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));  // points of a spiral are evenly spread
  std::vector<Plane> planes;
  for (int k = 0; k < count; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / count, s = std::sqrt(1.0 - z * z);
    planes.push_back({{s * std::cos(turn * k), s * std::sin(turn * k), z}, 1.0});
  }
  const double at = std::cbrt(4.0 / 3.0 * std::numbers::pi / volume_of(planes, 2.0));
  for (Plane& p : planes) p.at = at;
  return planes;
}

std::optional<VoronoiSpace> space_of(const Vessel& vessel) {
  VoronoiSpace space{vessel.periodic, vessel.corner, vessel.edges, {}};
  for (const auto& wall : vessel.walls)
    if (!wall->add_planes(space.planes)) return std::nullopt;
  return space;
}

VoronoiSpace space_around(const std::vector<Vec3d>& r, const std::vector<double>& radius, double margin,
                          const CellEdges& cell, const Periodic& periodic) {
  VoronoiSpace space;
  const std::array<Vec3d, 3> unit{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  for (std::size_t k = 0; k < 3; ++k) space.edges[k] = cell.empty() ? unit[k] : cell[k].along;
  space.periodic = cell.empty() ? Periodic{} : periodic;
  const auto edges = space.edges;
  for (std::size_t k = 0; k < 3; ++k) {
    if (space.periodic[k]) continue;
    const Vec3d across = normalised(cross(edges[(k + 1) % 3], edges[(k + 2) % 3]));
    add_slab(r, radius, across, margin, space);
    const double low = -space.planes[space.planes.size() - 2].at, high = space.planes.back().at;
    const double along = dot(edges[k], across);  // > 0
    space.edges[k] = ((high - low) / along) * edges[k];
    space.corner = space.corner + ((low - dot(space.corner, across)) / along) * edges[k];
  }
  return space;
}

}  // namespace vbond::packing
