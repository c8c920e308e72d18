#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Triangles that share corners.
struct TriangleMesh {
  std::vector<Vec3d> corners;                           ///< [length]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of corners
};

/// False if the corners are on a line: the height is less than 1e-12 of the longest side.
inline bool has_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return norm(cross(b - a, c - a)) > 1e-12 * std::max({norm2(b - a), norm2(c - b), norm2(a - c)});
}

}  // namespace vbond
