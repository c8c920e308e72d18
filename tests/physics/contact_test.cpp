#include <gtest/gtest.h>

#include <cmath>

#include "vbond/core/dual.hpp"
#include "vbond/physics/hertz.hpp"

namespace vbond {
namespace {

TEST(HertzContact, ForceIsTheSlopeOfTheEnergyAndStiffnessTheSlopeOfTheForce) {
  using D1 = Dual<1>;
  const HertzContact<double> h{1.7};
  for (const double delta : {1e-6, 0.01, 0.3}) {
    const D1 overlap = D1::variable(delta, 0);
    const D1 U = contact_energy(HertzContact<D1>{h.k}, overlap);
    const D1 f = contact_force(HertzContact<D1>{h.k}, overlap);
    EXPECT_NEAR(U.d[0], contact_force(h, delta), 1e-15 * (1 + h.k));
    EXPECT_NEAR(f.d[0], contact_stiffness(h, delta), 1e-15 * (1 + h.k));
  }
}

TEST(HertzContact, SecantGivesTheSameForceAndEnergy) {
  constexpr double rounding = 4e-16;  // of four products
  for (const double delta : {1e-6, 0.01, 0.3}) {
    const HertzContact<double> h = hertz(2.5, 0.4, 0.7);
    const double s = contact_secant(h, delta), F = contact_force(h, delta), U = contact_energy(h, delta);
    EXPECT_NEAR(s * delta, F, rounding * F);
    EXPECT_NEAR(energy_of_secant(s, delta), U, rounding * U);
    EXPECT_NEAR(hertz_secant(2.5, std::sqrt(reduced_radius(0.4, 0.7) * delta)), s, 2.0 * rounding * s);
  }
}

TEST(HertzContact, OfTwoEqualSpheresHasTheTextbookStiffness) {
  // R* = R/2, E* = E / (2 (1 - nu^2)): k = 4/3 E* sqrt(R*)
  EXPECT_NEAR(hertz(3.0, 0.25, 0.5, 0.5).k, 4.0 / 3.0 * 1.6 * 0.5, 1e-15);
}

TEST(HertzContact, OfASmallSphereOnALargeOneHasTheTextbookStiffness) {
  // 1/R* = 1/R_i + 1/R_j: R* = 3/4 for radii 1 and 3 (their mean over two would be 1), R for R against a
  // plane
  EXPECT_NEAR(hertz(3.0, 0.25, 1.0, 3.0).k, 4.0 / 3.0 * 1.6 * std::sqrt(0.75), 1e-15);
  EXPECT_EQ(hertz(3.0, 0.25, 3.0, 1.0).k, hertz(3.0, 0.25, 1.0, 3.0).k);
  EXPECT_NEAR(hertz(3.0, 0.25, 0.25, 1e16).k, 4.0 / 3.0 * 1.6 * 0.5, 1e-15);
}

TEST(PapersHertz, HasThePapersForm) {
  // F = c_H / sqrt(a) (2R - r)^(3/2) with c_H = 2, a = 4, overlap 0.25
  EXPECT_NEAR(contact_force(paper_hertz(2.0, std::sqrt(4.0)), 0.25), 2.0 / 2.0 * 0.125, 1e-16);
}

}  // namespace
}  // namespace vbond
