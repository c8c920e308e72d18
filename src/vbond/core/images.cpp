#include "vbond/core/images.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "vbond/core/bounding_box.hpp"

namespace vbond {
namespace {

std::int32_t whole(double x) {
  constexpr double most = 0x1p30;  // beyond it no place is known to a millionth of an edge
  return static_cast<std::int32_t>(std::clamp(x, -most, most));
}

}  // namespace

Vec3d heights(const CellEdges& cell) {
  const Vec3d &a = cell[0].along, &b = cell[1].along, &c = cell[2].along;
  const double V = dot(a, cross(b, c));
  return {V / norm(cross(b, c)), V / norm(cross(c, a)), V / norm(cross(a, b))};
}

Image image_in_cell(const CellEdges& cell, const Periodic& periodic, const Vec3d& corner, const Vec3d& r) {
  const Vec3d s = in_edges(cell, r - corner);
  return {periodic[0] ? whole(-std::floor(s.x)) : 0, periodic[1] ? whole(-std::floor(s.y)) : 0,
          periodic[2] ? whole(-std::floor(s.z)) : 0};
}

namespace {

/// visit(n) for all images that may be nearer than this one, and for this one.
template <class Visit>
void for_images_as_near(const CellEdges& cell, const Periodic& periodic, double reach, const Image& middle,
                        Visit&& visit) {
  const Vec3d h = heights(cell);
  const auto farthest = [&](int k) {
    return periodic[static_cast<std::size_t>(k)] ? 1 + whole(std::ceil(reach / component(h, k))) : 0;
  };
  for (std::int32_t a = -farthest(0); a <= farthest(0); ++a)
    for (std::int32_t b = -farthest(1); b <= farthest(1); ++b)
      for (std::int32_t c = -farthest(2); c <= farthest(2); ++c) visit(middle + Image{a, b, c});
}

double distance2(const CellEdges& cell, const Vec3d& r_i, const Vec3d& r_j, const Image& n) {
  return norm2(between(r_i, r_j + to_image(cell, n)));
}

}  // namespace

Image nearest_image(const CellEdges& cell, const Periodic& periodic, const Vec3d& r_i, const Vec3d& r_j) {
  // r_j comes into the cell around r_i; no image beyond it is nearer than the cell is wide
  const Vec3d half = 0.5 * (cell[0].along + cell[1].along + cell[2].along);
  const Image first = image_in_cell(cell, periodic, r_i - half, r_j);
  const bool same_place = r_i == r_j;
  Image best = first;
  double least = same_place && first.is_itself() ? INFINITY : distance2(cell, r_i, r_j, first);
  const double reach = std::sqrt(distance2(cell, r_i, r_j, first));
  for_images_as_near(cell, periodic, reach, first, [&](const Image& n) {
    if (same_place && n.is_itself()) return;
    const double d2 = distance2(cell, r_i, r_j, n);
    if (d2 < least || (d2 == least && n < best)) least = d2, best = n;
  });
  return best;
}

std::optional<Image> as_near(const CellEdges& cell, const Periodic& periodic, const Vec3d& r_i,
                             const Vec3d& r_j, const Image& nearest) {
  constexpr double rounding = 1e-9;
  const double least = distance2(cell, r_i, r_j, nearest);
  std::optional<Image> other;
  for_images_as_near(cell, periodic, std::sqrt(least), nearest, [&](const Image& n) {
    const bool same_pair = n == nearest || (r_i == r_j && (n.is_itself() || n == -nearest));
    if (!same_pair && distance2(cell, r_i, r_j, n) <= least * (1.0 + rounding)) other = n;
  });
  return other;
}

std::array<double, 3> farthest_images(const CellEdges& cell, const Periodic& periodic,
                                      std::span<const Vec3d> positions, double distance) {
  BoundingBox in_cell;
  for (const Vec3d& r : positions) in_cell.add(in_edges(cell, r));
  const Vec3d h = heights(cell), apart = in_cell.high - in_cell.low;
  std::array<double, 3> farthest{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    if (periodic[k]) farthest[k] = std::ceil(component(apart, axis) + distance / component(h, axis));
  }
  return farthest;
}

NearImages near_images(const CellEdges& cell, const Periodic& periodic, std::span<const Vec3d> positions,
                       double distance) {
  constexpr double rounding = 1e-9;  // an image too many does no harm
  const std::size_t most = (std::size_t{1} << 24) + 30 * positions.size();
  const auto refuse = [] {
    throw std::length_error("a cell is so small against a distance that too many images are near");
  };
  NearImages near;
  near.points = positions.size();
  for (std::size_t k = 0; k < positions.size(); ++k) {
    near.image.push_back(image_in_cell(cell, periodic, {}, positions[k]));
    near.of.push_back(k);
    near.r.push_back(positions[k] + to_image(cell, near.image.back()));
  }
  const Vec3d h = heights(cell);
  std::array<double, 3> beyond{};  // the cell, in edges
  std::array<std::int32_t, 3> farthest{};
  for (int k = 0; k < 3; ++k)
    if (periodic[static_cast<std::size_t>(k)]) {
      beyond[static_cast<std::size_t>(k)] = distance / component(h, k) + rounding;
      farthest[static_cast<std::size_t>(k)] = whole(std::ceil(beyond[static_cast<std::size_t>(k)]));
    }
  double expected = static_cast<double>(near.points);  // as particles are spread evenly
  for (const double d : beyond) expected *= 1.0 + 2.0 * d;
  if (expected > 2.0 * static_cast<double>(most)) refuse();
  for (std::size_t k = 0; k < near.points; ++k) {
    const Vec3d s = in_edges(cell, near.r[k]);
    const auto is_near = [&](int axis, std::int32_t n) {
      const double x = component(s, axis) + n, d = beyond[static_cast<std::size_t>(axis)];
      return n == 0 || (x >= -d && x <= 1.0 + d);
    };
    for (std::int32_t a = -farthest[0]; a <= farthest[0]; ++a)
      for (std::int32_t b = is_near(0, a) ? -farthest[1] : farthest[1] + 1; b <= farthest[1]; ++b)
        for (std::int32_t c = is_near(1, b) ? -farthest[2] : farthest[2] + 1; c <= farthest[2]; ++c) {
          const Image n{a, b, c};
          if (n.is_itself() || !is_near(2, c)) continue;
          if (near.r.size() >= most) refuse();
          near.of.push_back(k);
          near.image.push_back(near.image[k] + n);
          near.r.push_back(positions[k] + to_image(cell, near.image.back()));
        }
  }
  return near;
}

}  // namespace vbond
