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

template <Scalar T>
VBOND_HD SectionRates<T> section_rates(const BondPose<T>& b, const T& R_i, const T& R_j,
                                       const BondAxis<T>& axis, const BondRates<T>& rates) {
  const Vec3<T>& d = axis.d;
  const Vec3<T> D_rate = rates.v_ij + R_j * cross(rates.w_j, b.n_j[0]) - R_i * cross(rates.w_i, b.n_i[0]);
  const Vec3<T> w = rates.w_j - rates.w_i;
  const T v_n = dot(d, D_rate), w_n = dot(d, w);
  return {v_n, D_rate - v_n * d - cross(T(0.5) * (rates.w_i + rates.w_j), axis.D * d), w - w_n * d, w_n};
}

/// The loads of linear damping with these coefficients: R = (g_A v_n^2 + g_D v_s^2 + g_B w_t^2 + g_T w_n^2)/2
/// is half of the power that they take out. Forces balance and so do moments, at any rotation; a rigid motion
/// of the pair is not damped. With g = beta c it is beta times the rate of the elastic loads, about rest.
template <Scalar T>
VBOND_HD BondLoads<T> linear_damping(const BondStiffness<T>& g, const BondPose<T>& b, const T& R_i,
                                     const T& R_j, const BondAxis<T>& axis, const BondRates<T>& rates) {
  const SectionRates<T> s = section_rates(b, R_i, R_j, axis, rates);
  const Vec3<T> shear = g.c_D * s.v_s, F = g.c_A * s.v_n * axis.d + shear;
  const Vec3<T> half = T(0.5) * cross(axis.D * axis.d, shear);
  const Vec3<T> couple = g.c_B * s.w_t + g.c_T * s.w_n * axis.d;
  return {F, R_i * cross(b.n_i[0], F) + half + couple, half - couple - R_j * cross(b.n_j[0], F)};
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
