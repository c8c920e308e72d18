#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "vbond/core/scalar.hpp"
#include "vbond/physics/section.hpp"
#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// What a bond breaks by. A is the area, r the radius, J and J_p the moments of its section; M_b and M_t are
/// those at the middle of the bond, M_e the larger bending moment of its ends. Compression, N < 0, never adds
/// to what breaks a bond, unless a strength in compression is given; of sums of stresses it takes away.
enum class Criterion : std::uint8_t {
  none,
  stress,        ///< N/A + b M_b r/J or V/A + b |M_t| r/J_p  (Potyondy & Cundall 2004; b: Potyondy 2011)
  mohr_coulomb,  ///< V/A + |M_t| r/J_p against c - (N/A) tan phi; N/A (+ b M_b r/J) against a cut-off
  linear,        ///< N/f + V/f_s + M_b/t_b + |M_t|/t_t >= 1  (Wang & Mora 2009)
  fibre,         ///< N/A + M_e r/J or 4V/3A + |M_t| r/J_p: the outermost fibre of a beam (Brown et al. 2014)
  quadratic,     ///< the sum of the squares of the same quotients as of `linear`
  energy,        ///< N^2/(2 c_A W_1) + (V^2/c_D + M_b^2/c_B + M_t^2/c_T)/(2 W_2) >= 1
  elongation,    ///< D/a - 1
};

/// A criterion and its limits, ready to be multiplied with loads: what share of the strength a unit of N, V,
/// M_b and M_t uses up. For `energy` these are 1/(2 W_1) and 1/(2 W_2), for `elongation` axial is 1/e.
struct Strength {
  Criterion criterion = Criterion::none;
  double axial = 0, shear = 0;                      ///< [1/force]
  double bending = 0, torsion = 0;                  ///< [1/(force*length)]
  double friction = 0;                              ///< mohr_coulomb: tan phi/(A c)  [1/force]
  double compression = 0, compression_bending = 0;  ///< of -N and M_b, stress and fibre only; 0: no limit
  double signed_axial = 0;                          ///< linear: 1 counts N < 0 as relief, else 0
  double tension_limit = 0, shear_limit = 0, compression_limit = 0;  ///< stress: as given, for reports
  /// The shares are those of stresses: each bond has the round section that its own stiffnesses tell.
  bool own_section = false;

  friend constexpr bool operator==(const Strength&, const Strength&) = default;
};

/// Strengths of a section by its stresses, > 0. b, from 0 to 1: the share of the moments that counts.
/// compression: strength against -N/A + b M_b r/J; 0: compression breaks nothing.  [force/area]
constexpr Strength stress_strength(const Section& s, double tension, double shear, double b = 1,
                                   double compression = 0) {
  Strength to;
  to.criterion = Criterion::stress;
  to.axial = 1.0 / (s.A * tension), to.bending = b * s.r / (s.J * tension);
  to.shear = 1.0 / (s.A * shear), to.torsion = b * s.r / (s.J_p * shear);
  if (compression > 0.0)
    to.compression = 1.0 / (s.A * compression), to.compression_bending = b * s.r / (s.J * compression);
  to.tension_limit = tension, to.shear_limit = shear, to.compression_limit = compression;
  return to;
}
/// The same for the outermost fibre of a beam: with the larger end moment and 4V/3A.
constexpr Strength fibre_strength(const Section& s, double tension, double shear, double compression = 0) {
  Strength to = stress_strength(s, tension, shear, 1.0, compression);
  to.criterion = Criterion::fibre;
  to.shear *= 4.0 / 3.0;
  return to;
}
/// Cohesion and tension cut-off, > 0 [force/area]; tan_phi >= 0. b: the share of both moments that counts;
/// without it torsion counts and bending does not.
constexpr Strength mohr_coulomb_strength(const Section& s, double cohesion, double tan_phi, double tension,
                                         std::optional<double> b = {}) {
  Strength to = stress_strength(s, tension, cohesion, b.value_or(1.0));
  to.criterion = Criterion::mohr_coulomb;
  if (!b) to.bending = 0.0;
  to.friction = tan_phi / (s.A * cohesion);
  return to;
}
/// Sum of the quotients of loads and their limits, all > 0; relief: whether N < 0 counts as relief.
constexpr Strength linear_strength(double N, double V, double M_b, double M_t, bool relief = false) {
  Strength to;
  to.criterion = Criterion::linear;
  to.axial = 1.0 / N, to.shear = 1.0 / V, to.bending = 1.0 / M_b, to.torsion = 1.0 / M_t;
  to.signed_axial = relief ? 1.0 : 0.0;
  return to;
}
/// Sum of their squares.
constexpr Strength quadratic_strength(double N, double V, double M_b, double M_t) {
  Strength to = linear_strength(N, V, M_b, M_t);
  to.criterion = Criterion::quadratic;
  return to;
}
/// Elastic energies of tension, and of shear, bending and torsion together, that break alone.  [energy]
constexpr Strength energy_strength(double W_1, double W_2) {
  Strength to;
  to.criterion = Criterion::energy;
  to.axial = 0.5 / W_1, to.shear = to.bending = to.torsion = 0.5 / W_2;
  return to;
}
/// The elongation D/a - 1, > 0.
constexpr Strength elongation_strength(double elongation) {
  Strength to;
  to.criterion = Criterion::elongation;
  to.axial = 1.0 / elongation;
  return to;
}

/// A section on which loads are stresses: for limits of bonds that have sections of their own.
inline constexpr Section unit_section{1.0, 1.0, 1.0, 1.0};

/// The stresses that loads bring about: N/A, M_b r/J, M_t r/J_p per N, M_b, M_t.
template <Scalar T>
struct StressPerLoad {
  T force;             ///< [1/length^2]
  T bending, torsion;  ///< [1/length^3]
};
/// The square of the radius of the full circle that a bond with these stiffnesses has: in every theory with a
/// section c_B/c_A = J/A = r^2/4.  [length^2]
template <Scalar T>
VBOND_HD T own_radius2(const BondStiffness<T>& c) {
  return T(4.0) * c.c_B / c.c_A;
}
/// Of that section.
template <Scalar T>
VBOND_HD StressPerLoad<T> stress_per_load(const BondStiffness<T>& c) {
  using std::sqrt;
  const T r2 = own_radius2(c), per_A = T(std::numbers::inv_pi) / r2, bending = T(4.0) * per_A / sqrt(r2);
  return {per_A, bending, T(0.5) * bending};
}

/// Shares of the strength that tension, shear, bending and torsion use up, and all of them: 1 breaks.
template <Scalar T>
struct Failure {
  T tension, shear, bending, torsion, compression, utilisation;
};

/// How near a bond is to breaking by its elastic loads. c: its stiffnesses; strain: D/a - 1; per_factor: one
/// over the factor of its own strength.
template <Scalar T>
VBOND_HD Failure<T> failure(const Strength& s, const BondStiffness<T>& c, const BondPose<T>& b, const T& R_i,
                            const T& R_j, const BondAxis<T>& axis, const BondLoads<T>& loads, const T& strain,
                            const T& per_factor) {
  const T zero(0.0), one(1.0);
  if (s.criterion == Criterion::elongation) {
    const T x = per_factor * T(s.axial) * strain;
    return {x, zero, zero, zero, zero, x};
  }
  const SectionMoments<T> m = section_moments(b, R_i, R_j, loads);
  const SectionLoads<T> l = section_loads(m, axis, loads);
  const T M_b = s.criterion == Criterion::fibre ? larger_end_moment(m, axis) : l.M_b;
  T N = per_factor * l.N, V = per_factor * l.V, M = per_factor * M_b,
    M_t = per_factor * larger(l.M_t, -l.M_t);
  if (s.own_section) {
    const StressPerLoad<T> stress = stress_per_load(c);
    N = stress.force * N, V = stress.force * V, M = stress.bending * M, M_t = stress.torsion * M_t;
  }
  const T pull = larger(N, zero);
  switch (s.criterion) {
    case Criterion::energy: {
      const T t = T(s.axial) * sq(pull) / c.c_A, v = T(s.shear) * sq(V) / c.c_D,
              bend = T(s.bending) * sq(M) / c.c_B, twist = T(s.torsion) * sq(M_t) / c.c_T;
      return {t, v, bend, twist, zero, t + v + bend + twist};
    }
    case Criterion::quadratic: {
      const T t = sq(T(s.axial) * pull), v = sq(T(s.shear) * V), bend = sq(T(s.bending) * M),
              twist = sq(T(s.torsion) * M_t);
      return {t, v, bend, twist, zero, t + v + bend + twist};
    }
    case Criterion::linear: {
      const T t = T(s.axial) * (pull - T(s.signed_axial) * (pull - N)), v = T(s.shear) * V,
              bend = T(s.bending) * M, twist = T(s.torsion) * M_t;
      return {t, v, bend, twist, zero, t + v + bend + twist};
    }
    case Criterion::mohr_coulomb: {
      const T left = one - T(s.friction) * N, beyond(1e300);
      const T per_left = where_greater(left, zero, one / left, beyond);
      const T t = T(s.axial) * N, bend = T(s.bending) * M, v = T(s.shear) * V * per_left,
              twist = T(s.torsion) * M_t * per_left;
      return {t, v, bend, twist, zero, larger(t + bend, where_greater(left, zero, v + twist, beyond))};
    }
    default: {
      const T t = T(s.axial) * N, bend = T(s.bending) * M, v = T(s.shear) * V, twist = T(s.torsion) * M_t;
      const T crush = T(s.compression) * -N + T(s.compression_bending) * M;
      return {t, v, bend, twist, crush, larger(larger(t + bend, v + twist), crush)};
    }
  }
}

}  // namespace vbond
