#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "vbond/physics/evm.hpp"
#include "vbond/physics/vmodel.hpp"

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

inline BondShape bond_shape(const BondPose<double>& b, double R_i, double R_j) {
  const Vec3d D_ij = bonded_points(b, R_i, R_j);
  const double D = norm(D_ij);
  const Vec3d d = D_ij / D;
  const auto across = [&](const Vec3d& n) { return n - dot(n, d) * d; };
  const Vec3d i2 = across(b.n_i[1]), i3 = across(b.n_i[2]);
  const Vec3d j2 = across(b.n_j[1]), j3 = across(b.n_j[2]);
  const Vec3d turn = cross(b.n_i[0], b.n_j[0]);
  return {D, dot(d, b.n_i[0]), -dot(d, b.n_j[0]),
          std::atan2(dot(d, cross(i2, j2) + cross(i3, j3)), dot(i2, j2) + dot(i3, j3)),
          std::atan2(norm(turn), -dot(b.n_i[0], b.n_j[0]))};
}

/// V-model. Strained: an end tilted or the bond twisted past 45 degrees, where the moment, a sine of twice
/// the angle, has peaked. Snapped: past 90 degrees, in the basin of a wrong rest state.
inline BondRange bond_range(const VModel<double>&, const BondShape& s) {
  const double c = std::min(s.c_i, s.c_j), twist = std::abs(s.twist);
  if (c <= 0.0 || twist > std::numbers::pi / 2) return BondRange::snapped;
  if (c < std::numbers::sqrt2 / 2 || twist > std::numbers::pi / 4) return BondRange::strained;
  return BondRange::good;
}

/// EVM. Strained: past 90 degrees, where its moment, a sine of the angle, has peaked. It has no wrong rest
/// state.
inline BondRange bond_range(const Evm<double>&, const BondShape& s) {
  const bool past = std::min(s.c_i, s.c_j) < 0.0 || std::abs(s.twist) > std::numbers::pi / 2;
  return past ? BondRange::strained : BondRange::good;
}

}  // namespace vbond
