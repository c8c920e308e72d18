#pragma once
#include <cmath>
#include <numbers>

#include "vbond/core/scalar.hpp"

namespace vbond {

/// The four stiffnesses of a bond for small deformations about rest, [KA12] eqs. (12), (13).
template <Scalar T>
struct BondStiffness {
  T c_A;  ///< longitudinal  [force/length]
  T c_D;  ///< shear  [force/length]
  T c_B;  ///< bending  [force*length/rad]
  T c_T;  ///< torsional  [force*length/rad]
};

/// Isotropic elastic material of a bond.
struct Material {
  double E;   ///< Young's modulus  [force/area], > 0
  double nu;  ///< Poisson's ratio, -1 < nu <= 0.5 (short cylinder: < 0.5)
  constexpr double G() const { return 0.5 * E / (1.0 + nu); }
};

/// Cross-section of a bond; bending stiffness is taken as isotropic.
struct Section {
  double A;      ///< area  [length^2]
  double J;      ///< second moment of area  [length^4]
  double J_p;    ///< torsion constant; the polar moment 2J for circle and annulus  [length^4]
  double r = 0;  ///< distance of the outermost fibre from the axis, for strengths  [length]
};

/// Full circle of diameter d.
constexpr Section circle(double d) {
  const double J = std::numbers::pi / 64.0 * sq(sq(d));
  return {0.25 * std::numbers::pi * sq(d), J, 2.0 * J, 0.5 * d};
}

/// Annulus of outer diameter d and inner diameter d_inner, 0 <= d_inner < d.
constexpr Section annulus(double d, double d_inner) {
  const Section o = circle(d), i = circle(d_inner);
  return {o.A - i.A, o.J - i.J, o.J_p - i.J_p, o.r};
}

/// Square of side h; J_p is Saint-Venant's torsion constant 0.1405770 h^4 (Timoshenko & Goodier,
/// Theory of Elasticity, torsion of rectangular bars), not the polar moment h^4/6.
constexpr Section square(double h) {
  constexpr double saint_venant = 0.140577014955157;
  return {sq(h), sq(sq(h)) / 12.0, saint_venant * sq(sq(h)), 0.5 * h};
}

/// Hutchinson's shear coefficient of a full circle, [KA12] eq. (25).
constexpr double hutchinson_circle(double nu) {
  return 6.0 * sq(1.0 + nu) / (7.0 + 12.0 * nu + 4.0 * sq(nu));
}

/// Massless Bernoulli-Euler rod of length a, [KA12] eq. (20). For slender bonds.
constexpr BondStiffness<double> bernoulli_euler(const Material& m, const Section& s, double a) {
  return {m.E * s.A / a, 12.0 * m.E * s.J / (a * a * a), m.E * s.J / a, m.G() * s.J_p / a};
}

/// Massless Timoshenko rod of length a with shear coefficient kappa > 0, [KA12] eq. (29).
/// kappa -> infinity gives Bernoulli-Euler.
constexpr BondStiffness<double> timoshenko(const Material& m, const Section& s, double a, double kappa) {
  const double kA = kappa * s.A;
  return {m.E * s.A / a, 12.0 * kA * m.E * s.J / (a * (kA * sq(a) + 24.0 * s.J * (1.0 + m.nu))),
          m.E * s.J / a, m.G() * s.J_p / a};
}

/// Short cylinder of length a between rigid ends, uniaxial strain, [KA12] eqs. (33), (35), (36); nu < 0.5.
constexpr BondStiffness<double> short_cylinder(const Material& m, const Section& s, double a) {
  const double confined = (1.0 - m.nu) / ((1.0 + m.nu) * (1.0 - 2.0 * m.nu));
  return {confined * m.E * s.A / a, m.G() * s.A / a, confined * m.E * s.J / a, m.G() * s.J_p / a};
}

/// Springs spread over the section, k_n and k_s per area [force/length^3]: the parallel bond of [PC04], which
/// has no length. c_D and c_B are those of the contact point, about which the bond is symmetric.
constexpr BondStiffness<double> parallel_bond(double k_n, double k_s, const Section& s) {
  return {s.A * k_n, s.A * k_s, s.J * k_n, s.J_p * k_s};
}

/// The stiffness of a bond k between two grains of stiffness of_grain each, one behind the other.
constexpr double between_grains(double k, double of_grain) {
  return 1.0 / (1.0 / k + 2.0 / of_grain);
}

/// The mean distance of the surfaces of two spheres, radii R_i and R_j, gap between them (< 0: they overlap),
/// over a round section of radius r <= R_i, R_j about their axis: the volume of cement in it over its area.
/// -> gap for r -> 0; gap + r^2 (1/R_i + 1/R_j)/4 for r << R.  [length]
inline double neck_length(double gap, double r, double R_i, double R_j) {
  const auto recess = [r](double R) {  // mean of R - sqrt(R^2 - rho^2): with c = sqrt(1 - (r/R)^2)
    const double x = sq(r / R), c = std::sqrt(1.0 - x);
    return R * x * (1.0 + 2.0 * c) / (3.0 * sq(1.0 + c));
  };
  return gap + recess(R_i) + recess(R_j);
}

/// A bond of a triangular sheet that stands for a thin wall of thickness h, whatever the bond's length: with
/// equilateral triangles the sheet stretches by E h/(1-nu^2) and bends by D = E h^3/(12 (1-nu^2)), with
/// Poisson's ratio nu in both; -1 < nu < 1/3. Transverse shear is sqrt(3) c_D, not the wall's. See
/// docs/theory.md.
constexpr BondStiffness<double> shell(const Material& m, double h) {
  const double c_A = m.E * h / (std::numbers::sqrt3 * (1.0 - m.nu)), c_B = c_A * sq(h) / 12.0;
  const double across = (1.0 - 3.0 * m.nu) / (1.0 + m.nu);
  return {c_A, across * c_A, c_B, across * c_B};
}

}  // namespace vbond
