#include <gtest/gtest.h>

#include <cmath>

#include "rods.hpp"
#include "spheres_and_walls.hpp"
#include "vbond/core/error.hpp"

namespace vbond {
namespace {

TEST(Stops, AfterTheDurationInWholeSteps) {
  const testing::Specimen s = testing::straight_rod(2);
  Simulation run(s.model, testing::plain_stage(0.1, 3.0), s.state);
  EXPECT_EQ(run.run(), StopReason::duration);
  EXPECT_EQ(run.state().clock.step, 30);
  EXPECT_EQ(run.state().clock.time(), 30 * 0.1);
}

TEST(Steps, OfATimeWithoutEndAreManyAndCanBeAdded) {
  EXPECT_EQ(steps_in(1e30, 1e-3), std::int64_t{1} << 62);
  EXPECT_EQ(steps_in(std::numeric_limits<double>::infinity(), 1.0), std::int64_t{1} << 62);
  EXPECT_EQ(steps_in(1e-9, 1.0), 1);
  EXPECT_EQ(steps_in(2.4999, 1.0), 2);
}

TEST(Stops, WhenTwoParticlesAreNearEnough) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {2, 0, 0}});
  s.state.v = {{0, 0, 0}, {-0.1, 0, 0}};
  Stage stage = testing::plain_stage(0.1, 1e9);
  stage.stops.distance = DistanceStop{ParticleId{0}, ParticleId{1}, 1.0, true};
  Simulation run(s.model, stage, s.state);
  EXPECT_EQ(run.run(), StopReason::distance);
  EXPECT_NEAR(run.state().clock.time(), 10.0, 0.1 + 1e-9);
}

// A damped swing at rest: its kinetic energy passes zero at every turn, which must not count as rest.
TEST(Stops, AtRestButNotAtATurningPoint) {
  testing::Specimen s = testing::straight_rod(2);
  s.state.v = {{-0.01, 0, 0}, {0.01, 0, 0}};
  Stage stage = testing::plain_stage(0.05, 1e9);
  stage.b_translation = 0.02;
  stage.stops.rest = RestStop{1e-8, 5.0};  // 1e-4 of the start after ln(1e4) m / b = 460; period 4.44
  Simulation run(s.model, stage, s.state);
  EXPECT_EQ(run.run(), StopReason::rest);
  EXPECT_GT(run.state().clock.time(), 350.0);
  EXPECT_LT(run.state().clock.time(), 480.0);
}

TEST(Stops, WhenTheBlockAverageHasFallenBelowItsPeak) {
  testing::Specimen s = testing::straight_rod(2);
  const std::vector<ParticleId> ends{ParticleId{0}, ParticleId{1}};
  Stage stage = testing::plain_stage(0.1, 1e9);
  stage.supports = {testing::held(ends, testing::clamped)};
  stage.supports[0].velocity = {};
  stage.supports.push_back(stage.supports[0]);
  stage.supports[0].particles = {ends[0]};
  stage.supports[1].particles = {ends[1]};
  stage.supports[1].velocity = {-1e-3, 0, 0};  // compress for 10, then draw back
  stage.supports[1].factor.points = {{0, 1}, {10, 1}, {10, -1}};
  stage.stops.peak = PeakStop{PeakQuantity::compressive_force, ends, {}, 0.1, 1.0};
  Simulation run(s.model, stage, s.state);
  EXPECT_EQ(run.run(), StopReason::peak);
  // force = c_A v t: the best block average is half a block before the turn, 0.0095 and 0.0095 just after
  EXPECT_NEAR(run.state().peak.peak, 0.0095, 1e-4);  // sampled at the ends of steps: dt v / 2 = 5e-5 off
  EXPECT_NEAR(run.state().peak.peak_time, 10.0, 1.0 + 1e-9);
  EXPECT_LT(run.state().peak.last, 0.9 * run.state().peak.peak);
}

// A floor comes up against a held sphere and goes down again: the force on it is k times the overlap.
TEST(Stops, WhenTheForceOnAWallHasFallenBelowItsPeak) {
  testing::Specimen s =
      testing::sphere({0, 0, 1}, 1.0, 1.0, testing::linear(10.0, 0.0), {testing::floor_at(-0.005)});
  Stage stage = testing::plain_stage(0.01, 1e9);
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  stage.walls = {testing::drive("floor", 0)};
  stage.walls[0].velocity = {0, 0, 1e-3};
  stage.walls[0].factor.points = {{0, 1}, {10, 1}, {10, -1}};
  stage.stops.peak = PeakStop{PeakQuantity::wall_force, {}, {0, 0, -1}, 0.5, 1.0, 0};
  Simulation run(s.model, stage, s.state);
  EXPECT_EQ(run.run(), StopReason::peak);
  // overlap 0.005 at t = 10; the best block average is half a block before or after it: 10 (0.005 - 5e-4)
  EXPECT_NEAR(run.state().peak.peak, 0.045, 2e-4);  // sampled at the ends of steps
  EXPECT_NEAR(run.clock().time(), 14.0, 1e-9);      // the first block below half: 0.015 from 13 to 14

  stage.stops.peak->above = 0.046;  // more than that: the peak does not count
  stage.stops.duration = 20.0;
  Simulation on(s.model, stage, s.state);
  EXPECT_EQ(on.run(), StopReason::duration);
  EXPECT_NEAR(on.state().peak.peak, 0.045, 2e-4);
}

TEST(Simulation, StopsWhenALoadIsNotFinite) {
  testing::Specimen s = testing::straight_rod(3);
  s.state.v[ParticleId{2}] = {std::nan(""), 0, 0};
  Simulation run(s.model, testing::plain_stage(0.1, 1.0), s.state);
  try {
    run.step();
    FAIL() << "no error";
  } catch (const Diverged& e) {
    EXPECT_EQ(e.step, 1);
    EXPECT_NE(std::string(e.what()).find("particle 1"), std::string::npos) << e.what();
  }
}

TEST(Simulation, IsInterruptedBetweenSteps) {
  const testing::Specimen s = testing::straight_rod(2);
  Simulation run(s.model, testing::plain_stage(0.1, 100.0), s.state);
  int asked = 0;
  EXPECT_EQ(run.run([&] { return ++asked == 7; }), StopReason::interrupted);
  EXPECT_EQ(run.state().clock.step, 7);
}

}  // namespace
}  // namespace vbond
