#pragma once
#include <cmath>
#include <cstdint>

#include "vbond/core/triangle_mesh.hpp"

namespace vbond::testing {

/// A sheet over the square -half..half in x and y: n x n squares in two triangles each, diagonals from low x
/// and y to high ones, at the heights z(x, y).
template <class Height>
TriangleMesh sheet(std::uint32_t n, double half, Height z) {
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = half * (2.0 * i / n - 1.0), y = half * (2.0 * j / n - 1.0);
      mesh.corners.push_back({x, y, z(x, y)});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

inline TriangleMesh plate(std::uint32_t n, double half) {
  return sheet(n, half, [](double, double) { return 0.0; });
}

}  // namespace vbond::testing
