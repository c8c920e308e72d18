#pragma once
#include <cmath>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// A rotation as a unit quaternion (w, x, y, z): it turns body vectors into world vectors.
template <Scalar T>
struct Quat {
  T w{1.0}, x{}, y{}, z{};

  friend VBOND_HD constexpr Quat operator*(const Quat& a, const Quat& b) {
    return {(a.w * b.w - a.x * b.x) - (a.y * b.y + a.z * b.z),  // in pairs: fewer operations wait for others
            (a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y),
            (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z),
            (a.w * b.z + a.z * b.w) + (a.x * b.y - a.y * b.x)};
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

/// The same for a q whose length is off by rounding only: one Newton step, which squares the error.
template <Scalar T>
VBOND_HD constexpr Quat<T> renormalised(const Quat<T>& q) {
  const T s = T(1.5) - T(0.5) * ((q.w * q.w + q.x * q.x) + (q.y * q.y + q.z * q.z));
  return {q.w * s, q.x * s, q.y * s, q.z * s};
}

/// The body vector b seen from the world: q b q^-1 for a unit quaternion q.
template <Scalar T>
VBOND_HD constexpr Vec3<T> rotate(const Quat<T>& q, const Vec3<T>& b) {
  const Vec3<T> u{q.x, q.y, q.z};
  const Vec3<T> t = T(2.0) * cross(u, b);
  return b + q.w * t + cross(u, t);
}

/// Three vectors at right angles, right-handed.
template <Scalar T>
struct Axes {
  Vec3<T> x, y, z;
};

/// The body axes seen from the world: the columns of the rotation matrix of a unit quaternion q.
template <Scalar T>
VBOND_HD constexpr Axes<T> axes(const Quat<T>& q) {
  const T one(1.0), x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const T xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, yz = q.y * z2, zx = q.z * x2;
  const T wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  return {{one - (yy + zz), xy + wz, zx - wy},
          {xy - wz, one - (zz + xx), yz + wx},
          {zx + wy, yz - wx, one - (xx + yy)}};
}

/// The rotation whose axes are x, y and x cross y; x and y are unit vectors at right angles.
/// Of four ways to take the quaternion from the matrix the one that divides by its largest component
/// (Shepperd, J. Guidance and Control 1 (1978) 223).
inline Quatd rotation_to(const Vec3d& x, const Vec3d& y) {
  const Vec3d z = cross(x, y);
  const double trace = x.x + y.y + z.z;
  Quatd q;
  if (trace >= x.x && trace >= y.y && trace >= z.z)
    q = {1.0 + trace, y.z - z.y, z.x - x.z, x.y - y.x};
  else if (x.x >= y.y && x.x >= z.z)
    q = {y.z - z.y, 1.0 + x.x - y.y - z.z, x.y + y.x, z.x + x.z};
  else if (y.y >= z.z)
    q = {z.x - x.z, x.y + y.x, 1.0 - x.x + y.y - z.z, y.z + z.y};
  else
    q = {x.y - y.x, z.x + x.z, y.z + z.y, 1.0 - x.x - y.y + z.z};
  return normalised(q);
}

/// Largest |phi|^2 for which small_rotation holds.  [rad^2]
inline constexpr double small_rotation_limit2 = 0.25;

/// Exact rotation by the vector phi (angle |phi| about phi / |phi|), |phi| <= 0.5 rad: the exponential map,
/// by the power series of cos(x) and sin(x)/x at x = |phi|/2, whose first dropped terms are under 1e-19.
template <Scalar T>
VBOND_HD constexpr Quat<T> small_rotation(const Vec3<T>& phi) {
  const T xx = T(0.25) * norm2(phi), x4 = xx * xx;
  // (1 - cos x) / x^2 and (1 - sin(x)/x) / x^2: 1/2! - x^2/4! + .., 1/3! - x^2/5! + .., terms in pairs
  const T of_c = (T(1.0 / 2) - T(1.0 / 24) * xx) + x4 * ((T(1.0 / 720) - T(1.0 / 40320) * xx) +
                                                         x4 * (T(1.0 / 3628800) - T(1.0 / 479001600) * xx));
  const T of_s =
      (T(1.0 / 6) - T(1.0 / 120) * xx) +
      x4 * ((T(1.0 / 5040) - T(1.0 / 362880) * xx) + x4 * (T(1.0 / 39916800) - T(1.0 / 6227020800) * xx));
  const T c = T(1.0) - xx * of_c, s = T(0.5) - T(0.5) * (xx * of_s);
  return {c, s * phi.x, s * phi.y, s * phi.z};
}

/// Exact rotation by the vector phi of any size.  [rad]
inline Quatd rotation_of(const Vec3d& phi) {
  const double phi2 = norm2(phi);
  if (phi2 <= small_rotation_limit2) return small_rotation(phi);
  const double angle = std::sqrt(phi2), s = std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * phi.x, s * phi.y, s * phi.z};
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
