// Validation cases B1, B2, B3: one bond of the V-model in given poses.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {
namespace {

using testing::number;
using testing::validation_case;
using testing::vector;

/// Two particles on the x axis, one apart, turned by q_i and q_j; n_2 is y, in the plane of bending.
BondPose<double> pose(const Vec3d& r_ij, const Quatd& q_i, const Quatd& q_j) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  return {r_ij,
          {rotate(q_i, x), rotate(q_i, y), rotate(q_i, z)},
          {rotate(q_j, -x), rotate(q_j, y), rotate(q_j, z)}};
}

double radians(double degrees) {
  return degrees * M_PI / 180.0;
}

// The rod's bond of [KA12], in which B2, B3 and B4 all count.
const VModel<double> papers{1.0, 0.0, 0.0, 1.0, -0.005, 0.015, 1.0 / 480.0};

/// What rounding leaves of a load that is a sum of terms as large as the coefficients: ten operations.
double rounding(const VModel<double>& m) {
  return 10 * 2.2e-16 * (m.B1 * (m.a + m.R_i + m.R_j) + std::abs(m.B2) + m.B3 + m.B4);
}

// B1: 60-digit derivatives of the energy. The reference counts energy from infinity, vbond from rest.
TEST(SingleBond, HasTheReferenceEnergyForceAndMomentsInSixStates) {
  const auto& states = validation_case("B1").at("expected");
  ASSERT_EQ(states.size(), 6u);
  for (const auto& s : states) {
    const auto& B = s.at("B");
    const VModel<double> m{number(s.at("a")), number(s.at("Ri")), number(s.at("Rj")), number(B[0]),
                           number(B[1]),      number(B[2]),       number(B[3])};
    const Quatd q_i = testing::quaternion(s.at("quat_i_wxyz_unnormalised")),
                q_j = testing::quaternion(s.at("quat_j_wxyz_unnormalised"));
    BondPose<double> b{vector(s.at("r_ij")), {}, {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d axis = vector(s.at("reference_axes")[k]);
      b.n_i[k] = rotate(q_i, axis);
      b.n_j[k] = rotate(q_j, k == 0 ? -axis : axis);
    }
    const BondEnergy<double> U = bond_energy(m, b);
    const BondLoads<double> l = bond_loads(m, b);
    const double U_rest = -0.5 * m.B2 - m.B3 - 0.5 * m.B4;
    const std::string name = s.at("name");
    EXPECT_NEAR(U.U_L + U.U_B + U.U_T + U_rest, number(s.at("U")), rounding(m)) << name;
    const auto close = [&](const Vec3d& found, const Vec3d& expected) {
      EXPECT_LE(norm(found - expected), 1e-12 * norm(expected) + rounding(m)) << name;
    };
    close(l.F, vector(s.at("F_on_i")));
    close(l.M_ij, vector(s.at("M_on_i")));
    close(l.M_ji, vector(s.at("M_on_j")));
  }
}

// B2: both ends turned by half the angle, centres where the bond keeps its length.
TEST(SingleBond, FollowsTheCurveOfPureBending) {
  for (const auto& row : validation_case("B2").at("expected").at("table")) {
    const double half = 0.5 * radians(number(row.at("Delta_deg"))), M = number(row.at("M"));
    const auto b = pose({1, 0, 0}, rotation_of({0, 0, -half}), rotation_of({0, 0, half}));
    const BondLoads<double> l = bond_loads(papers, b);
    EXPECT_NEAR(l.M_ij.z / M, 1.0, 1e-12) << "Delta = " << row.at("Delta_deg");
    EXPECT_NEAR(l.M_ji.z / M, -1.0, 1e-12) << "Delta = " << row.at("Delta_deg");
    EXPECT_LE(norm(l.F), rounding(papers));
  }
}

// The moment peaks where the reference says: its slope changes sign within 1e-6 degrees.
TEST(SingleBond, HasItsLargestBendingMomentAtTheReferenceAngle) {
  const auto& expected = validation_case("B2").at("expected");
  const double peak = radians(number(expected.at("Delta_at_max_moment_deg")));
  const auto moment = [](double Delta) {
    return bond_loads(papers,
                      pose({1, 0, 0}, rotation_of({0, 0, -Delta / 2}), rotation_of({0, 0, Delta / 2})))
        .M_ij.z;
  };
  EXPECT_NEAR(moment(peak) / number(expected.at("M_max")), 1.0, 1e-12);
  // M is even about its peak to second order: a cubic term of order one shifts this by h^3 M
  const double h = 1e-4;
  EXPECT_NEAR((moment(peak + h) - moment(peak - h)) / (2 * h), 0.0, 10 * h * h * moment(peak));
}

// B3: one end turned about the bond's line.
TEST(SingleBond, FollowsTheCurveOfPureTorsion) {
  for (const auto& row : validation_case("B3").at("expected").at("torsion").at("table")) {
    const double phi = radians(number(row.at("phi_deg"))), T = number(row.at("T"));
    const BondLoads<double> l = bond_loads(papers, pose({1, 0, 0}, {}, rotation_of({phi, 0, 0})));
    EXPECT_NEAR(l.M_ij.x / T, 1.0, 1e-12) << "phi = " << row.at("phi_deg");
    EXPECT_NEAR(l.M_ji.x / T, -1.0, 1e-12) << "phi = " << row.at("phi_deg");
  }
}

// B3: one end moved across the bond's line, neither end turned.
TEST(SingleBond, FollowsTheTableOfShear) {
  for (const auto& row : validation_case("B3").at("expected").at("shear").at("table")) {
    const double y = number(row.at("y_over_a"));
    const BondLoads<double> l = bond_loads(papers, pose({1, y, 0}, {}, {}));
    // Fx holds the difference of a length near 1 and 1: rounding is absolute there
    EXPECT_NEAR(l.F.x, number(row.at("Fx")), 1e-12 * number(row.at("Fx")) + rounding(papers)) << "y = " << y;
    EXPECT_NEAR(l.F.y, number(row.at("Fy")), 1e-12 * number(row.at("Fy")) + y * rounding(papers));
    EXPECT_NEAR(l.M_ij.z / number(row.at("Mi_z")), 1.0, 1e-12) << "y = " << y;
    EXPECT_NEAR(l.M_ji.z / number(row.at("Mi_z")), 1.0, 1e-12) << "y = " << y;
  }
}

}  // namespace
}  // namespace vbond
