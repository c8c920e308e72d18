// The faces of cracked cells: when they part, and what slides where they twist or tilt.
#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>
#include <utility>

#include "campaigns/dice.hpp"
#include "cracked.hpp"
#include "vbond/physics/far_from_breaking.hpp"
#include "vbond/physics/vmodel.hpp"
#include "vbond/physics/with_offsets.hpp"

namespace vbond::faces_test {
namespace {

using namespace cracked;

/// Of a pair at rest along x at the distance 1.5: where j has moved by these.
BondPose<double> moved(double gap, double shift) {
  return bond_pose(BondFrames<double>{}, Vec3d{1.5 + gap, shift, 0}, Quatd{}, Quatd{});
}

/// A cell off the middle of its joint, by these along n_2 and n_3.
WithOffsets<WithRubbing<VModel>::Law>::Law<double> cell_at(double o_2, double o_3) {
  auto law = WithOffsets<WithRubbing<VModel>::Law>::Law<double>::from(c, 1.0, 0.3, 0.2);
  law.o_i2 = law.o_j2 = o_2, law.o_i3 = law.o_j3 = o_3;
  law.rules = &rules;
  return law;
}
template <class Law>
double parted(const Law& law, const BondPose<double>& pose) {
  const LawHistory<Law> h = after(law, pose, slipped<Law>(0, 0));
  return utilisation(law, pose, bond_axis(law, pose), loads(law, pose, h), h);
}

// Only the shift of the middle along the faces, or how far that stands open: twist about the axis and depth
// do not part them, and all cells of a joint say the same. Rounding of some ten operations.
TEST(Faces, PartByTheirMiddleAlone) {
  const Vec3d turn{0.4, 0.3, -0.2};
  const BondPose<double> turned = bond_pose(BondFrames<double>{}, Vec3d{1.4, 0.5, 0.3},
                                            rotation_of(Vec3d{0, 0.1, 0.2}), rotation_of(turn));
  const double of_middle = parted(cell_at(0.0, 0.0), turned);
  EXPECT_GT(of_middle, 0.1);
  for (const auto& [o_2, o_3] : {std::pair{0.3, 0.0}, std::pair{-0.2, 0.7}, std::pair{0.0, -5.0}}) {
    EXPECT_NEAR(parted(cell_at(o_2, o_3), turned), of_middle, 1e-13);
    for (const double twist : {0.5, 2.0, -3.0})
      for (const double depth : {0.0, 0.9})
        EXPECT_LT(parted(cell_at(o_2, o_3), bond_pose(BondFrames<double>{}, Vec3d{1.5 - depth, 0, 0}, Quatd{},
                                                      rotation_of(Vec3d{twist, 0, 0}))),
                  1e-25);
  }
}

// Two faces twisted against each other under pressure: the cell rubs along its arc, so that its moment is
// mu N r at any angle, and so is what it dissipates per angle.
TEST(Faces, TwistTakesTheMomentOfFrictionAtItsRadius) {
  const double p = 0.05, r = 0.5, N = c.c_A * p, last = 2.6;
  const auto law = cell_at(0.3, 0.4);
  using Law = std::remove_const_t<decltype(law)>;
  LawHistory<Law> h = slipped<Law>(0, 0);
  const int steps = 1000;
  double lost_before = 0.0;
  for (int k = 1; k <= steps; ++k) {
    const double twist = last * k / steps;
    const BondPose<double> pose =
        bond_pose(BondFrames<double>{}, Vec3d{1.5 - p, 0, 0}, Quatd{}, rotation_of(Vec3d{twist, 0, 0}));
    h = after(law, pose, h);
    if (twist * r < 2.0 * mu * N / c.c_D) continue;  // has not slipped everywhere yet
    const BondLoads<double> l = loads(law, pose, h);
    EXPECT_NEAR(l.M_ij.x, mu * N * r, 1e-13);
    EXPECT_NEAR(l.M_ji.x, -mu * N * r, 1e-13);
    if (lost_before > 0.0) {
      EXPECT_NEAR(h.value[rubbed::dissipated] - lost_before, mu * N * r * last / steps, 1e-14);
    }
    lost_before = h.value[rubbed::dissipated];
  }
  EXPECT_GT(lost_before, 0.5 * mu * N * r * last);
}

// Against the C library in long double, whose difference is right to an ulp of the sine: a few roundings of
// the result where it is a series, of the angle where it is a difference.
TEST(Faces, ArcsAreThoseOfTheSine) {
  for (int k = -1000; k <= 1000; ++k) {
    const double sine = k / 1000.0;
    const auto exact =
        static_cast<double>(std::asin(static_cast<long double>(sine)) - static_cast<long double>(sine));
    const double cosine = std::sqrt((1.0 - sine) * (1.0 + sine));
    const double by_series = 3e-15 * std::abs(exact) + 1.1e-19 * std::abs(sine);
    EXPECT_NEAR(angle_less_sine(sine, cosine), exact, sine * sine > 0.04 ? 1e-15 : by_series) << sine;
  }
}

// What loops leave out is never a bond that breaks: cells anywhere in a joint, intact or cracked, with limits
// of their own.
TEST(Faces, AreFarFromBreakingWhereTheBoundSaysSo) {
  testing::Dice dice(1);
  unsigned broken = 0, left_out = 0;
  for (int k = 0; k < 20000; ++k) {
    BondRules of_joint = rules;
    Strength& limits = of_joint.strength;
    limits.criterion = Criterion::mohr_coulomb, limits.own_section = dice.chance(0.5);
    limits.axial = dice.ratio(0.1, 10), limits.shear = dice.ratio(0.1, 10), limits.friction = dice(0, 3);
    limits.bending = dice.ratio(0.1, 10), limits.torsion = dice.ratio(0.1, 10);
    limits.compression_bending = dice(0, 3);
    auto law = cell_at(dice(-0.5, 0.5), dice(-0.5, 0.5));
    using Law = decltype(law);
    law.rules = &of_joint, law.weakness = dice(-0.5, 1);
    const double size = dice.ratio(1e-3, 1);
    const BondPose<double> pose = bond_pose(BondFrames<double>{}, Vec3d{1.5, 0, 0} + dice.vector(size),
                                            rotation_of(dice.vector(size)), rotation_of(dice.vector(size)));
    const BondAxis<double> axis = bond_axis(law, pose);
    LawHistory<Law> h{};
    if (dice.chance(0.5)) h = slipped<Law>(dice(-0.1, 0.1), dice(-0.1, 0.1));
    const BondLoads<double> l = loads(law, pose, h);
    const bool breaks = utilisation(law, pose, axis, l, h) >= 1.0,
               out = utilisation_bound(law, pose, axis, l, h) < 1.0;
    EXPECT_FALSE(breaks && out) << k;
    broken += breaks ? 1 : 0, left_out += out ? 1 : 0;
  }
  EXPECT_GT(broken, 2000u);
  EXPECT_GT(left_out, 2000u);
}

// The loads that a step works out with the slip are those at the slip.
TEST(Faces, LoadsOfAStepAreThoseAfterIt) {
  testing::Dice dice(2);
  for (int k = 0; k < 1000; ++k) {
    const auto law = cell_at(dice(-0.5, 0.5), dice(-0.5, 0.5));
    using Law = std::remove_const_t<decltype(law)>;
    const BondPose<double> pose = bond_pose(BondFrames<double>{}, Vec3d{1.45, 0, 0} + dice.vector(0.2),
                                            rotation_of(dice.vector(0.5)), rotation_of(dice.vector(0.5)));
    const BondAxis<double> axis = bond_axis(law, pose);
    const LawHistory<Law> before =
        dice.chance(0.3) ? LawHistory<Law>{} : slipped<Law>(dice(-1, 1), dice(-1, 1));
    const auto [now, l] = advance_with_loads(law, pose, axis, BondRates<double>{}, 0.0, before);
    const LawHistory<Law> alone = after(law, pose, before);
    for (std::size_t n = 0; n < rubbed::count; ++n) EXPECT_EQ(now.value[n], alone.value[n]);
    const BondLoads<double> at = loads(law, pose, alone);
    for (const auto& [x, y] : {std::pair{l.F, at.F}, {l.M_ij, at.M_ij}, {l.M_ji, at.M_ji}})
      EXPECT_EQ(norm(x - y), 0.0) << k;
  }
}

// Two grains that roll on each other in opposite ways about their middle: the faces tilt, and do not slide.
TEST(Faces, RollingDoesNotSlide) {
  using Law = WithRubbing<VModel>::Law<double>;
  Law law = Law::from(c, 1.5, 0.0, 0.0);
  law.rules = &rules;
  LawHistory<Law> h = slipped<Law>(0.2, 0.1);
  h = after(law, moved(-0.05, 0.3), h);
  const LawHistory<Law> before = h;
  for (int k = 1; k <= 100; ++k) {
    const Quatd q = rotation_of(Vec3d{0, 0, 0.014 * k});
    h = after(law, bond_pose(BondFrames<double>{}, Vec3d{1.45, 0.3, 0}, q, conjugate(q)), h);
  }
  for (std::size_t k = 0; k < rubbed::count; ++k)
    if (k < rubbed::shear || k == rubbed::dissipated) {
      EXPECT_NEAR(h.value[k], before.value[k], 1e-13);
    }
}

}  // namespace
}  // namespace vbond::faces_test
