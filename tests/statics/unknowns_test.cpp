#include "vbond/statics/detail/unknowns.hpp"

#include <gtest/gtest.h>

namespace vbond::unknowns_test {
namespace {

const ParticleId first{0}, second{1};

/// Two particles, the first held along x and about z; the length is 2.
Unknowns ten_unknowns() {
  return {2, {{"held", {first}, {true, false, false, false, false, true}, {}, {}}}, 2.0};
}

TEST(Unknowns, NumberTheFreeDegreesOfFreedomParticleByParticle) {
  const Unknowns u = ten_unknowns();
  ASSERT_EQ(u.size(), 10);
  EXPECT_EQ(u.of(first, 0), Unknowns::held);
  EXPECT_EQ(u.of(first, 5), Unknowns::held);
  EXPECT_EQ(u.of(first, 1), 0);
  EXPECT_EQ(u.of(first, 4), 3);
  EXPECT_EQ(u.of(second, 0), 4);
  EXPECT_EQ(u.of(second, 5), 9);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(u.of(u.place(k).particle, u.place(k).dof), k);
    EXPECT_EQ(u.is_turn(k), k == 2 || k == 3 || k >= 7) << k;
  }
}

// Those that supports hold anyway are not counted.
TEST(Unknowns, AreNoTurnsThatNothingDrivesOrResists) {
  const Unknowns u(2, {{"held", {first}, {true, false, false, false, false, true}, {}, {}}}, 2.0, {},
                   {{first, 3}, {first, 4}, {first, 5}, {second, 4}});
  ASSERT_EQ(u.size(), 7);
  for (const int dof : {3, 4, 5}) EXPECT_EQ(u.of(first, dof), Unknowns::held);
  EXPECT_EQ(u.of(second, 4), Unknowns::held);
  EXPECT_EQ(u.of(second, 5), 6);
  ASSERT_EQ(u.free_turns().size(), 3u);
  EXPECT_EQ(u.free_turns()[1].dof, 4);
  EXPECT_EQ(u.names_of_free_turns(), "particles 0, 1");
}

TEST(Unknowns, AreCalledByWhatMovesAndTheParticle) {
  const Unknowns u = ten_unknowns();
  EXPECT_EQ(u.name(0), "translation along y of particle 0");
  EXPECT_EQ(u.name(3), "rotation about y of particle 0");
  EXPECT_EQ(u.name(9), "rotation about z of particle 1");
}

// The largest first, of either sign, three at most, and none below a tenth of the largest.
TEST(Unknowns, OfWhichAVectorHasMostAreNamed) {
  const Unknowns u = ten_unknowns();
  Vector x = Vector::Zero(10);
  x[4] = -1.0, x[9] = 0.11, x[0] = 0.09;
  EXPECT_EQ(u.names_of_largest(x), "translation along x of particle 1, rotation about z of particle 1");
  x[1] = 0.2, x[3] = -0.3;
  EXPECT_EQ(
      u.names_of_largest(x),
      "translation along x of particle 1, rotation about y of particle 0, translation along z of particle 0");
}

// Movements to a largest translation of 1; an unknown of a turn is the turn times the length, 2.
TEST(Shapes, AreScaledToTheirLargestTranslation) {
  const Unknowns u = ten_unknowns();
  Vector x = Vector::Zero(10);
  x[0] = 3.0, x[1] = -4.0, x[6] = 2.0, x[2] = 5.0, x[9] = -40.0;
  const Shape s = u.shape(x);
  EXPECT_EQ(s.translation[first], (Vec3d{0, 0.6, -0.8}));
  EXPECT_EQ(s.translation[second], (Vec3d{0, 0, 0.4}));
  EXPECT_EQ(s.rotation[first], (Vec3d{0.5, 0, 0}));
  EXPECT_EQ(s.rotation[second], (Vec3d{0, 0, -4.0}));
}

// Translations of a millionth of the turns and less are rounding.
TEST(Shapes, OfTurnsAloneAreScaledToTheLargestTurn) {
  const Unknowns u = ten_unknowns();
  Vector x = Vector::Zero(10);
  x[2] = 3.0, x[3] = -4.0, x[9] = 2.0, x[4] = 1e-7;
  const Shape s = u.shape(x);
  EXPECT_EQ(s.rotation[first], (Vec3d{0.6, -0.8, 0}));
  EXPECT_EQ(s.rotation[second], (Vec3d{0, 0, 0.4}));
  EXPECT_NEAR(s.translation[second].x, 0.4e-7, 1e-20);
}

}  // namespace
}  // namespace vbond::unknowns_test
