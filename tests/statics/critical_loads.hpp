#pragma once
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "bodies.hpp"

namespace vbond::buckling_test {

inline constexpr double eps = std::numeric_limits<double>::epsilon();

/// Pinned at one end; at the other free to move along x and to turn. One turn about x is held.
inline std::vector<Support> pinned(std::size_t N) {
  return {testing::fixed({ParticleId{0}}, {true, true, true, true, false, false}),
          testing::fixed({ParticleId{N - 1}}, {false, true, true, false, false, false})};
}

inline StaticResult critical_loads(const testing::Specimen& s, std::vector<Support> supports,
                                   std::vector<PointLoad> loads, int count, const StaticHooks& hooks = {}) {
  StaticStage stage = testing::static_stage(StageKind::buckling, std::move(supports), std::move(loads));
  stage.count = count;
  return run_static_stage(s.model, stage, s.state, hooks).result;
}

/// Positions are rounded to eps L / 2, so the force of a bond is known to eps L c_A. Stiffnesses c_D / a of
/// the tangent are rounded as well, and in a mode that turns by kappa from bond to bond f kappa^2 / a stands
/// against them. What is left beyond the last look at the path is (3e-6)^2 = 1e-11 of the load.
inline double tolerance(double f, double kappa, double L, double a, const BondStiffness<double>& c) {
  return 1e-11 + eps * (L * c.c_A + a * c.c_D / (kappa * kappa)) / f;
}

/// The same for a rod of N standard bonds.
inline double standard_tolerance(double f, double kappa_L, double N) {
  return tolerance(f, kappa_L / N, 1.0, 1.0 / N, {4e4 * N, 12 * N * N * N, N, N / 1.2});
}

/// Exact critical force of mode q of a pinned rod, R = 0.
inline double exact_force(double q, double bonds, double a, const BondStiffness<double>& c) {
  const double S = std::sin(q * M_PI / (2 * bonds)), C = std::cos(q * M_PI / (2 * bonds));
  const double B3 = 0.5 * c.c_D * a * a, X = 4 * c.c_B * S * S * B3 / (2 * c.c_B * S * S + B3 * C * C);
  return 0.5 * c.c_A * (a - std::sqrt(a * a - 4 * X / c.c_A));
}

}  // namespace vbond::buckling_test
