#pragma once
#include "vbond/core/quat.hpp"

namespace vbond {

/// How two bonded particles stand to each other; all vectors in the world frame.
/// At rest n_i[0] = -n_j[0] = e_ij, n_i[1] = n_j[1], n_i[2] = n_j[2]: the triad of j is left-handed.
/// Index 0, 1, 2 is the paper's k = 1, 2, 3.  [KA12] eq. (5)
template <Scalar T>
struct BondPose {
  Vec3<T> r_ij;    ///< r_j - r_i, between the centres  [length]
  Vec3<T> n_i[3];  ///< unit vectors fixed to particle i
  Vec3<T> n_j[3];  ///< unit vectors fixed to particle j
};

/// How a bond's frame is turned in the body frame of each of its particles; at rest both are one frame in
/// the world, with axes n_i1, n_i2, n_i3 = -n_j1, n_j2, n_j3.
template <Scalar T>
struct BondFrames {
  Quat<T> i, j;
};

/// The pose of a bond whose particles stand r_ij apart, as between() in core/cell.hpp says, and are turned by
/// the unit quaternions q_i, q_j.
template <Scalar T>
VBOND_HD BondPose<T> bond_pose(const BondFrames<T>& frame, const Vec3<T>& r_ij, const Quat<T>& q_i,
                               const Quat<T>& q_j) {
  const Axes<T> i = axes(q_i * frame.i), j = axes(q_j * frame.j);
  return {r_ij, {i.x, i.y, i.z}, {-j.x, j.y, j.z}};
}

/// Energy of one bond by channel, relative to rest.  [energy]
template <Scalar T>
struct BondEnergy {
  T U_L;  ///< stretching
  T U_B;  ///< bending and shear
  T U_T;  ///< torsion
};

/// What a bond does to its particles: force on i (j feels -F) and moments about their own centres.
template <Scalar T>
struct BondLoads {
  Vec3<T> F;     ///< force on i  [force]
  Vec3<T> M_ij;  ///< moment on i  [force * length]
  Vec3<T> M_ji;  ///< moment on j  [force * length]
};

/// The vector between the two bonded points, D_ij = r_ij + R_j n_j1 - R_i n_i1.
/// R_i, R_j: distances of the bonded points from the particles' centres.  [KA12] section III
template <Scalar T>
VBOND_HD Vec3<T> bonded_points(const BondPose<T>& b, const T& R_i, const T& R_j) {
  return b.r_ij + R_j * b.n_j[0] - R_i * b.n_i[0];
}

/// The line between the two bonded points, D_ij = D d.
template <Scalar T>
struct BondAxis {
  T D;        ///< [length]
  T per_D;    ///< 1/D
  Vec3<T> d;  ///< unit vector from i to j
};

template <Scalar T>
VBOND_HD BondAxis<T> bond_axis(const BondPose<T>& b, const T& R_i, const T& R_j) {
  using std::sqrt;
  const Vec3<T> D_ij = bonded_points(b, R_i, R_j);
  const T D2 = norm2(D_ij), D = sqrt(D2), per_D2 = T(1.0) / D2;  // neither waits for the other
  const T per_D = per_D2 * D;
  return {D, per_D, per_D * D_ij};
}

/// The rates of two bonded particles at one instant; all vectors in the world frame.
template <Scalar T>
struct BondRates {
  Vec3<T> v_ij;      ///< v_j - v_i, of the centres  [length/time]
  Vec3<T> w_i, w_j;  ///< angular velocities  [rad/time]
};

/// The power that these loads take out of the motion of their two particles.  [energy/time]
template <Scalar T>
VBOND_HD T power_taken(const BondLoads<T>& l, const BondRates<T>& rates) {
  return dot(l.F, rates.v_ij) - dot(l.M_ij, rates.w_i) - dot(l.M_ji, rates.w_j);
}

/// The line between the bonded points of a law, which may be offset (with_offsets.hpp).
template <class Law, Scalar T>
VBOND_HD BondAxis<T> bond_axis(const Law& law, const BondPose<T>& b) {
  if constexpr (requires { law.at_offsets(b); })
    return bond_axis(law.at_offsets(b), law.R_i, law.R_j);
  else
    return bond_axis(b, law.R_i, law.R_j);
}

/// Force and moments of a bond of any law: the gradient of its bond_energy.
template <class Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& law, const BondPose<T>& b) {
  return bond_loads(law, b, bond_axis(law, b));
}

}  // namespace vbond
