#pragma once
#include "vbond/physics/pose.hpp"
#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// The enhanced vector model (Kuzkin & Krivtsov 2017; Ostanin et al., J. Appl. Mech. 86 (2019) 121006).
/// It has none of the V-model's false minima; bending and twist follow the sine of the
/// angle where the V-model follows the sine of twice the angle.
template <Scalar T>
struct Evm {
  T a;           ///< length at rest between the bonded points  [length], > 0
  T R_i, R_j;    ///< bonded points' distances from the centres  [length]
  T B1;          ///< [force/length]
  T B2, B3, B4;  ///< [force*length]
};

/// Energy of a bond relative to rest, where U(undeformed) = -B2 - B3 - B4.
/// The B4 term is booked as torsion although it also resists bending (c_B contains B4/2).
template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Evm<T>& m, const BondPose<T>& b) {
  const Vec3<T> D_ij = bonded_points(b, m.R_i, m.R_j);
  const T D = norm(D_ij);
  const Vec3<T> d = D_ij / D;
  const T half(0.5), one(1.0), two(2.0);
  return {half * m.B1 * sq(D - m.a),
          half * m.B2 * (two + dot(b.n_j[0] - b.n_i[0], d)) + m.B3 * (one + dot(b.n_i[0], b.n_j[0])),
          half * m.B4 * (two - dot(b.n_i[1], b.n_j[1]) - dot(b.n_i[2], b.n_j[2]))};
}

/// Force and moments of a bond: the gradient of bond_energy.
template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Evm<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  const auto& [D, per_D, d] = axis;
  const T half(0.5);

  const Vec3<T> n = b.n_j[0] - b.n_i[0];
  const Vec3<T> F = m.B1 * (D - m.a) * d + (half * m.B2 * per_D) * (n - dot(n, d) * d);
  const Vec3<T> couple = m.B3 * cross(b.n_j[0], b.n_i[0]) -
                         half * m.B4 * (cross(b.n_j[1], b.n_i[1]) + cross(b.n_j[2], b.n_i[2]));
  return {F, couple + cross(b.n_i[0], m.R_i * F + half * m.B2 * d),
          -couple - cross(b.n_j[0], m.R_j * F + half * m.B2 * d)};
}

/// Parameters that match four stiffnesses exactly.
template <Scalar T>
constexpr Evm<T> evm_from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
  const T B2 = c.c_D * sq(a);
  return {a, R_i, R_j, c.c_A, B2, c.c_B - T(0.25) * B2 - T(0.5) * c.c_T, c.c_T};
}

/// Stiffnesses about rest.
template <Scalar T>
constexpr BondStiffness<T> stiffness(const Evm<T>& m) {
  return {m.B1, m.B2 / sq(m.a), T(0.25) * m.B2 + m.B3 + T(0.5) * m.B4, m.B4};
}

}  // namespace vbond
