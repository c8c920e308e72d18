// Which bonds are looked at, and what their range is then: at both ends, either way round.
#include "vbond/physics/laws.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "random_pose.hpp"

namespace vbond::range_test {
namespace {

const VModel<double> v_model{1.0, 0.0, 0.0, 1.0, -0.005, 0.015, 1.0 / 480};
const Evm<double> evm = Evm<double>::from(stiffness(v_model), 1.0, 0.0, 0.0);

/// A bond of this length along x, its ends turned.
BondPose<double> bond(double length, const Vec3d& turn_i, const Vec3d& turn_j) {
  const Vec3d e{1, 0, 0}, n2{0, 1, 0}, n3{0, 0, 1};
  const Quatd q_i = rotation_of(turn_i), q_j = rotation_of(turn_j);
  return {length * e,
          {rotate(q_i, e), rotate(q_i, n2), rotate(q_i, n3)},
          {rotate(q_j, -e), rotate(q_j, n2), rotate(q_j, n3)}};
}
BondPose<double> bond(const Vec3d& turn_i, const Vec3d& turn_j) {
  return bond(1.0, turn_i, turn_j);
}
double degrees(double d) {
  return d * M_PI / 180.0;
}
bool is_looked_at(const BondPose<double>& pose, double a = 1.0) {
  return needs_look(bond_tilt(pose, 0.0, 0.0), a);
}
BondRange range(const auto& law, const BondPose<double>& pose) {
  return bond_range(law, bond_shape(pose, 0.0, 0.0));
}

TEST(BondRange, IsThatOfTheWorseEnd) {
  for (const double sign : {1.0, -1.0}) {
    const Vec3d little{0, 0, sign * degrees(44)}, much{0, sign * degrees(46), 0},
        past{0, 0, sign * degrees(91)};
    EXPECT_EQ(range(v_model, bond(little, little)), BondRange::good);
    EXPECT_EQ(range(v_model, bond(little, much)), BondRange::strained);
    EXPECT_EQ(range(v_model, bond(much, little)), BondRange::strained);
    EXPECT_EQ(range(v_model, bond({}, past)), BondRange::snapped);
    EXPECT_EQ(range(v_model, bond(past, {})), BondRange::snapped);
    EXPECT_EQ(range(evm, bond(much, little)), BondRange::good);
    EXPECT_EQ(range(evm, bond({}, past)), BondRange::strained);
    EXPECT_EQ(range(evm, bond(past, {})), BondRange::strained);
  }
}

// Also by a twist alone, either way.
TEST(BondRange, OfTwistIsTheSameEitherWay) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(range(v_model, bond({}, {sign * degrees(44), 0, 0})), BondRange::good);
    EXPECT_EQ(range(v_model, bond({}, {sign * degrees(46), 0, 0})), BondRange::strained);
    EXPECT_EQ(range(v_model, bond({sign * degrees(91), 0, 0}, {})), BondRange::snapped);
    EXPECT_EQ(range(evm, bond({sign * degrees(91), 0, 0}, {})), BondRange::strained);
  }
}

// 45 degrees is the first limit of all; a little before it the look begins.
TEST(NeedsLook, BeginsJustBeforeTheFirstLimitOfEachDeformation) {
  for (const double sign : {1.0, -1.0}) {
    for (const Vec3d& axis : {Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
      EXPECT_FALSE(is_looked_at(bond(sign * degrees(44.7) * axis, {})));
      EXPECT_TRUE(is_looked_at(bond(sign * degrees(44.8) * axis, {})));
      EXPECT_FALSE(is_looked_at(bond({}, sign * degrees(44.7) * axis)));
      EXPECT_TRUE(is_looked_at(bond({}, sign * degrees(44.8) * axis)));
    }
    EXPECT_FALSE(is_looked_at(bond({}, {sign * degrees(44.7), 0, 0})));
    EXPECT_TRUE(is_looked_at(bond({}, {sign * degrees(44.8), 0, 0})));
    EXPECT_TRUE(is_looked_at(bond({}, {sign * degrees(150), 0, 0})));
  }
  EXPECT_FALSE(is_looked_at(bond(1.04, {}, {}), 2.0));
  EXPECT_TRUE(is_looked_at(bond(1.0, {}, {}), 2.0));
  EXPECT_TRUE(is_looked_at(bond(std::numeric_limits<double>::quiet_NaN(), {}, {})));
}

TEST(NeedsLook, MissesNoBondThatIsOutOfTheGoodRange) {
  testing::PoseSource source(11);
  int good = 0, looked_at = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const BondPose<double> pose = source.pair(1.0, 0.3, 1.0).pose();
    const bool look = is_looked_at(pose);
    const bool is_good = range(v_model, pose) == BondRange::good && range(evm, pose) == BondRange::good;
    EXPECT_TRUE(look || is_good);
    good += is_good, looked_at += look;
  }
  // few are looked at in vain: those within half a degree of a limit
  EXPECT_GT(good, 4000);
  EXPECT_LT(looked_at, 1.05 * (20000 - good));
}

}  // namespace
}  // namespace vbond::range_test
