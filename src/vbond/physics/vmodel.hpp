#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

/// The vector-based model of Kuzkin & Asonov, [KA12] eqs. (6), (7).
/// Rest is the global minimum if B1, B3, B4 > 0 and B2 > -B3/2.
/// Limits: 16 equal minima (either particle turned by 180 degrees about a bond axis); see docs/theory.md.
template <Scalar T>
struct VModel {
  using Number = T;
  T a;           ///< length at rest between the bonded points  [length], > 0
  T R_i, R_j;    ///< bonded points' distances from the centres  [length]
  T B1;          ///< [force/length]
  T B2, B3, B4;  ///< [force*length]

  static constexpr std::string_view name = "v-model", title = "V-model";
  static constexpr double strained_past = 45;  ///< tilt or twist  [degrees]
  static constexpr std::string_view rest_condition = "B3 > 0 and B2 > -B3/2",
                                    rest_way_out = "take B3 = c_D a^2/2 and B2 = c_B - B3/2";
  static constexpr auto fields() {
    return std::array<LawField<VModel>, 4>{
        {{&VModel::B1,
          {"B1", force_per_length, "longitudinal", LawInput::from_stiffness, LawBound::positive}},
         {&VModel::B2, {"B2", force_times_length, "> -B3/2"}},
         {&VModel::B3, {"B3", force_times_length, "> 0"}},
         {&VModel::B4, {"B4", force_times_length, "torsion", LawInput::from_stiffness, LawBound::positive}}}};
  }

  /// Coefficients that match four stiffnesses exactly: the inverse of [KA12] eq. (19).
  static constexpr VModel from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    const T B3 = T(0.5) * c.c_D * sq(a);
    return {a, R_i, R_j, c.c_A, c.c_B - T(0.5) * B3, B3, c.c_T};
  }
};

template <Scalar T>
inline constexpr bool tension_is_linear<VModel<T>> = true;

/// Energy of stretching to the length D, and its derivative, positive in tension.  [energy], [force]
template <Scalar T>
VBOND_HD T stretch_energy(const VModel<T>& m, const T& D) {
  return T(0.5) * m.B1 * sq(D - m.a);
}
template <Scalar T>
VBOND_HD T tension(const VModel<T>& m, const T& D) {
  return m.B1 * (D - m.a);
}

/// Energy of a bond relative to rest, where U(undeformed) = -B2/2 - B3 - B4/2.  [KA12] eqs. (6), (7)
/// The printed eq. for the arguments of U_T lacks a square on its first factor; eq. (7) has it.
template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const VModel<T>& m, const BondPose<T>& b) {
  const Vec3<T> D_ij = bonded_points(b, m.R_i, m.R_j);
  const T D = norm(D_ij);
  const Vec3<T> d_ij = D_ij / D;
  const T half(0.5), quarter(0.25), one(1.0);

  const T U_L = stretch_energy(m, D);

  const T s1 = dot(b.n_i[0], b.n_j[0]), s2 = dot(d_ij, b.n_i[0]), s3 = -dot(d_ij, b.n_j[0]);
  const T U_B = half * m.B2 * (one - sq(s1)) + half * m.B3 * ((one - sq(s2)) + (one - sq(s3)));

  T U_T = half * m.B4;
  for (int k = 1; k < 3; ++k) {  // the paper's k = 2, 3
    const T s1k = dot(b.n_i[k], b.n_j[k]), s2k = dot(d_ij, b.n_i[k]), s3k = -dot(d_ij, b.n_j[k]);
    U_T = U_T - quarter * m.B4 * sq(s1k + s2k * s3k) * (one + sq(s2k)) * (one + sq(s3k));
  }
  return {U_L, U_B, U_T};
}

/// Force and moments of a bond with the tension N: the gradient of bond_energy if N = tension(m, D).  [KA12]
/// eqs. (9), (10). M_ji, which the paper omits, follows from the balance of moments, M_ij + M_ji = r_ij x F,
/// worked out so that nothing cancels.
template <Scalar T>
VBOND_HD BondLoads<T> loads_at_tension(const VModel<T>& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                       const T& N) {
  const T per_D = axis.per_D;
  const Vec3<T>& d = axis.d;
  const T one(1.0), half_B4 = T(0.5) * m.B4;
  const T c_i = dot(d, b.n_i[0]), c_j = dot(d, b.n_j[0]), s1 = dot(b.n_i[0], b.n_j[0]);

  // bending and shear; dU/dd has a part from the vectors of i and one from those of j
  Vec3<T> from_i = -(m.B3 * c_i) * b.n_i[0], from_j = -(m.B3 * c_j) * b.n_j[0];
  Vec3<T> couple = cross(b.n_i[0], m.B2 * s1 * b.n_j[0]);

  // torsion
  for (int k = 1; k < 3; ++k) {  // the paper's k = 2, 3
    const T s1k = dot(b.n_i[k], b.n_j[k]), s2k = dot(d, b.n_i[k]), s3k = -dot(d, b.n_j[k]);
    const T p = s1k + s2k * s3k, q2 = one + sq(s2k), q3 = one + sq(s3k);
    const T B4_p = half_B4 * p, B4_p_q2 = B4_p * q2, B4_p_q3 = B4_p * q3;
    from_i -= B4_p_q3 * (s3k * q2 + p * s2k) * b.n_i[k];  // U_2k n_ik
    from_j += B4_p_q2 * (s2k * q3 + p * s3k) * b.n_j[k];  // -U_3k n_jk
    couple += cross(b.n_i[k], B4_p_q2 * q3 * b.n_j[k]);   // U_1k n_jk x n_ik
  }
  const Vec3<T> dU_dd = from_i + from_j;
  const Vec3<T> F = (N - per_D * dot(dU_dd, d)) * d + per_D * dU_dd;
  return {F, cross(d, from_i) + couple + m.R_i * cross(b.n_i[0], F),
          cross(d, from_j) - couple - m.R_j * cross(b.n_j[0], F)};
}

template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const VModel<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return loads_at_tension(m, b, axis, tension(m, axis.D));
}

/// Stiffnesses about rest, [KA12] eq. (19).
template <Scalar T>
VBOND_HD constexpr BondStiffness<T> stiffness(const VModel<T>& m) {
  return {m.B1, T(2.0) * m.B3 / sq(m.a), m.B2 + T(0.5) * m.B3, m.B4};
}

/// Strained: an end tilted or the bond twisted past 45 degrees, where the moment, a sine of twice the angle,
/// has peaked. Snapped: past 90 degrees, in the basin of a wrong rest state.
inline BondRange bond_range(const VModel<double>&, const BondShape& s) {
  const double c = std::min(s.c_i, s.c_j), twist = std::abs(s.twist);
  if (c <= 0.0 || twist > std::numbers::pi / 2) return BondRange::snapped;
  if (c < std::numbers::sqrt2 / 2 || twist > std::numbers::pi / 4) return BondRange::strained;
  return BondRange::good;
}

}  // namespace vbond
