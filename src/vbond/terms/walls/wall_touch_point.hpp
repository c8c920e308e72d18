#pragma once
#include <cmath>
#include <cstddef>

#include "vbond/core/dual.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Where a sphere is nearest to a wall. Of dual numbers: with the derivatives by the sphere's centre.
template <Scalar T>
struct WallTouchOf {
  Vec3<T> normal;  ///< unit vector from the wall to the sphere's centre
  T distance{};    ///< of the centre from the wall along it; negative behind it  [length]
  /// Of the wall there: 0 flat, 1/R_w convex, -1/R_w hollow; edges, rims and corners count as flat.
  /// [1/length]
  double curvature_1 = 0, curvature_2 = 0;
};
using WallTouch = WallTouchOf<double>;
using MovedWallTouch = WallTouchOf<Dual<3>>;

/// A number or a vector without its derivatives.
constexpr double plain(double x) {
  return x;
}
template <std::size_t N>
constexpr double plain(const Dual<N>& x) {
  return x.value;
}
template <Scalar T>
Vec3d plain(const Vec3<T>& a) {
  return {plain(a.x), plain(a.y), plain(a.z)};
}

/// A constant vector as one of any scalar.
template <Scalar T>
Vec3<T> constant(const Vec3d& a) {
  return {T(a.x), T(a.y), T(a.z)};
}

/// Whether a sphere of radius R is not smaller than the hollow wall that it touches.
inline bool is_too_wide(double R, double curvature_1, double curvature_2) {
  return R * (curvature_1 < curvature_2 ? curvature_1 : curvature_2) <= -1.0;
}

/// The radius of the sphere that touches a plane as a sphere of radius R touches the wall: geometric mean of
/// both principal directions. R must be less than that of a hollow wall.  [length]
inline double effective_radius(double R, double curvature_1, double curvature_2) {
  return 1.0 / std::sqrt((1.0 / R + curvature_1) * (1.0 / R + curvature_2));
}
inline double effective_radius(double R, const WallTouch& t) {
  return effective_radius(R, t.curvature_1, t.curvature_2);
}

}  // namespace vbond
