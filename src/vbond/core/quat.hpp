#pragma once
#include <cmath>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// A rotation as a unit quaternion (w, x, y, z): it turns body vectors into world vectors.
template <Scalar T>
struct Quat {
  T w{1.0}, x{}, y{}, z{};

  friend VBOND_HD constexpr Quat operator*(const Quat& a, const Quat& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

using Quatd = Quat<double>;

/// The inverse of a unit quaternion.
template <Scalar T>
VBOND_HD constexpr Quat<T> conjugate(const Quat<T>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

/// q / |q|: removes the rounding that products of unit quaternions gather.
template <Scalar T>
VBOND_HD Quat<T> normalised(const Quat<T>& q) {
  using std::sqrt;
  const T s = T(1.0) / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w * s, q.x * s, q.y * s, q.z * s};
}

/// The body vector b seen from the world: q b q^-1 for a unit quaternion q.
template <Scalar T>
VBOND_HD constexpr Vec3<T> rotate(const Quat<T>& q, const Vec3<T>& b) {
  const Vec3<T> u{q.x, q.y, q.z};
  const Vec3<T> t = T(2.0) * cross(u, b);
  return b + q.w * t + cross(u, t);
}

/// Exact rotation by the vector phi (angle |phi| about phi / |phi|): the exponential map.  [rad]
/// sin(x)/x is continued by its series below 1e-4 rad, where the dropped term is under 1e-18.
inline Quatd rotation_of(const Vec3d& phi) {
  const double half = 0.5 * norm(phi);
  const double s = half > 1e-4 ? std::sin(half) / half : 1.0 - half * half / 6.0;
  return {std::cos(half), 0.5 * s * phi.x, 0.5 * s * phi.y, 0.5 * s * phi.z};
}

/// The rotation vector of q, the inverse of rotation_of, with angle in [0, pi].  [rad]
inline Vec3d rotation_vector(const Quatd& q) {
  const Vec3d u{q.x, q.y, q.z};
  const double s = norm(u);
  if (s == 0.0) return {};
  const double sign = q.w < 0.0 ? -1.0 : 1.0;  // q and -q are one rotation: take the shorter way
  return (2.0 * sign * std::atan2(s, sign * q.w) / s) * u;
}

}  // namespace vbond
