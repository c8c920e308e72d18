#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// T_ab, row by row.
struct Tensor {
  std::array<Vec3d, 3> row{};

  Tensor& operator+=(const Tensor& more) {
    for (std::size_t a = 0; a < 3; ++a) row[a] += more.row[a];
    return *this;
  }
  friend Tensor operator*(double x, const Tensor& t) { return {{x * t.row[0], x * t.row[1], x * t.row[2]}}; }
};
/// a_a b_b.
inline Tensor dyad(const Vec3d& a, const Vec3d& b) {
  return {{a.x * b, a.y * b, a.z * b}};
}
/// T_ab x_b.
inline Vec3d times(const Tensor& t, const Vec3d& x) {
  return {dot(t.row[0], x), dot(t.row[1], x), dot(t.row[2], x)};
}
/// S_ab T_ab.
inline double double_dot(const Tensor& s, const Tensor& t) {
  return dot(s.row[0], t.row[0]) + dot(s.row[1], t.row[1]) + dot(s.row[2], t.row[2]);
}
inline Tensor transposed(const Tensor& t) {
  const auto& [x, y, z] = t.row;
  return {{Vec3d{x.x, y.x, z.x}, Vec3d{x.y, y.y, z.y}, Vec3d{x.z, y.z, z.z}}};
}
/// xx, yy, zz, yz, zx, xy of the symmetric part.
using SymmetricParts = std::array<double, 6>;
inline SymmetricParts symmetric_part(const Tensor& t) {
  const auto& [x, y, z] = t.row;
  return {x.x, y.y, z.z, 0.5 * (y.z + z.y), 0.5 * (z.x + x.z), 0.5 * (x.y + y.x)};
}

}  // namespace vbond
