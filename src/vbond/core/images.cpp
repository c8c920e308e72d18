#include "vbond/core/images.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

Image nearest_image(const CellEdges& cell, const Periodic& periodic, const Vec3d& r_i, const Vec3d& r_j) {
  // r_j comes into the cell around r_i; no image beyond it is nearer than the cell is wide
  const Vec3d half = 0.5 * (cell[0].along + cell[1].along + cell[2].along);
  const Image first = image_in_cell(cell, periodic, r_i - half, r_j);
  const auto distance2 = [&](const Image& n) { return norm2(between(r_i, r_j + to_image(cell, n))); };
  const Vec3d h = heights(cell);
  const double reach = std::sqrt(distance2(first));
  const auto farthest = [&](int k) {
    return periodic[static_cast<std::size_t>(k)] ? 1 + whole(std::ceil(reach / component(h, k))) : 0;
  };
  const bool same_place = r_i == r_j;
  Image best = first;
  double least = same_place && first.is_itself() ? INFINITY : distance2(first);
  for (std::int32_t a = -farthest(0); a <= farthest(0); ++a)
    for (std::int32_t b = -farthest(1); b <= farthest(1); ++b)
      for (std::int32_t c = -farthest(2); c <= farthest(2); ++c) {
        const Image n = first + Image{a, b, c};
        if (same_place && n.is_itself()) continue;
        const double d2 = distance2(n);
        if (d2 < least || (d2 == least && n < best)) least = d2, best = n;
      }
  return best;
}

NearImages near_images(const CellEdges& cell, const Periodic& periodic, std::span<const Vec3d> positions,
                       double distance) {
  constexpr double rounding = 1e-9;  // an image too many does no harm
  const std::size_t most = (std::size_t{1} << 24) + 30 * positions.size();
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
          if (near.r.size() >= most)
            throw std::length_error("a cell is so small against a distance that too many images are near");
          near.of.push_back(k);
          near.image.push_back(near.image[k] + n);
          near.r.push_back(positions[k] + to_image(cell, near.image.back()));
        }
  }
  return near;
}

}  // namespace vbond
