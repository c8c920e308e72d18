#pragma once
#include <cmath>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Hertz repulsion F = k delta^(3/2), delta = R_i + R_j - r > 0.
/// The caller leaves out pairs that do not touch: below contact the power has no real value.
template <Scalar T>
struct HertzContact {
  T k;  ///< [force/length^(3/2)], >= 0
};

/// Energy 2/5 k delta^(5/2); zero when just touching.
template <Scalar T>
VBOND_HD T contact_energy(const HertzContact<T>& h, const T& delta) {
  using std::sqrt;
  return T(0.4) * h.k * sq(delta) * sqrt(delta);
}

/// Size of the repulsion for an overlap delta >= 0.
template <Scalar T>
VBOND_HD T contact_force(const HertzContact<T>& h, const T& delta) {
  using std::sqrt;
  return h.k * delta * sqrt(delta);
}

/// Tangent stiffness 3/2 k sqrt(delta), for the critical step.
template <Scalar T>
VBOND_HD T contact_stiffness(const HertzContact<T>& h, const T& delta) {
  using std::sqrt;
  return T(1.5) * h.k * sqrt(delta);
}

/// Secant s = k sqrt(delta) of the repulsion: F = s delta.  [force/length]
template <Scalar T>
VBOND_HD T contact_secant(const HertzContact<T>& h, const T& delta) {
  using std::sqrt;
  return h.k * sqrt(delta);
}

/// The same of two elastic spheres whose contact has the radius a = sqrt(R* delta): s = 4/3 E* a.
template <Scalar T>
VBOND_HD T hertz_secant(const T& E_star, const T& a) {
  return T(4.0 / 3.0) * E_star * a;
}

/// contact_energy() by the secant, 2/5 s delta^2, for callers that have the secant already. The two differ by
/// rounding.
template <Scalar T>
VBOND_HD T energy_of_secant(const T& secant, const T& delta) {
  return T(0.4) * secant * delta * delta;
}

/// The paper's form, F = c_H / sqrt(a) (2R - r)^(3/2), [KA12] section VI B: one k for all pairs.
constexpr HertzContact<double> paper_hertz(double c_H, double sqrt_a) {
  return {c_H / sqrt_a};
}

/// E* = E / (2 (1 - nu^2)) of two bodies of one material  (Johnson, Contact Mechanics, ch. 4).
constexpr double effective_modulus(double E, double nu) {
  return E / (2.0 * (1.0 - sq(nu)));
}

/// R* of two spheres: 1/R* = 1/R_i + 1/R_j.  [length]
template <Scalar T>
VBOND_HD T reduced_radius(const T& R_i, const T& R_j) {
  return R_i * R_j / (R_i + R_j);
}

/// Hertz for two elastic spheres of radii R_i, R_j: k = 4/3 E* sqrt(R*)  (the same).
template <Scalar T>
VBOND_HD HertzContact<T> hertz(double E_star, const T& R_i, const T& R_j) {
  using std::sqrt;
  return {T(4.0 / 3.0 * E_star) * sqrt(reduced_radius(R_i, R_j))};
}
inline HertzContact<double> hertz(double E, double nu, double R_i, double R_j) {
  return hertz(effective_modulus(E, nu), R_i, R_j);
}

}  // namespace vbond
