#include "vbond/physics/break_mode.hpp"

#include <gtest/gtest.h>

namespace vbond {
namespace {

const Section section = circle(0.2);

BreakMode mode(const Strength& s, const Failure<double>& f, double N = 0) {
  return break_cause(s, f, N, 1.0).mode;
}

// tension, shear, bending, torsion, compression, utilisation
TEST(BreakMode, IsTheLargestShareOfTheStressThatGoverns) {
  for (const Strength& s :
       {stress_strength(section, 2.0, 3.0, 1.0, 5.0), fibre_strength(section, 2.0, 3.0, 5.0)}) {
    EXPECT_EQ(mode(s, {0.6, 0.1, 0.4, 0.8, 0, 1.0}), BreakMode::tension);
    EXPECT_EQ(mode(s, {-0.2, 0.1, 1.2, 0.8, 0.3, 1.0}), BreakMode::bending);
    EXPECT_EQ(mode(s, {0.9, 0.6, 0.0, 0.4, 0, 1.0}), BreakMode::shear);
    EXPECT_EQ(mode(s, {0.9, 0.3, 0.0, 0.7, 0, 1.0}), BreakMode::torsion);
    EXPECT_EQ(mode(s, {-0.9, 0.3, 0.5, 0.6, 1.1, 1.1}), BreakMode::compression);
    EXPECT_EQ(break_cause(s, {0.6, 0.1, 0.4, 0.8, 0, 1.0}, 0.0, 0.5).limit, 0.5 * 2.0);
    EXPECT_EQ(break_cause(s, {0.9, 0.6, 0.0, 0.4, 0, 1.0}, 0.0, 0.5).limit, 0.5 * 3.0);
    EXPECT_EQ(break_cause(s, {-0.9, 0.3, 0.5, 0.6, 1.1, 1.1}, 0.0, 0.5).limit, 0.5 * 5.0);
  }
}

// The shear strength of Mohr and Coulomb is c - (N/A) tan phi, with the factor of the bond on c alone: it is
// that of all its strengths, and not of the load.
TEST(BreakMode, ShearLimitOfMohrCoulombHasItsFriction) {
  const double c = 3.0, tan_phi = 0.5, factor = 2.0, sigma = -1.0;
  const Strength s = mohr_coulomb_strength(section, c, tan_phi, 10.0);
  const BreakCause slid = break_cause(s, {0, 0.3, 0, 0.7, 0, 1.0}, sigma * section.A, factor);
  EXPECT_EQ(slid.mode, BreakMode::torsion);
  EXPECT_NEAR(slid.limit, factor * c - sigma * tan_phi, 1e-14);
  const BreakCause pulled = break_cause(s, {1.0, 0.3, 0, 0.2, 0, 1.0}, 1.0, factor);
  EXPECT_EQ(pulled.mode, BreakMode::tension);
  EXPECT_EQ(pulled.limit, factor * 10.0);
}

TEST(BreakMode, OfASumIsItsLargestTerm) {
  for (const Strength& s :
       {linear_strength(1, 1, 1, 1), quadratic_strength(1, 1, 1, 1), energy_strength(1, 1)}) {
    EXPECT_EQ(mode(s, {0.4, 0.3, 0.2, 0.1, 0, 1.0}), BreakMode::tension);
    EXPECT_EQ(mode(s, {0.3, 0.4, 0.2, 0.1, 0, 1.0}), BreakMode::shear);
    EXPECT_EQ(mode(s, {0.2, 0.3, 0.4, 0.1, 0, 1.0}), BreakMode::bending);
    EXPECT_EQ(mode(s, {0.1, 0.2, 0.3, 0.4, 0, 1.0}), BreakMode::torsion);
    EXPECT_EQ(break_cause(s, {0.4, 0.3, 0.2, 0.1, 0, 1.0}, 0.0, 1.0).limit, 0.0);
  }
  EXPECT_EQ(mode(elongation_strength(0.1), {1, 0, 0, 0, 0, 1}), BreakMode::tension);
  EXPECT_EQ(mode({}, {0, 0, 0, 0, 0, 1}), BreakMode::other);
}

}  // namespace
}  // namespace vbond
