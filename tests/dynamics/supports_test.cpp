#include <gtest/gtest.h>

#include <cmath>

#include "rods.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

const ParticleId first{0}, last{9};

TEST(Supports, KeepHeldDegreesOfFreedomExactly) {
  testing::Specimen s = testing::straight_rod(10);
  for (Vec3d& v : s.state.v) v = {0.01, 0.02, -0.01};
  Stage stage = testing::plain_stage(0.1, 100);
  stage.supports = {testing::held({first}, testing::clamped),
                    testing::held({last}, {false, true, false, false, false, true})};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_EQ(run.state().r[first], s.state.r[first]);
  EXPECT_EQ(run.state().q[first], s.state.q[first]);
  EXPECT_EQ(run.state().r[last].y, 0.0);
  EXPECT_NE(run.state().r[last].z, 0.0);  // not held: it moved
  EXPECT_EQ(run.state().omega[last].z, 0.0);
  EXPECT_NE(run.state().omega[last].y, 0.0);
}

TEST(Supports, MoveAtTheirPrescribedVelocities) {
  testing::Specimen s = testing::straight_rod(10);
  Stage stage = testing::plain_stage(0.1, 10);
  stage.supports = {testing::held({first}, testing::clamped, {0.003, 0, 0})};
  stage.supports[0].angular_velocity = {0.02, 0, 0};
  stage.supports[0].factor.points = {{0, 0}, {10, 2}};
  Simulation run(s.model, stage, s.state);
  run.run();
  // the mean factor over the ramp is 1; the midpoint rule is exact for a straight line
  EXPECT_NEAR(run.state().r[first].x, 0.03, 1e-15);
  EXPECT_NEAR(rotation_vector(run.state().q[first]).x, 0.2, 1e-14);
  EXPECT_NEAR(run.state().v[first].x, 0.006, 1e-16);
}

// A hanging weight at rest: the support carries it, whatever hangs below.
TEST(Reaction, CarriesTheWeightAtRest) {
  testing::Specimen s = testing::straight_rod(10);
  Stage stage = testing::plain_stage(0.6, 20000);
  stage.supports = {testing::held({first}, testing::clamped)};
  stage.gravity = {1e-6, 0, 0};
  stage.b_translation = 0.3;  // critical for the slowest axial mode, pi / 20
  Simulation run(s.model, stage, s.state);
  run.run();
  const Reaction r = run.reaction({first});
  EXPECT_NEAR(r.force.x, -10e-6, 1e-15);  // ten particles of mass 1; rounding of c_A x = 1e-15
  EXPECT_NEAR(r.force.y, 0.0, 1e-15);
  EXPECT_EQ(run.reaction({last}).force, (Vec3d{}));  // not supported
  EXPECT_NEAR(mean_axial_force(run.part(), s.model.groups[0].particles), 5e-6,
              1e-15);  // mean of 9 ... 1 weights
}

// The drag of a held particle is borne by its support: b v for one that is drawn along steadily, alone, and
// b omega about its axis. Without drag nothing would be left.
TEST(Reaction, BearsTheDragOfWhatItMoves) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {5, 0, 0}});
  Stage stage = testing::plain_stage(0.1, 10);
  stage.b_translation = 0.3;
  stage.b_rotation = 0.7;
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped, {0.02, 0, -0.01})};
  stage.supports[0].angular_velocity = {0, 0.05, 0};
  Simulation run(s.model, stage, s.state);
  run.run();
  const Reaction r = run.reaction({ParticleId{0}});
  EXPECT_NEAR(r.force.x, 0.3 * 0.02, 1e-17);
  EXPECT_NEAR(r.force.z, 0.3 * -0.01, 1e-17);
  const Vec3d arm = run.state().r[ParticleId{0}];  // moments are about the origin
  EXPECT_NEAR(norm(r.moment - (Vec3d{0, 0.7 * 0.05, 0} + cross(arm, r.force))), 0.0, 1e-17);
}

TEST(Gravity, GivesAFreeParticleTheParabola) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}});
  Stage stage = testing::plain_stage(0.01, 2.0);
  stage.gravity = {0, 0, -9.81};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_NEAR(run.state().r[first].z, -0.5 * 9.81 * 4, 1e-12);  // exact for leap-frog; 200 roundings
}

TEST(TimeFunction, IsLinearBetweenPointsAndConstantOutside) {
  const TimeFunction f{{{1, 2}, {3, 6}, {3, 1}, {4, 0}}};
  EXPECT_EQ(f(0), 2);
  EXPECT_EQ(f(2), 4);
  EXPECT_EQ(f(3.5), 0.5);
  EXPECT_EQ(f(9), 0);
  EXPECT_EQ(TimeFunction{}(5), 1);
}

}  // namespace
}  // namespace vbond
