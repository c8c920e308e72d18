#pragma once
#include <cmath>
#include <concepts>
#include <cstdint>

#include "vbond/physics/pose.hpp"

namespace vbond {

/// Where a bond stands in the range in which its law can be trusted; see docs/theory.md.
enum class BondRange : std::uint8_t { good, strained, snapped };

/// Deformation of a bond as angles and lengths, for watching and for pictures.
struct BondShape {
  double length;  ///< |D_ij|
  double c_i;     ///< d . n_i1, 1 at rest
  double c_j;     ///< -d . n_j1, 1 at rest
  double twist;   ///< about d_ij  [rad], -pi .. pi
  double bend;    ///< angle between n_i1 and -n_j1  [rad], 0 .. pi
};

/// The same without angles, for one bond or a pack of them: what decides whether a closer look is needed.
template <Scalar T>
struct BondTilt {
  T length;                ///< |D_ij|
  T c_i, c_j;              ///< as in BondShape
  T cos_twist, sin_twist;  ///< times one factor, 2 at rest and positive unless an end is at right angles
};

template <Scalar T>
VBOND_HD BondTilt<T> bond_tilt(const BondPose<T>& b, const T& R_i, const T& R_j) {
  const Vec3<T> D_ij = bonded_points(b, R_i, R_j);
  const T D = norm(D_ij);
  const Vec3<T> d = D_ij / D;
  const Vec3<T> i2 = across(b.n_i[1], d), i3 = across(b.n_i[2], d);
  const Vec3<T> j2 = across(b.n_j[1], d), j3 = across(b.n_j[2], d);
  return {D, dot(d, b.n_i[0]), -dot(d, b.n_j[0]), dot(i2, j2) + dot(i3, j3),
          dot(d, cross(i2, j2) + cross(i3, j3))};
}

inline BondShape bond_shape(const BondPose<double>& b, double R_i, double R_j) {
  const BondTilt<double> t = bond_tilt(b, R_i, R_j);
  return {t.length, t.c_i, t.c_j, std::atan2(t.sin_twist, t.cos_twist),
          std::atan2(norm(cross(b.n_i[0], b.n_j[0])), -dot(b.n_i[0], b.n_j[0]))};
}

/// False only if the bond is longer than half its length at rest, shorter than twice that, and in the good
/// range of every law, with room to spare; a NaN needs a look.
template <std::floating_point T>
VBOND_HD bool needs_look(const BondTilt<T>& t, T a) {
  constexpr T c_least = 0.71;     // cos 45 degrees = 0.7071
  constexpr T sin_to_cos = 0.99;  // tan 45 degrees = 1
  return !(t.length > T(0.51) * a && t.length < T(1.99) * a && t.c_i > c_least && t.c_j > c_least &&
           std::abs(t.sin_twist) < sin_to_cos * t.cos_twist);
}

}  // namespace vbond
