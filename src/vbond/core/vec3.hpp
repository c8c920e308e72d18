#pragma once
#include <cmath>

#include "vbond/core/scalar.hpp"

namespace vbond {

/// A vector of three Cartesian components over any scalar.
template <Scalar T>
struct Vec3 {
  T x{}, y{}, z{};

  VBOND_HD constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  VBOND_HD constexpr Vec3& operator-=(const Vec3& b) { return *this = *this - b; }

  friend VBOND_HD constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend VBOND_HD constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend VBOND_HD constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend VBOND_HD constexpr Vec3 operator*(const T& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend VBOND_HD constexpr Vec3 operator*(const Vec3& a, const T& s) { return s * a; }
  friend VBOND_HD constexpr Vec3 operator/(const Vec3& a, const T& s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

template <Scalar T>
VBOND_HD constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <Scalar T>
VBOND_HD constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <Scalar T>
VBOND_HD constexpr T norm2(const Vec3<T>& a) {
  return dot(a, a);
}

template <Scalar T>
VBOND_HD T norm(const Vec3<T>& a) {
  using std::sqrt;  // a dual number or a pack brings its own
  return sqrt(norm2(a));
}

/// a / |a|; the caller knows that a is not zero.
template <Scalar T>
VBOND_HD Vec3<T> normalised(const Vec3<T>& a) {
  return a / norm(a);
}

/// The part of a that is normal to the unit vector d.
template <Scalar T>
VBOND_HD constexpr Vec3<T> across(const Vec3<T>& a, const Vec3<T>& d) {
  return a - dot(a, d) * d;
}

using Vec3d = Vec3<double>;

/// Component 0, 1, 2 = x, y, z.
inline double& component(Vec3d& a, int k) {
  return k == 0 ? a.x : k == 1 ? a.y : a.z;
}
inline double component(const Vec3d& a, int k) {
  return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

/// True if no component is NaN or infinite.
inline bool is_finite(const Vec3d& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace vbond
