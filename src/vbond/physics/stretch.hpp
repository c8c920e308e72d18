#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "vbond/core/dual.hpp"
#include "vbond/core/scalar.hpp"

namespace vbond {

/// How the energy of stretching depends on the elongation u = D - a. All but `table` have U = c_A u^2/2 to
/// second order about u = 0.
enum class StretchForm : std::uint8_t { harmonic, cubic, two_slopes, fene, morse, table };

/// Energies over lengths, joined by a natural cubic spline.
struct StretchTable {
  static constexpr std::size_t most = 64;
  std::size_t count = 0;     ///< points, 3 to most
  double D[most]{};          ///< increasing  [length]
  double U[most]{};          ///< [energy]
  double curvature[most]{};  ///< second derivatives at the points, zero at both ends

  friend constexpr bool operator==(const StretchTable&, const StretchTable&) = default;
};

/// A form of stretching with its parameters, which all bonds of a set share.
struct Stretch {
  StretchForm form = StretchForm::harmonic;
  double k3 = 0, k4 = 0;   ///< cubic: N = c_A u + k3 u^2 + k4 u^3  [force/length^2], [force/length^3]
  double compression = 1;  ///< two_slopes: c_A times this for u < 0, > 0
  double largest = 0;      ///< fene: the elongation s at which the force diverges  [length], > 0
  double alpha = 0;        ///< morse: U = c_A/(2 alpha^2) (1 - exp(-alpha u))^2  [1/length], > 0
  StretchTable table;      ///< table: instead of c_A and a

  friend constexpr bool operator==(const Stretch&, const Stretch&) = default;
};

/// Energy of stretching, its force (tension positive), and the slope of the force.
struct Stretched {
  double U = 0;  ///< [energy]
  double N = 0;  ///< [force]
  double c = 0;  ///< [force/length]
};

/// The second derivatives of a natural cubic spline at its points. Needs at least three points.
inline void make_spline(StretchTable& t) {
  double above[StretchTable::most]{}, right[StretchTable::most]{};
  const std::size_t n = t.count;
  t.curvature[0] = t.curvature[n - 1] = 0.0;
  for (std::size_t k = 1; k + 1 < n; ++k) {  // elimination downwards
    const double h_0 = t.D[k] - t.D[k - 1], h_1 = t.D[k + 1] - t.D[k];
    const double rise = (t.U[k + 1] - t.U[k]) / h_1 - (t.U[k] - t.U[k - 1]) / h_0;
    const double pivot = 2.0 * (h_0 + h_1) - h_0 * above[k - 1];
    above[k] = h_1 / pivot;
    right[k] = (6.0 * rise - h_0 * right[k - 1]) / pivot;
  }
  for (std::size_t k = n - 2; k > 0; --k) t.curvature[k] = right[k] - above[k] * t.curvature[k + 1];
}

/// The spline at the length D; outside of the table the straight continuation of the energy.
inline Stretched stretched_by_table(const StretchTable& t, double D) {
  const double inside = std::clamp(D, t.D[0], t.D[t.count - 1]);
  std::size_t k = 0;
  while (k + 2 < t.count && !(inside < t.D[k + 1])) ++k;
  const double h = t.D[k + 1] - t.D[k], p = (t.D[k + 1] - inside) / h, q = (inside - t.D[k]) / h;
  const double c_0 = t.curvature[k], c_1 = t.curvature[k + 1];
  Stretched s;
  s.U = p * t.U[k] + q * t.U[k + 1] + h * h / 6.0 * ((p * p * p - p) * c_0 + (q * q * q - q) * c_1);
  s.N = (t.U[k + 1] - t.U[k]) / h + h / 6.0 * ((3.0 * q * q - 1.0) * c_1 - (3.0 * p * p - 1.0) * c_0);
  s.c = inside == D ? p * c_0 + q * c_1 : 0.0;
  s.U += s.N * (D - inside);
  return s;
}

/// Energy, force and slope of a bond of rest length a that is D long. Past the largest elongation of `fene`
/// none of them is finite. Lengths and c_A > 0 in the units of the parameters.
inline Stretched stretched(const Stretch& form, double c_A, double a, double D) {
  const double u = D - a;
  switch (form.form) {
    case StretchForm::harmonic: break;
    case StretchForm::cubic:
      return {u * u * (0.5 * c_A + u * (form.k3 / 3.0 + 0.25 * form.k4 * u)),
              u * (c_A + u * (form.k3 + form.k4 * u)), c_A + u * (2.0 * form.k3 + 3.0 * form.k4 * u)};
    case StretchForm::two_slopes: {
      const double c = u < 0.0 ? form.compression * c_A : c_A;
      return {0.5 * c * u * u, c * u, c};
    }
    case StretchForm::fene: {
      const double x2 = sq(u / form.largest), left = std::abs(u) < form.largest ? 1.0 - x2 : NAN;
      return {-0.5 * c_A * sq(form.largest) * std::log(left), c_A * u / left, c_A * (1.0 + x2) / sq(left)};
    }
    case StretchForm::morse: {
      const double e = std::exp(-form.alpha * u), lost = -std::expm1(-form.alpha * u);
      return {0.5 * c_A * sq(lost / form.alpha), c_A / form.alpha * lost * e, c_A * e * (2.0 * e - 1.0)};
    }
    case StretchForm::table: return stretched_by_table(form.table, D);
  }
  return {0.5 * c_A * u * u, c_A * u, c_A};
}

/// The largest slope that the time step allows for: cubic at |u| <= a/10, fene at |u| <= 0.9 of the largest
/// elongation, morse at u >= -a/10, table wherever it is defined.  [force/length]
inline double stiffest(const Stretch& form, double c_A, double a) {
  switch (form.form) {
    case StretchForm::harmonic: break;
    case StretchForm::two_slopes: return c_A * std::max(1.0, form.compression);
    case StretchForm::cubic: {
      double most = c_A;
      for (const double u : {-0.1 * a, 0.1 * a}) most = std::max(most, stretched(form, c_A, a, a + u).c);
      return most;
    }
    case StretchForm::fene: return stretched(form, c_A, a, a + 0.9 * form.largest).c;
    case StretchForm::morse: return stretched(form, c_A, a, 0.9 * a).c;
    case StretchForm::table:
      return std::max(c_A, *std::max_element(form.table.curvature, form.table.curvature + form.table.count));
  }
  return c_A;
}

// ---- the same for the scalars that a law is evaluated with ------------------------------------------------

inline double stretch_energy(const Stretch& form, double c_A, double a, double D) {
  return stretched(form, c_A, a, D).U;
}
inline double tension(const Stretch& form, double c_A, double a, double D) {
  return stretched(form, c_A, a, D).N;
}
/// Dual numbers take the slope; c_A and a carry no derivatives.
template <std::size_t N>
Dual<N> tension(const Stretch& form, const Dual<N>& c_A, const Dual<N>& a, const Dual<N>& D) {
  const Stretched s = stretched(form, c_A.value, a.value, D.value);
  return Dual<N>(s.N) + Dual<N>(s.c) * (D - Dual<N>(D.value));
}
template <std::size_t N>
Dual<N> stretch_energy(const Stretch& form, const Dual<N>& c_A, const Dual<N>& a, const Dual<N>& D) {
  const Stretched s = stretched(form, c_A.value, a.value, D.value);
  return Dual<N>(s.U) + Dual<N>(s.N) * (D - Dual<N>(D.value));
}

}  // namespace vbond
