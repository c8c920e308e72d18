#pragma once
#include "vbond/physics/pose.hpp"
#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// What a cross-section of the bond carries, from the loads on its particles.
template <Scalar T>
struct SectionLoads {
  T N;    ///< axial force, tension positive  [force]
  T V;    ///< shear force, its size  [force]
  T M_b;  ///< bending moment at the middle of the bond, its size  [force*length]
  T M_t;  ///< torque, positive if it turns i about d  [force*length]
};

/// Moments on the ends of a bond about its bonded points, and their half difference: the moment at the
/// middle.
template <Scalar T>
struct SectionMoments {
  Vec3<T> end_i, end_j, middle;
};

template <Scalar T>
VBOND_HD SectionMoments<T> section_moments(const BondPose<T>& b, const T& R_i, const T& R_j,
                                           const BondLoads<T>& l) {
  const Vec3<T> m_i = l.M_ij - R_i * cross(b.n_i[0], l.F), m_j = l.M_ji + R_j * cross(b.n_j[0], l.F);
  return {m_i, m_j, T(0.5) * (m_i - m_j)};
}

template <Scalar T>
VBOND_HD SectionLoads<T> section_loads(const SectionMoments<T>& m, const BondAxis<T>& axis,
                                       const BondLoads<T>& l) {
  const T N = dot(l.F, axis.d), M_t = dot(m.middle, axis.d);
  return {N, norm(l.F - N * axis.d), norm(m.middle - M_t * axis.d), M_t};
}

/// The larger of the bending moments at the two ends.  [force*length]
template <Scalar T>
VBOND_HD T larger_end_moment(const SectionMoments<T>& m, const BondAxis<T>& axis) {
  return larger(norm(across(m.end_i, axis.d)), norm(across(m.end_j, axis.d)));
}

/// How fast a bond is stretched, sheared, bent and twisted: the rates that N, V, M_b and M_t do work on.
template <Scalar T>
struct SectionRates {
  T v_n;        ///< stretching  [length/time]
  Vec3<T> v_s;  ///< shearing  [length/time]
  Vec3<T> w_t;  ///< bending  [rad/time]
  T w_n;        ///< twisting  [rad/time]
};

/// From the centres to the bonded points, of both together.  [length]
template <Scalar T>
VBOND_HD Vec3<T> sum_of_levers(const BondPose<T>& b, const T& R_i, const T& R_j) {
  return R_i * b.n_i[0] + R_j * b.n_j[0];
}

template <Scalar T>
VBOND_HD SectionRates<T> section_rates(const BondPose<T>& b, const T& R_i, const T& R_j,
                                       const BondAxis<T>& axis, const BondRates<T>& rates) {
  const Vec3<T>& d = axis.d;
  const Vec3<T> w = rates.w_j - rates.w_i;
  // the rate of D_ij as seen by one who turns with the mean of the two
  const Vec3<T> u =
      rates.v_ij + T(0.5) * (cross(w, sum_of_levers(b, R_i, R_j)) - cross(rates.w_i + rates.w_j, b.r_ij));
  const T v_n = dot(d, u), w_n = dot(d, w);
  return {v_n, u - v_n * d, w - w_n * d, w_n};
}

/// The loads of linear damping with these coefficients: R = (g_A v_n^2 + g_D v_s^2 + g_B w_t^2 + g_T w_n^2)/2
/// is half of the power that they take out. Forces balance and so do moments, at any rotation; a rigid motion
/// of the pair is not damped. With g = beta c it is beta times the rate of the elastic loads, about rest.
template <Scalar T>
VBOND_HD BondLoads<T> linear_damping(const BondStiffness<T>& g, const BondPose<T>& b, const T& R_i,
                                     const T& R_j, const BondAxis<T>& axis, const BondRates<T>& rates) {
  const SectionRates<T> s = section_rates(b, R_i, R_j, axis, rates);
  const Vec3<T> F = g.c_A * s.v_n * axis.d + g.c_D * s.v_s;
  const Vec3<T> half_F = T(0.5) * F, half = cross(b.r_ij, half_F);
  const Vec3<T> couple = g.c_B * s.w_t + g.c_T * s.w_n * axis.d + cross(sum_of_levers(b, R_i, R_j), half_F);
  return {F, half + couple, half - couple};
}

/// The power that damping takes out of the motion of a bond, by channel.  [energy/time]
template <Scalar T>
struct DampingPowers {
  T axial, shear, bending, torsion;
};

/// That of linear_damping.
template <Scalar T>
VBOND_HD DampingPowers<T> linear_damping_powers(const BondStiffness<T>& g, const BondPose<T>& b, const T& R_i,
                                                const T& R_j, const BondAxis<T>& axis,
                                                const BondRates<T>& rates) {
  const SectionRates<T> s = section_rates(b, R_i, R_j, axis, rates);
  return {g.c_A * sq(s.v_n), g.c_D * norm2(s.v_s), g.c_B * norm2(s.w_t), g.c_T * sq(s.w_n)};
}

}  // namespace vbond
