#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

/// The enhanced vector model (Kuzkin & Krivtsov 2017; Ostanin et al., J. Appl. Mech. 86 (2019) 121006).
/// It has none of the V-model's false minima; bending and twist follow the sine of the
/// angle where the V-model follows the sine of twice the angle.
template <Scalar T>
struct Evm {
  using Number = T;
  T a;           ///< length at rest between the bonded points  [length], > 0
  T R_i, R_j;    ///< bonded points' distances from the centres  [length]
  T B1;          ///< [force/length]
  T B2, B3, B4;  ///< [force*length]

  static constexpr std::string_view name = "evm", title = "enhanced vector model (EVM)";
  static constexpr double strained_past = 90;  ///< tilt or twist  [degrees]
  static constexpr std::string_view rest_condition = "B2 > 0 and B2/4 + B3 + B4/2 > 0",
                                    rest_way_out = "take B2 = c_D a^2 and B3 = c_B - B2/4 - B4/2";
  static constexpr auto fields() {
    return std::array<LawField<Evm>, 4>{
        {{&Evm::B1, {"B1", force_per_length, "longitudinal", LawInput::from_stiffness, LawBound::positive}},
         {&Evm::B2, {"B2", force_times_length, "> 0"}},
         {&Evm::B3, {"B3", force_times_length, "> -B2/4 - B4/2"}},
         {&Evm::B4, {"B4", force_times_length, "torsion", LawInput::from_stiffness, LawBound::positive}}}};
  }

  /// Coefficients that match four stiffnesses exactly.
  static constexpr Evm from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    const T B2 = c.c_D * sq(a);
    return {a, R_i, R_j, c.c_A, B2, c.c_B - T(0.25) * B2 - T(0.5) * c.c_T, c.c_T};
  }
};

template <Scalar T>
inline constexpr bool tension_is_linear<Evm<T>> = true;

/// Energy of stretching to the length D, and its derivative, positive in tension.  [energy], [force]
template <Scalar T>
VBOND_HD T stretch_energy(const Evm<T>& m, const T& D) {
  return T(0.5) * m.B1 * sq(D - m.a);
}
template <Scalar T>
VBOND_HD T tension(const Evm<T>& m, const T& D) {
  return m.B1 * (D - m.a);
}

/// Energy of a bond relative to rest, where U(undeformed) = -B2 - B3 - B4.
/// The B4 term is booked as torsion although it also resists bending (c_B contains B4/2).
template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Evm<T>& m, const BondPose<T>& b) {
  const Vec3<T> D_ij = bonded_points(b, m.R_i, m.R_j);
  const T D = norm(D_ij);
  const Vec3<T> d = D_ij / D;
  const T half(0.5), one(1.0), two(2.0);
  return {stretch_energy(m, D),
          half * m.B2 * (two + dot(b.n_j[0] - b.n_i[0], d)) + m.B3 * (one + dot(b.n_i[0], b.n_j[0])),
          half * m.B4 * (two - dot(b.n_i[1], b.n_j[1]) - dot(b.n_i[2], b.n_j[2]))};
}

/// Force and moments of a bond with the tension N: the gradient of bond_energy if N = tension(m, D).
template <Scalar T>
VBOND_HD BondLoads<T> loads_at_tension(const Evm<T>& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                       const T& N) {
  const T per_D = axis.per_D;
  const Vec3<T>& d = axis.d;
  const T half(0.5);

  const Vec3<T> n = b.n_j[0] - b.n_i[0];
  const Vec3<T> F = N * d + (half * m.B2 * per_D) * (n - dot(n, d) * d);
  const Vec3<T> couple = m.B3 * cross(b.n_j[0], b.n_i[0]) -
                         half * m.B4 * (cross(b.n_j[1], b.n_i[1]) + cross(b.n_j[2], b.n_i[2]));
  return {F, couple + cross(b.n_i[0], m.R_i * F + half * m.B2 * d),
          -couple - cross(b.n_j[0], m.R_j * F + half * m.B2 * d)};
}

template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Evm<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return loads_at_tension(m, b, axis, tension(m, axis.D));
}

/// Stiffnesses about rest.
template <Scalar T>
VBOND_HD constexpr BondStiffness<T> stiffness(const Evm<T>& m) {
  return {m.B1, m.B2 / sq(m.a), T(0.25) * m.B2 + m.B3 + T(0.5) * m.B4, m.B4};
}

/// Strained: past 90 degrees, where its moment, a sine of the angle, has peaked. It has no wrong rest state.
inline BondRange bond_range(const Evm<double>&, const BondShape& s) {
  const bool past = std::min(s.c_i, s.c_j) < 0.0 || std::abs(s.twist) > std::numbers::pi / 2;
  return past ? BondRange::strained : BondRange::good;
}

}  // namespace vbond
