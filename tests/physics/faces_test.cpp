// The faces of cracked cells: when they part, and what slides where they twist or tilt.
#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>
#include <utility>

#include "cracked.hpp"
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
