#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// One end of a bond as the step bound sees it.
struct BondEnd {
  double n;                 ///< number of bonds of this particle
  double m;                 ///< mass
  double Theta;             ///< moment of inertia
  double lever;             ///< l = R + a/2: centre of the particle to the middle of the bond
  double o_2 = 0, o_3 = 0;  ///< offset of that middle along n_2 and n_3
  bool is_offset() const { return o_2 != 0.0 || o_3 != 0.0; }
};

/// The same bound for ends that are offset: above all eigenvalues of G = sqrt(C) B M^-1 B^T sqrt(C), where
/// the six rows of B are how fast the bond stretches, is sheared along n_2 and n_3, is bent about n_2 and
/// n_3, and is twisted by the motion of both particles. The largest sum of a row of G, or the root of the sum
/// of all its squares if that is smaller.  [1/time^2]
inline double element_bound_with_offsets(const BondStiffness<double>& c, const BondEnd& i, const BondEnd& j) {
  struct Row {
    double v[3], w[3];  // of what moves along and turns about n_1, n_2, n_3
  };
  // v + w x s at the middle of the bond, which is s from the centre: (lever, o_2, o_3), of j (-lever, ..)
  const auto rows = [](const BondEnd& e, double sign) {
    const double l = -sign * e.lever;
    return std::array<Row, 6>{{{{sign, 0, 0}, {0, sign * e.o_3, -sign * e.o_2}},
                               {{0, sign, 0}, {-sign * e.o_3, 0, sign * l}},
                               {{0, 0, sign}, {sign * e.o_2, -sign * l, 0}},
                               {{0, 0, 0}, {0, sign, 0}},
                               {{0, 0, 0}, {0, 0, sign}},
                               {{0, 0, 0}, {sign, 0, 0}}}};
  };
  const std::array<Row, 6> of_i = rows(i, -1.0), of_j = rows(j, 1.0);
  const std::array<double, 6> root{std::sqrt(c.c_A), std::sqrt(c.c_D), std::sqrt(c.c_D),
                                   std::sqrt(c.c_B), std::sqrt(c.c_B), std::sqrt(c.c_T)};
  double largest_row = 0.0, squares = 0.0;
  for (std::size_t r = 0; r < 6; ++r) {
    double row = 0.0;
    for (std::size_t s = 0; s < 6; ++s) {
      double g = 0.0;
      for (std::size_t d = 0; d < 3; ++d)
        g += i.n / i.m * of_i[r].v[d] * of_i[s].v[d] + j.n / j.m * of_j[r].v[d] * of_j[s].v[d] +
             i.n / i.Theta * of_i[r].w[d] * of_i[s].w[d] + j.n / j.Theta * of_j[r].w[d] * of_j[s].w[d];
      g *= root[r] * root[s];
      row += std::abs(g), squares += g * g;
    }
    largest_row = std::max(largest_row, row);
  }
  return std::min(largest_row, std::sqrt(squares));
}

/// What a straight bond bears as it stands.
struct Pull {
  double N = 0;  ///< tension  [force]
  double D = 1;  ///< length between the bonded points  [length], > 0
};

/// Above the squared frequency that the force alone brings about, beside all stiffness: it holds the bond
/// straight by N/D, and each of its arms p by N p. A push takes away from stiffness, but where arms are
/// offset.  [1/time^2]
inline double pull_bound(const Pull& pull, const BondEnd& i, const BondEnd& j) {
  const double N = i.is_offset() || j.is_offset() ? std::abs(pull.N) : std::max(pull.N, 0.0);
  if (N == 0.0) return 0.0;
  const auto arm = [&](const BondEnd& e) { return std::hypot(e.lever - 0.5 * pull.D, e.o_2, e.o_3); };
  const double p_i = arm(i), p_j = arm(j), turns_i = p_i * i.n / i.Theta, turns_j = p_j * j.n / j.Theta;
  return N * ((i.n / i.m + j.n / j.m + p_i * turns_i + p_j * turns_j) / pull.D + std::max(turns_i, turns_j));
}

/// Largest squared angular frequency that one straight bond can contribute when every particle's
/// mass and inertia are shared evenly among its bonds: the maximum over bonds bounds the whole body
/// (element-by-element bound; the body's own largest eigenvalue is never above it).  [1/time^2]
inline double element_bound(const BondStiffness<double>& c, const BondEnd& i, const BondEnd& j,
                            const Pull& pull = {}) {
  if (i.is_offset() || j.is_offset()) return element_bound_with_offsets(c, i, j) + pull_bound(pull, i, j);
  const double per_m = i.n / i.m + j.n / j.m;
  const double per_Theta = i.n / i.Theta + j.n / j.Theta;
  const double g11 = c.c_B * per_Theta;
  const double g22 = c.c_D * (per_m + sq(i.lever) * i.n / i.Theta + sq(j.lever) * j.n / j.Theta);
  const double g12 = std::sqrt(c.c_B * c.c_D) * (i.lever * i.n / i.Theta - j.lever * j.n / j.Theta);
  const double shear_bending = 0.5 * (g11 + g22) + std::hypot(0.5 * (g11 - g22), g12);
  return std::max({c.c_A * per_m, c.c_T * per_Theta, shear_bending + pull_bound(pull, i, j)});
}

/// 4/dt^2 at the largest dt with dt^2 (k + 2 g/dt) <= 4: the bound of a motion of squared frequency k > 0
/// that is damped at the rate g >= 0 by rates of the last half step.  [1/time^2], [1/time]
inline double damped_bound(double k, double g) {
  const double dt = 4.0 / (g + std::sqrt(sq(g) + 4.0 * k));
  return g == 0.0 ? k : 4.0 / sq(dt);
}

/// The same for a bond that damps by rates of the last half step, g its slopes at rest: 4/dt^2 at the largest
/// dt with dt^2 lambda(c + 2 g/dt) <= 4, which keeps 4 M - 2 dt C - dt^2 K positive.  [1/time^2]
inline double element_bound(const BondStiffness<double>& c, const BondStiffness<double>& g, const BondEnd& i,
                            const BondEnd& j, const Pull& pull = {}) {
  const double elastic = element_bound(c, i, j, pull);
  if (g.c_A == 0.0 && g.c_D == 0.0 && g.c_B == 0.0 && g.c_T == 0.0) return elastic;
  const auto stable = [&](double dt) {
    const double h = 2.0 / dt;
    const BondStiffness<double> both{c.c_A + h * g.c_A, c.c_D + h * g.c_D, c.c_B + h * g.c_B,
                                     c.c_T + h * g.c_T};
    return sq(dt) * element_bound(both, i, j, pull) <= 4.0;
  };
  // damping alone allows dt = 2 / lambda(g): the least of both bounds is stable but for a factor
  double low = 0.25 / (std::sqrt(elastic) + element_bound(g, i, j)), high = 16.0 * low;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return 4.0 / sq(low);
}

/// The step above which leap-frog is unstable for a system whose largest squared frequency is lambda.
inline double critical_step(double lambda) {
  return 2.0 / std::sqrt(lambda);
}

}  // namespace vbond
