#pragma once
#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"

// The cell that particles stand in: how two of them stand to each other is said here and nowhere else
// (tools/check_layers).
namespace vbond {

/// From the particle at r_i to that at r_j.  [length]
/// Space is open in all directions, so that this is their difference. Were a direction periodic, an image of
/// j would be chosen here: the nearest one for pairs that touch or are measured, and for a bond the one that
/// it joins.
template <Scalar T>
VBOND_HD constexpr Vec3<T> between(const Vec3<T>& r_i, const Vec3<T>& r_j) {
  return r_j - r_i;
}

/// The same of one coordinate, for loops that hold particles, and not coordinates, side by side. Good as long
/// as coordinates do not depend on each other.
template <Scalar T>
VBOND_HD constexpr T between(const T& x_i, const T& x_j) {
  return x_j - x_i;
}

/// The same of two particles that stand at these places.
inline Vec3d between(const PerParticle<Vec3d>& r, ParticleId i, ParticleId j) {
  return between(r[i], r[j]);
}

}  // namespace vbond
