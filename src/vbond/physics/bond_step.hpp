#pragma once
#include <algorithm>
#include <cmath>

#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// One end of a bond as the step bound sees it.
struct BondEnd {
  double n;      ///< number of bonds of this particle
  double m;      ///< mass
  double Theta;  ///< moment of inertia
  double lever;  ///< l = R + a/2: centre of the particle to the middle of the bond
};

/// Largest squared angular frequency that one undeformed bond can contribute when every particle's
/// mass and inertia are shared evenly among its bonds: the maximum over bonds bounds the whole body
/// (element-by-element bound; the body's own largest eigenvalue is never above it).  [1/time^2]
inline double element_bound(const BondStiffness<double>& c, const BondEnd& i, const BondEnd& j) {
  const double per_m = i.n / i.m + j.n / j.m;
  const double per_Theta = i.n / i.Theta + j.n / j.Theta;
  const double g11 = c.c_B * per_Theta;
  const double g22 = c.c_D * (per_m + sq(i.lever) * i.n / i.Theta + sq(j.lever) * j.n / j.Theta);
  const double g12 = std::sqrt(c.c_B * c.c_D) * (i.lever * i.n / i.Theta - j.lever * j.n / j.Theta);
  const double shear_bending = 0.5 * (g11 + g22) + std::hypot(0.5 * (g11 - g22), g12);
  return std::max({c.c_A * per_m, c.c_T * per_Theta, shear_bending});
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
                            const BondEnd& j) {
  const double elastic = element_bound(c, i, j);
  if (g.c_A == 0.0 && g.c_D == 0.0 && g.c_B == 0.0 && g.c_T == 0.0) return elastic;
  const auto stable = [&](double dt) {
    const double h = 2.0 / dt;
    const BondStiffness<double> both{c.c_A + h * g.c_A, c.c_D + h * g.c_D, c.c_B + h * g.c_B,
                                     c.c_T + h * g.c_T};
    return sq(dt) * element_bound(both, i, j) <= 4.0;
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
