#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "rods.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/physics/strength.hpp"
#include "vbond/physics/stretch.hpp"

/// The bond laws once more, in words of model.md and apart from physics/: for tests.
namespace vbond::testing {

/// A law by its stiffnesses c_A, c_D, c_B, c_T at the length a.
struct PlainLaw {
  bool evm = false;
  double a = 1;
  std::array<double, 4> c{};
};

/// The axial force of a form, written apart from physics/stretch.hpp.
inline double axial_force(const Stretch& s, double c_A, double u) {
  switch (s.form) {
    case StretchForm::cubic: return c_A * u + s.k3 * u * u + s.k4 * u * u * u;
    case StretchForm::two_slopes: return u > 0 ? c_A * u : s.compression * c_A * u;
    case StretchForm::fene: return c_A * u / (1 - u * u / (s.largest * s.largest));
    case StretchForm::morse: return c_A / s.alpha * (std::exp(-s.alpha * u) - std::exp(-2 * s.alpha * u));
    default: return c_A * u;
  }
}

/// Force on i, and moments on both about their bonded points.
struct PlainLoads {
  Vec3d F, M_i, M_j;
};

/// Loads of a bond that pulls with N, between bonded points D apart, with these axes: model.md, sections 1
/// and 3.
inline PlainLoads plain_loads(const PlainLaw& b, double N, const Vec3d& D, const Vec3d (&n)[3],
                              const Vec3d (&m)[3]) {
  const double length = std::sqrt(dot(D, D));
  const Vec3d d = (1 / length) * D;
  const auto across_d = [&](const Vec3d& x) { return x - dot(x, d) * d; };
  PlainLoads l{N * d, {}, {}};
  if (b.evm) {
    const double B2 = b.a * b.a * b.c[1], B4 = b.c[3], B3 = b.c[2] - B2 / 4 - B4 / 2;
    const Vec3d twist = (B4 / 2) * (cross(m[1], n[1]) + cross(m[2], n[2]));
    l.F += (B2 / (2 * length)) * across_d(m[0] - n[0]);
    l.M_i = -(B2 / 2) * cross(d, n[0]) + B3 * cross(m[0], n[0]) - twist;
    l.M_j = (B2 / 2) * cross(d, m[0]) - B3 * cross(m[0], n[0]) + twist;
    return l;
  }
  const double B3 = b.c[1] * b.a * b.a / 2, B2 = b.c[2] - B3 / 2, B4 = b.c[3], s1 = dot(n[0], m[0]);
  l.F += -(B3 / length) * (dot(d, n[0]) * across_d(n[0]) + dot(d, m[0]) * across_d(m[0]));
  l.M_i = -1.0 * cross(B2 * s1 * m[0] + B3 * dot(d, n[0]) * d, n[0]);
  l.M_j = -1.0 * cross(B2 * s1 * n[0] + B3 * dot(d, m[0]) * d, m[0]);
  for (int x = 1; x < 3; ++x) {
    const double s1k = dot(n[x], m[x]), s2k = dot(d, n[x]), s3k = -dot(d, m[x]);
    const double p = s1k + s2k * s3k, q2 = 1 + s2k * s2k, q3 = 1 + s3k * s3k;
    const double U1 = -B4 / 2 * p * q2 * q3, U2 = -B4 / 2 * p * q3 * (s3k * q2 + p * s2k),
                 U3 = -B4 / 2 * p * q2 * (s2k * q3 + p * s3k);
    l.F += (1 / length) * (U2 * across_d(n[x]) - U3 * across_d(m[x]));
    l.M_i += cross(U1 * m[x] + U2 * d, n[x]);
    l.M_j += cross(U1 * n[x] - U3 * d, m[x]);
  }
  return l;
}

// ---- strength ------------------------------------------------------------------------------------------

/// What a criterion compares: size of forces and moments at the middle of a bond, and the larger end moment.
struct PlainSection {
  double N, V, M_b, M_t, M_e;
};
inline PlainSection plain_section(const Vec3d& d, const Vec3d& F, const Vec3d& m_i, const Vec3d& m_j) {
  const Vec3d M_c = 0.5 * (m_i - m_j);
  const auto size_across = [&](const Vec3d& x) { return norm(x - dot(x, d) * d); };
  return {dot(F, d), size_across(F), size_across(M_c), dot(M_c, d),
          std::max(size_across(m_i), size_across(m_j))};
}

/// By criterion: stresses, loads, energies or an elongation.
using PlainLimits = std::array<double, 4>;

/// The utilisation of a circle of diameter 0.2: materials.md, section 4.
inline double plain_utilisation(Criterion criterion, const PlainLimits& x, double f,
                                const std::array<double, 4>& c, const PlainSection& l, double elongation) {
  const double A = std::numbers::pi * 0.01, J = std::numbers::pi * 0.0016 / 64, r = 0.1,
               N = std::max(l.N, 0.0);
  switch (criterion) {
    case Criterion::none: return 0;
    case Criterion::stress:
      return std::max((l.N / A + l.M_b * r / J) / (f * x[0]),
                      (l.V / A + std::abs(l.M_t) * r / (2 * J)) / (f * x[1]));
    case Criterion::fibre:
      return std::max((l.N / A + l.M_e * r / J) / (f * x[0]),
                      (4 * l.V / (3 * A) + std::abs(l.M_t) * r / (2 * J)) / (f * x[1]));
    case Criterion::mohr_coulomb: {
      const double tau = l.V / A + std::abs(l.M_t) * r / (2 * J), strength = f * x[1] - l.N / A * x[2];
      return std::max(N / A / (f * x[0]), strength > 0 ? tau / strength : 1e300);
    }
    case Criterion::linear: return (N / x[0] + l.V / x[1] + l.M_b / x[2] + std::abs(l.M_t) / x[3]) / f;
    case Criterion::quadratic:
      return (sq(N / x[0]) + sq(l.V / x[1]) + sq(l.M_b / x[2]) + sq(l.M_t / x[3])) / (f * f);
    case Criterion::energy:
      return (N * N / (2 * c[0] * x[0]) +
              (sq(l.V) / c[1] + sq(l.M_b) / c[2] + sq(l.M_t) / c[3]) / (2 * x[1])) /
             (f * f);
    case Criterion::elongation: return elongation / (f * x[0]);
  }
  return 0;
}

inline Strength strength_of(Criterion criterion, const PlainLimits& x) {
  const Section s = circle(0.2);
  switch (criterion) {
    case Criterion::none: return {};
    case Criterion::stress: return stress_strength(s, x[0], x[1]);
    case Criterion::fibre: return fibre_strength(s, x[0], x[1]);
    case Criterion::mohr_coulomb: return mohr_coulomb_strength(s, x[1], x[2], x[0]);
    case Criterion::linear: return linear_strength(x[0], x[1], x[2], x[3]);
    case Criterion::quadratic: return quadratic_strength(x[0], x[1], x[2], x[3]);
    case Criterion::energy: return energy_strength(x[0], x[1]);
    case Criterion::elongation: return elongation_strength(x[0]);
  }
  return {};
}

/// Limits that bodies of the campaigns reach now and then.
inline void draw_limits(Criterion criterion, Dice& dice, PlainLimits& x) {
  switch (criterion) {
    case Criterion::stress:
    case Criterion::fibre: x[0] = dice(2, 20), x[1] = dice(1, 10); break;
    case Criterion::mohr_coulomb: x[0] = dice(1, 5), x[1] = dice(0.5, 3), x[2] = dice(0, 1); break;
    case Criterion::energy: x[0] = dice(5e-4, 5e-3), x[1] = dice(2e-4, 2e-3); break;
    case Criterion::elongation: x[0] = dice(0.03, 0.15); break;
    default: x[0] = dice(0.05, 0.3), x[1] = dice(0.01, 0.1), x[2] = dice(2e-3, 2e-2), x[3] = dice(1e-3, 1e-2);
  }
}

}  // namespace vbond::testing
