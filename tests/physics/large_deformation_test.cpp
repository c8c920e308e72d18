// Closed forms of model theory for one bond far from rest.
#include <gtest/gtest.h>

#include <cmath>

#include "vbond/core/quat.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {
namespace {

const VModel<double> slender{1.0, 0.0, 0.0, 1.0, -0.005, 0.015, 1.0 / 480};

BondPose<double> turned(const Vec3d& phi_i, const Vec3d& phi_j) {
  const Quatd qi = rotation_of(phi_i), qj = rotation_of(phi_j);
  const Vec3d e{1, 0, 0}, n2{0, 1, 0}, n3{0, 0, 1};
  return {
      e, {rotate(qi, e), rotate(qi, n2), rotate(qi, n3)}, {rotate(qj, -e), rotate(qj, n2), rotate(qj, n3)}};
}
double degrees(double d) {
  return d * M_PI / 180.0;
}

TEST(VModelTwist, TorqueIsHalfB4TimesSineOfTwiceTheAngle) {
  for (const double t : {1.0, 10.0, 30.0, 45.0, 60.0, 90.0, 120.0}) {
    const BondLoads<double> l = bond_loads(slender, turned({}, {degrees(t), 0, 0}));
    EXPECT_NEAR(l.M_ij.x, 0.5 * slender.B4 * std::sin(2 * degrees(t)), 1e-17);
  }
}

// The torsion term adds O(B4 t^3): B4 (t/2)^3 is its size at each end, 2 its largest numerical factor.
TEST(VModelBending, SymmetricMomentFollowsTheClosedForm) {
  for (const double t : {5.0, 10.0, 30.0}) {
    const double half = 0.5 * degrees(t);
    const BondLoads<double> l = bond_loads(slender, turned({0, 0, -half}, {0, 0, half}));
    const double expected = 0.5 * slender.B3 * std::sin(2 * half) + 0.5 * slender.B2 * std::sin(4 * half);
    EXPECT_NEAR(l.M_ij.z, expected, 2 * slender.B4 * half * half * half) << t << " degrees";
  }
}

TEST(EvmMoments, AreTheVModelsAtHalfTheAngleRelativeToLinear) {
  const BondStiffness<double> c = stiffness(slender);
  const Evm<double> evm = Evm<double>::from(c, 1.0, 0.0, 0.0);
  for (const double t : {10.0, 45.0, 90.0}) {
    const double twist = degrees(t);
    const BondLoads<double> e = bond_loads(evm, turned({}, {twist, 0, 0}));
    const BondLoads<double> v = bond_loads(slender, turned({}, {0.5 * twist, 0, 0}));
    EXPECT_NEAR(e.M_ij.x / (c.c_T * twist), v.M_ij.x / (c.c_T * 0.5 * twist), 1e-14);
  }
}

// A turn by 180 degrees about any of the three bond axes is a wrong rest state: this is the model, not an
// error.
TEST(VModel, IsBlindToHalfTurnsOfEitherParticle) {
  for (const Vec3d& half_turn : {Vec3d{M_PI, 0, 0}, Vec3d{0, M_PI, 0}, Vec3d{0, 0, M_PI}}) {
    const BondPose<double> pose = turned({}, half_turn);
    const BondEnergy<double> u = bond_energy(slender, pose);
    EXPECT_NEAR(u.U_L + u.U_B + u.U_T, 0.0, 1e-17);
    EXPECT_EQ(bond_range(slender, bond_shape(pose, 0, 0)), BondRange::snapped);
    const BondEnergy<double> w = bond_energy(Evm<double>::from(stiffness(slender), 1.0, 0.0, 0.0), pose);
    EXPECT_GT(w.U_L + w.U_B + w.U_T, 1e-3);  // the EVM is not
  }
}

TEST(BondShape, GivesTwistAndBendWithTheirSigns) {
  const BondShape s = bond_shape(turned({0.1, 0, 0}, {0.5, 0, 0}), 0, 0);
  EXPECT_NEAR(s.twist, 0.4, 1e-15);
  EXPECT_NEAR(s.bend, 0.0, 1e-8);  // acos-like near zero: root of rounding
  const BondShape b = bond_shape(turned({0, 0, -0.2}, {0, 0, 0.3}), 0, 0);
  EXPECT_NEAR(b.bend, 0.5, 1e-15);
  EXPECT_NEAR(b.c_i, std::cos(0.2), 1e-15);
  EXPECT_NEAR(b.c_j, std::cos(0.3), 1e-15);
}

TEST(BondRange, OfTheEvmHasOneLimitAt90Degrees) {
  const Evm<double> evm = Evm<double>::from(stiffness(slender), 1.0, 0.0, 0.0);
  EXPECT_EQ(bond_range(evm, bond_shape(turned({}, {degrees(89.9), 0, 0}), 0, 0)), BondRange::good);
  EXPECT_EQ(bond_range(evm, bond_shape(turned({}, {degrees(-90.1), 0, 0}), 0, 0)), BondRange::strained);
  EXPECT_EQ(bond_range(evm, bond_shape(turned({0, 0, degrees(89.9)}, {}), 0, 0)), BondRange::good);
  EXPECT_EQ(bond_range(evm, bond_shape(turned({0, 0, degrees(150)}, {}), 0, 0)), BondRange::strained);
}

TEST(BondRange, OfTheVModelHasItsLimitsAt45And90Degrees) {
  EXPECT_EQ(bond_range(slender, bond_shape(turned({}, {degrees(44.9), 0, 0}), 0, 0)), BondRange::good);
  EXPECT_EQ(bond_range(slender, bond_shape(turned({}, {degrees(45.1), 0, 0}), 0, 0)), BondRange::strained);
  EXPECT_EQ(bond_range(slender, bond_shape(turned({}, {degrees(-90.1), 0, 0}), 0, 0)), BondRange::snapped);
  EXPECT_EQ(bond_range(slender, bond_shape(turned({0, 0, degrees(44.9)}, {}), 0, 0)), BondRange::good);
  EXPECT_EQ(bond_range(slender, bond_shape(turned({0, 0, degrees(45.1)}, {}), 0, 0)), BondRange::strained);
  EXPECT_EQ(bond_range(slender, bond_shape(turned({0, 0, degrees(90.1)}, {}), 0, 0)), BondRange::snapped);
}

}  // namespace
}  // namespace vbond
