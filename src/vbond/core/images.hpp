#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/cell.hpp"
#include "vbond/core/near_pairs.hpp"
#include "vbond/core/sized_points.hpp"

namespace vbond {

/// A place as parts of the three edges of a cell.
inline Vec3d in_edges(const CellEdges& cell, const Vec3d& r) {
  const Vec3d &a = cell[0].along, &b = cell[1].along, &c = cell[2].along;
  const double V = dot(a, cross(b, c));
  return {dot(r, cross(b, c)) / V, dot(r, cross(c, a)) / V, dot(r, cross(a, b)) / V};
}
/// Of the parallelepiped of its edges, > 0 for a right-handed system.  [length^3]
inline double volume(const CellEdges& cell) {
  return dot(cell[0].along, cross(cell[1].along, cell[2].along));
}
/// The distance between the two faces that an edge joins.  [length]
Vec3d heights(const CellEdges& cell);
/// The image of a place that stands in the cell with this corner.
Image image_in_cell(const CellEdges& cell, const Periodic& periodic, const Vec3d& corner, const Vec3d& r);

/// Which image of a particle at r_j is nearest to a particle at r_i, of equals the least; of one and the same
/// place the nearest other one.
Image nearest_image(const CellEdges& cell, const Periodic& periodic, const Vec3d& r_i, const Vec3d& r_j);
/// Another one that is as near but for rounding, if there is one: not the same pair seen from the other side.
std::optional<Image> as_near(const CellEdges& cell, const Periodic& periodic, const Vec3d& r_i,
                             const Vec3d& r_j, const Image& nearest);

/// How many edges an image of one of these points may be away from another within `distance` of it; 0 along
/// edges that are open.
std::array<double, 3> farthest_images(const CellEdges& cell, const Periodic& periodic,
                                      std::span<const Vec3d> positions, double distance);

/// Calls visit(n) for each image n of a place that may stand in the box.
template <class Visit>
void for_images_in(const BoundingBox& box, const CellEdges& cell, const Periodic& periodic, const Vec3d& r,
                   Visit&& visit) {
  BoundingBox edges;  // the box in parts of the edges
  for (const double x : {box.low.x, box.high.x})
    for (const double y : {box.low.y, box.high.y})
      for (const double z : {box.low.z, box.high.z}) edges.add(in_edges(cell, {x, y, z}));
  const Vec3d at = in_edges(cell, r);
  std::array<std::int32_t, 3> first{}, last{};
  for (int k = 0; k < 3; ++k) {
    if (!periodic[static_cast<std::size_t>(k)]) continue;
    const double x = component(at, k);
    first[static_cast<std::size_t>(k)] =
        static_cast<std::int32_t>(std::ceil(component(edges.low, k) - x - 1e-9));
    last[static_cast<std::size_t>(k)] =
        static_cast<std::int32_t>(std::floor(component(edges.high, k) - x + 1e-9));
  }
  for (std::int32_t a = first[0]; a <= last[0]; ++a)
    for (std::int32_t b = first[1]; b <= last[1]; ++b)
      for (std::int32_t c = first[2]; c <= last[2]; ++c) visit(Image{a, b, c});
}

/// Points, brought into the cell, and those of their images that come within reach of it: for finding pairs.
struct NearImages {
  std::vector<Vec3d> r;         ///< first the points  [length]
  std::vector<std::size_t> of;  ///< the point that each is an image of
  std::vector<Image> image;     ///< which one
  std::size_t points = 0;
};
/// Works for points anywhere and for cells of any size against the distance. Throws std::length_error if
/// there would be more than 30 of each and 2^24.
NearImages near_images(const CellEdges& cell, const Periodic& periodic, std::span<const Vec3d> positions,
                       double distance);

/// Of two near points of those: the pair that they stand for, or none: it is found elsewhere too.
template <class Visit>
void visit_image_pair(const NearImages& near, std::size_t p, std::size_t q, double d2, Visit&& visit) {
  if (p >= near.points) return;  // both are images: of a pair that is found in the cell
  const std::size_t i = near.of[p], j = near.of[q];
  const Image n = near.image[q] - near.image[p];
  if (q >= near.points && (i > j || (i == j && n < Image{}))) return;
  visit(i, j, n, d2);
}

/// As for_near_pairs(), of points that repeat: visit(i, j, n, d2) for each image n of j within the distance
/// of i, i < j, or i = j and n > 0 (its first component that is not 0): each pair of a particle and an image
/// once.
template <class Visit>
void for_near_images(const CellEdges& cell, const Periodic& periodic, std::span<const Vec3d> positions,
                     double distance, Visit&& visit) {
  if (cell.empty())
    return for_near_pairs(positions, distance,
                          [&](std::size_t i, std::size_t j, double d2) { return visit(i, j, Image{}, d2); });
  const NearImages near = near_images(cell, periodic, positions, distance);
  for_near_pairs(near.r, distance,
                 [&](std::size_t p, std::size_t q, double d2) { visit_image_pair(near, p, q, d2, visit); });
}

/// The same of those that are nearer than the sum of their sizes.
template <class Visit>
void for_overlapping_images(const CellEdges& cell, const Periodic& periodic, std::span<const Vec3d> positions,
                            std::span<const double> sizes, double margin, Visit&& visit) {
  if (cell.empty())
    return for_overlapping_pairs(positions, sizes, margin,
                                 [&](std::size_t i, std::size_t j, double d2) { visit(i, j, Image{}, d2); });
  double largest = 0.0;
  for (const double size : sizes) largest = std::max(largest, size);
  const NearImages near = near_images(cell, periodic, positions, 2.0 * largest + margin);
  std::vector<double> of_all;
  for (const std::size_t k : near.of) of_all.push_back(sizes[k]);
  for_overlapping_pairs(near.r, of_all, margin, [&](std::size_t p, std::size_t q, double d2) {
    visit_image_pair(near, p, q, d2, visit);
  });
}

}  // namespace vbond
