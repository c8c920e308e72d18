#include "vbond/setup/specimens/surface.hpp"

#include <algorithm>
#include <utility>

namespace vbond {
namespace {

const Vec3d& corner_at(const SpecimenPoints& points, std::int64_t k) {
  return points.r[static_cast<std::size_t>(k)];
}

/// Shares and mean square spacing from edges, each of them once.
void add_spacings(const std::vector<std::pair<std::int64_t, std::int64_t>>& edges, SpecimenPoints& points) {
  std::vector<int> neighbours(points.r.size(), 0);
  for (const auto& [i, j] : edges)
    for (const std::int64_t k : {i, j}) {
      points.shares[static_cast<std::size_t>(k)].square_spacing +=
          norm2(corner_at(points, j) - corner_at(points, i));
      ++neighbours[static_cast<std::size_t>(k)];
    }
  for (std::size_t k = 0; k < neighbours.size(); ++k)
    if (neighbours[k] > 0) points.shares[k].square_spacing /= neighbours[k];
}

}  // namespace

void add_surface(const Triangles& triangles, SpecimenPoints& points) {
  points.shares.assign(points.r.size(), {});
  std::vector<std::pair<std::int64_t, std::int64_t>> edges;
  for (const auto& t : triangles) {
    const double area = 0.5 * norm(cross(corner_at(points, t[1]) - corner_at(points, t[0]),
                                         corner_at(points, t[2]) - corner_at(points, t[0])));
    for (std::size_t k = 0; k < 3; ++k) {
      points.shares[static_cast<std::size_t>(t[k])].area += area / 3.0;
      edges.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  add_spacings(edges, points);
  for (const auto& [i, j] : edges) points.bonds.push_back({{i, j}, no_bond_type});
}

void add_shares(const SheetSpecimen& s, SpecimenPoints& points) {
  const std::int64_t columns = s.particles[0];
  const bool triangular = s.lattice == SheetLattice::triangular;
  points.shares.assign(points.r.size(), {0.0, s.spacing * s.spacing});
  const auto add = [&](std::initializer_list<std::int64_t> corners, double area) {
    for (const std::int64_t k : corners)
      points.shares[static_cast<std::size_t>(k)].area += area / static_cast<double>(corners.size());
  };
  const double cell = s.spacing * s.spacing, triangle = 0.25 * std::numbers::sqrt3 * cell;
  for (std::int64_t y = 0; y + 1 < s.particles[1]; ++y)
    for (std::int64_t x = 0; x + 1 < columns; ++x) {
      const std::int64_t a = y * columns + x, b = a + 1, c = a + columns, d = c + 1;
      if (!triangular)
        add({a, b, c, d}, cell);
      else if (y % 2 == 0)
        add({a, b, c}, triangle), add({b, c, d}, triangle);
      else
        add({a, b, d}, triangle), add({a, c, d}, triangle);
    }
}

void place_on_axis(const Vec3d& axis, const Vec3d& origin, const SourcePlace& place, SpecimenPoints& points) {
  if (!(norm(axis) > 0.0))
    throw CaseError({place, "the axis of a surface is zero", "it must point somewhere",
                     "use for instance axis = [0, 0, 1]"});
  const Vec3d z{0, 0, 1}, e = normalised(axis), u = cross(z, e);
  const double w = 1.0 + dot(z, e);
  const Quatd q = w > 1e-12 ? normalised(Quatd{w, u.x, u.y, u.z}) : Quatd{0, 1, 0, 0};
  for (Vec3d& r : points.r) r = origin + rotate(q, r);
}

void give_wall(double thickness, double density, bool with_inertia, SpecimenPoints& points) {
  for (const SurfaceShare& share : points.shares) {
    points.mass.push_back(density * thickness * share.area);
    if (with_inertia)
      points.inertia.push_back(points.mass.back() *
                               (thickness * thickness / 12.0 + 5.0 / 72.0 * share.square_spacing));
  }
}

}  // namespace vbond
