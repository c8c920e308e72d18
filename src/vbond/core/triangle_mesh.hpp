#pragma once
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

}  // namespace vbond
