#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "random_pose.hpp"
#include "vbond/physics/bond_step.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {
namespace {

const Material glue{3.2, 0.2};
const Section round_bond = circle(0.2);

// The paper's closed forms, [KA12] eqs. (22), (30), (37), against the one inverse that the code uses.
// Both sides are a dozen operations: 1e-14 relative is rounding.
TEST(Calibration, BernoulliEulerGivesThePapersClosedForm) {
  for (const double a : {0.3, 1.0, 2.5}) {
    const VModel<double> m = VModel<double>::from(bernoulli_euler(glue, round_bond, a), a, 0.0, 0.0);
    const double EJ = glue.E * round_bond.J;
    EXPECT_NEAR(m.B1, glue.E * round_bond.A / a, 1e-14 * m.B1);
    EXPECT_NEAR(m.B2, -2.0 * EJ / a, 1e-14 * std::abs(m.B2));
    EXPECT_NEAR(m.B3, 6.0 * EJ / a, 1e-14 * m.B3);
    EXPECT_NEAR(m.B4, glue.G() * round_bond.J_p / a, 1e-14 * m.B4);
  }
}

TEST(Calibration, TimoshenkoGivesThePapersClosedForm) {
  const double kappa = hutchinson_circle(glue.nu), EJ = glue.E * round_bond.J;
  for (const double a : {0.1, 0.3, 1.0}) {
    const VModel<double> m = VModel<double>::from(timoshenko(glue, round_bond, a, kappa), a, 0.1, 0.2);
    const double kAa2 = kappa * round_bond.A * a * a, J12 = 12.0 * round_bond.J * (1.0 + glue.nu);
    EXPECT_NEAR(m.B2, -2.0 * EJ * (kAa2 - J12) / (a * (kAa2 + 2.0 * J12)), 1e-13 * m.B3);
    EXPECT_NEAR(m.B3, 6.0 * kappa * round_bond.A * EJ * a / (kAa2 + 2.0 * J12), 1e-14 * m.B3);
  }
}

TEST(Calibration, ShortCylinderGivesThePapersClosedForm) {
  const double a = 0.1, nu = glue.nu;
  const VModel<double> m = VModel<double>::from(short_cylinder(glue, round_bond, a), a, 0.0, 0.0);
  EXPECT_NEAR(m.B1, (1 - nu) * glue.E * round_bond.A / ((1 + nu) * (1 - 2 * nu) * a), 1e-14 * m.B1);
  EXPECT_NEAR(m.B2, glue.G() * (2 * (1 - nu) / (1 - 2 * nu) * round_bond.J / a - round_bond.A * a / 4),
              1e-14 * m.B3);
  EXPECT_NEAR(m.B3, glue.G() * round_bond.A * a / 2, 1e-14 * m.B3);
}

TEST(Calibration, PapersRodHasThePapersParameters) {
  // E a / c_A = 4 / pi (a / d_b)^2, [KA12] eq. (42)
  const Material m{4.0 / M_PI * 25.0, 0.2};
  const VModel<double> b = VModel<double>::from(bernoulli_euler(m, circle(0.2), 1.0), 1.0, 0.0, 0.0);
  EXPECT_NEAR(b.B1, 1.0, 1e-15);
  EXPECT_NEAR(b.B2, -0.005, 1e-16);
  EXPECT_NEAR(b.B3, 0.015, 1e-16);
  EXPECT_NEAR(b.B4, 0.00208333333333333333, 1e-17);
}

TEST(Calibration, TimoshenkoTendsToBernoulliEulerForLargeShearCoefficient) {
  const BondStiffness<double> t = timoshenko(glue, round_bond, 1.0, 1e12),
                              b = bernoulli_euler(glue, round_bond, 1.0);
  EXPECT_NEAR(t.c_D / b.c_D, 1.0, 1e-12);
}

TEST(Calibration, HutchinsonsCoefficientHasItsPublishedValues) {
  EXPECT_NEAR(hutchinson_circle(0.0), 0.857143, 5e-7);  // six digits are published
  EXPECT_NEAR(hutchinson_circle(0.2), 0.903766, 5e-7);
  EXPECT_NEAR(hutchinson_circle(0.3), 0.925182, 5e-7);
}

TEST(Calibration, AnnulusIsTheDifferenceOfTwoCircles) {
  const Section s = annulus(0.2, 0.1);
  EXPECT_NEAR(s.A, M_PI / 4 * (0.04 - 0.01), 1e-16);
  EXPECT_NEAR(s.J, M_PI / 64 * (0.0016 - 0.0001), 1e-18);
  EXPECT_NEAR(s.J_p, 2 * s.J, 1e-18);
}

/// Stiffnesses measured on the loads themselves by small displacements, for any attachment.
template <class Law>
BondStiffness<double> measured(const Law& law) {
  const double h = 1e-6, L = law.a + law.R_i + law.R_j;
  const auto loads = [&](const Vec3d& u_j, const Vec3d& phi_i, const Vec3d& phi_j) {
    const Vec3d e{1, 0, 0}, n2{0, 1, 0}, n3{0, 0, 1};
    const Quatd qi = rotation_of(phi_i), qj = rotation_of(phi_j);
    return bond_loads(law, BondPose<double>{L * e + u_j,
                                            {rotate(qi, e), rotate(qi, n2), rotate(qi, n3)},
                                            {rotate(qj, -e), rotate(qj, n2), rotate(qj, n3)}});
  };
  const Vec3d z{};
  BondStiffness<double> c{};
  c.c_A = (loads({h, 0, 0}, z, z).F.x - loads({-h, 0, 0}, z, z).F.x) / (2 * h);
  c.c_D = (loads({0, h, 0}, z, z).F.y - loads({0, -h, 0}, z, z).F.y) / (2 * h);
  c.c_T = (loads(z, z, {h, 0, 0}).M_ij.x - loads(z, z, {-h, 0, 0}).M_ij.x) / (2 * h);
  // both ends turned the opposite way about the middle of the bond: no shear, pure bending
  const auto bend = [&](double t) {
    const double drop = 0.5 * law.a + law.R_j, rise = 0.5 * law.a + law.R_i;
    return loads({0, t * (drop - rise), 0}, {0, 0, -t}, {0, 0, t}).M_ij.z;
  };
  c.c_B = (bend(h) - bend(-h)) / (4 * h);
  return c;
}

template <class Law, class Make>
void expect_any_stiffness_is_matched(Make make) {
  testing::PoseSource random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const BondStiffness<double> c{random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.1, 2),
                                  random.uniform(0.1, 2)};
    const Law law = make(c, random.uniform(0.2, 1.5), random.uniform(0, 0.5), random.uniform(0, 0.5));
    const BondStiffness<double> m = measured(law), s = stiffness(law);
    // central differences: h^2 times third derivatives (of order 10) plus rounding 1e-16 / h
    const double tolerance = 2e-9;
    EXPECT_NEAR(m.c_A, c.c_A, tolerance);
    EXPECT_NEAR(m.c_D, c.c_D, tolerance);
    EXPECT_NEAR(m.c_B, c.c_B, tolerance);
    EXPECT_NEAR(m.c_T, c.c_T, tolerance);
    EXPECT_NEAR(s.c_B, c.c_B, 1e-14);
    EXPECT_NEAR(s.c_D, c.c_D, 1e-14);
  }
}

TEST(VModelCalibration, MatchesAnyFourStiffnessesExactly) {
  expect_any_stiffness_is_matched<VModel<double>>(
      [](const auto& c, double a, double R_i, double R_j) { return VModel<double>::from(c, a, R_i, R_j); });
}
TEST(EvmCalibration, MatchesAnyFourStiffnessesExactly) {
  expect_any_stiffness_is_matched<Evm<double>>(
      [](const auto& c, double a, double R_i, double R_j) { return Evm<double>::from(c, a, R_i, R_j); });
}

TEST(ElementBound, OfThePapersRodIsTheReferenceValue) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/statics.json");
  const auto limits = nlohmann::json::parse(file)["stability_limits"];
  const BondStiffness<double> c = stiffness(VModel<double>{1, 0, 0, 1, -0.005, 0.015, 1.0 / 480});
  const BondEnd inner{2, 1, 0.064, 0.5};
  const double T_0 = 2 * M_PI, dt = critical_step(element_bound(c, inner, inner)) / T_0;
  EXPECT_NEAR(dt, limits["element_bound_rod"].get<double>(), 1e-14);
  EXPECT_LT(dt, limits["rod_free_dt_over_T0"].get<double>());  // a bound from below of the true limit
  EXPECT_LT(dt, limits["rod_pinned_dt_over_T0"].get<double>());
}

}  // namespace
}  // namespace vbond
