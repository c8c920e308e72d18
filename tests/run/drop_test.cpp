// Which particles are dropped, what is told of it, and what ends the run all the same.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "run/dropping.hpp"
#include "vbond/core/error.hpp"

namespace vbond::drop_test {
namespace {

/// Two balls that pass through one another, and one that watches from afar.
Specimen two_balls(double speed) {
  Specimen s = testing::particles_at({{0, 0, 0}, {2, 0, 0}, {5, 5, 0}});
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0, 0};
  s.state.v[ParticleId{0}] = {speed, 0, 0};
  s.state.v[ParticleId{2}] = {0, 0.1, 0};
  return s;
}

// ---- what is dropped, and what is told of it ------------------------------------------------------------

TEST(Drop, OneOfTwoBallsThatPassThroughOneAnother) {
  Watched w(two_balls(2.2), dropping(0.02, 3.0));
  EXPECT_NO_THROW(w.run.run());
  const State s = w.run.state();
  ASSERT_EQ(s.dropped, std::vector<ParticleId>{ParticleId{1}});  // as alike as they are, the later one
  EXPECT_EQ(s.v[ParticleId{1}], Vec3d{});
  EXPECT_GT(s.v[ParticleId{0}].x, 0.0);
  EXPECT_EQ(w.run.results()[0].stop, StopReason::duration);
  ASSERT_FALSE(w.told.empty());
  EXPECT_NE(w.told[0].find("particle 1 is dropped at ("), std::string::npos) << w.told[0];
  EXPECT_NE(w.told[0].find("it has passed through particle 0; 0 bonds broke"), std::string::npos)
      << w.told[0];
}

// New velocities are of those that are there: no energy is booked for the one that is gone.
TEST(Drop, NewVelocitiesLeaveItOut) {
  Watched w(two_balls(2.2), dropping(0.02, 3.0));
  while (w.run.state().dropped.empty()) w.run.step(1);
  const State before = w.run.state();
  w.run.set_velocities(PerParticle<Vec3d>(3, {0, 2, 0}), before.omega);
  const State s = w.run.state();
  EXPECT_EQ(s.v[ParticleId{1}], Vec3d{});
  const double m = 0.5 * w.run.model().mass[ParticleId{0}], was = norm2(before.v[ParticleId{0}]) + 0.01;
  EXPECT_NEAR(s.books.work_loads - before.books.work_loads, m * (8.0 - was), 1e-14);
  EXPECT_NO_THROW(w.run.run());
}

TEST(Drop, TheLighterOneGoesAndOneOfABodyStays) {
  Specimen light = two_balls(2.2);
  light.model.mass[ParticleId{0}] = 0.9;
  Watched w(light, dropping(0.02, 3.0));
  w.run.run();
  EXPECT_EQ(w.run.state().dropped, std::vector<ParticleId>{ParticleId{0}});
  Specimen bonded = two_balls(2.2);
  bonded.model.mass[ParticleId{1}] = 0.5;
  testing::bond(bonded, 1, 2, testing::papers_bond());
  Watched b(bonded, dropping(0.02, 3.0));
  b.run.run();
  EXPECT_EQ(b.run.state().dropped, std::vector<ParticleId>{ParticleId{0}});
}

TEST(Drop, WhatASupportHoldsStays) {
  Stage stage = dropping(0.02, 3.0);
  stage.supports = {testing::held({ParticleId{1}}, testing::clamped)};
  Watched w(two_balls(2.2), stage);
  w.run.run();
  EXPECT_EQ(w.run.state().dropped, std::vector<ParticleId>{ParticleId{0}});
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped, {2.2, 0, 0}),
                    testing::held({ParticleId{1}}, testing::clamped)};
  Watched both(two_balls(2.2), stage);
  EXPECT_THROW(both.run.run(), Diverged);
}

// A ball has passed through a floor that moves up, and another one lies on it. What the first exerted on the
// floor in its last step is gone with it: it was in the history, and did work in the next step.
TEST(Drop, ADroppedParticlePressesOnNoWall) {
  Specimen s = testing::particles_at({{0, 0, 0.2}, {5, 0, 0.49}}, 0.5);
  s.model.contact = testing::linear(1.0, 0.0);
  s.model.walls = {{"floor", PlaneWall{{0, 0, 0}, {0, 0, 1}}, 0, {}}};
  s.state.v[ParticleId{0}] = {0, 0, -15};
  Stage stage = dropping(0.02, 1.0);
  stage.walls = {testing::drive("floor", 0)};
  stage.walls[0].velocity = {0, 0, 0.1};
  Watched w(s, stage);
  while (w.run.current().dropped.empty()) w.run.step(1);
  ASSERT_EQ(w.run.current().dropped, std::vector<ParticleId>{ParticleId{0}});
  const auto pressed = [&] {  // by the ball that lies there, as deep as it is
    const State now = w.run.state();
    return now.walls[0].displacement.z + 0.5 - now.r[ParticleId{1}].z;
  };
  const State before = w.run.state();
  const double was = pressed();
  EXPECT_NEAR(before.walls[0].force.z, -was, 1e-15);
  w.run.step(1);
  // a wall of a given velocity does work by the mean of its forces at both ends of the step
  EXPECT_NEAR(w.run.state().walls[0].work - before.walls[0].work, 0.5 * 0.02 * 0.1 * (was + pressed()),
              1e-15);
}

// After a step nothing would find the others any more: through a wall they are on the side where they are
// pushed on.
TEST(Drop, AllThatAreLostInOneStep) {
  Specimen s =
      testing::particles_at({{0, 0, 1}, {3, 0, 1}, {6, 0, 1}, {9, 0, 1}, {9, 2, 1}, {12, 0, 1}, {12, 2, 1}});
  s.model.contact = linear(1.0, 0.0);
  s.model.walls = {testing::floor_at(0)};
  for (const std::size_t p : {0, 2}) s.state.v[ParticleId{p}] = {0, 0, -10};
  for (const std::size_t p : {3, 5}) s.state.v[ParticleId{p}] = {0, 10, 0};
  Watched w(s, dropping(1e-3, 0.3));
  w.run.run();
  EXPECT_EQ(w.run.state().dropped,
            (std::vector<ParticleId>{ParticleId{0}, ParticleId{2}, ParticleId{4}, ParticleId{6}}));
}

// A wall takes a ball in every step in which the pair is deep in one another: what the watch is to see of the
// pair must outlive each loss. The pair meets after 0.1, and the balls fall through the wall from 0.08 to
// 0.12.
TEST(Drop, APairIsSeenWhileWallsTakeOthers) {
  std::vector<Vec3d> r{{0, -5, 1}, {0, -4, 1}};
  for (int k = 0; k < 40; ++k) r.push_back({2.0 * k, 0, 0.8 + 0.01 * k});
  Specimen s = testing::particles_at(r);
  s.model.contact = linear(1.0, 0.0);
  s.model.walls = {testing::floor_at(0)};
  for (const ParticleId p : s.model.mass.ids()) s.state.v[p] = {0, 0, -10};
  s.state.v[ParticleId{0}] = {0, 10, 0}, s.state.v[ParticleId{1}] = {};
  Watched w(s, dropping(1e-3, 0.2));
  w.run.run();
  EXPECT_EQ(w.run.state().dropped.size(), 41u);
  EXPECT_TRUE(is_dropped(w.run.state(), ParticleId{1}));
}

// A body may fly as fast as it likes: what has stopped is none of it.
TEST(Drop, TheSpeedOfTheRestIsMeasuredAgainstTheRest) {
  Specimen s = testing::particles_at({{0, 0, 0}, {3, 0, 0}, {6, 0, 0}});
  s.model.contact = linear(1.0, 0.0);
  s.state.dropped = {ParticleId{2}};
  s.state.v[ParticleId{0}] = s.state.v[ParticleId{1}] = {100, 0, 0};
  Simulation run(s.model, testing::plain_stage(0.01, 1.0), s.state);
  run.step();
  EXPECT_FALSE(run.deep().particles.fastest());
}

TEST(Drop, TheLastOneStopsTheRun) {
  Specimen s = testing::sphere({0, 0, 0.5}, 0.1, 1.0, linear(10.0, 0.0), {testing::floor_at(0)});
  s.state.v[ParticleId{0}] = {0, 0, -5};
  Watched w(s, dropping(1e-3, 2.0));
  EXPECT_THROW(w.run.run(), Diverged);
  EXPECT_TRUE(w.run.state().dropped.empty());
}

TEST(Drop, LaterStagesGoOnWithoutIt) {
  const Specimen s = two_balls(2.2);
  vbond::Run run(s.model, s.state, {dropping(0.02, 3.0), testing::plain_stage(0.02, 1.0)});
  run.add_observer(watch());
  run.run();
  const State after = run.state();
  EXPECT_EQ(run.results().size(), 2u);
  ASSERT_EQ(after.dropped, std::vector<ParticleId>{ParticleId{1}});
  EXPECT_EQ(after.v[ParticleId{1}], Vec3d{});
}

TEST(Drop, StopIsTheDefault) {
  Stage stage = dropping(0.02, 3.0);
  stage.on_unphysical = Stage{}.on_unphysical;
  Watched w(two_balls(2.2), stage);
  EXPECT_THROW(w.run.run(), Diverged);
  EXPECT_TRUE(w.run.state().dropped.empty());
}

TEST(Drop, BondsOfADroppedParticleAreBroken) {
  Specimen s = testing::straight_rod(4);
  s.model.contact = linear(10.0, 0.0);
  s.model.contact.pairs = ContactPairs::unbonded;
  s.model.walls = {{"wall", PlaneWall{{0, 0, -0.5}, {0, 0, 1}}, 0, {}}};
  s.state.v[ParticleId{1}] = {0, 0, -30.0};
  Watched w(s, dropping(0.01, 0.2));
  w.run.run();
  const State after = w.run.state();
  ASSERT_EQ(after.dropped, std::vector<ParticleId>{ParticleId{1}});
  EXPECT_TRUE(after.bonds[BondId{0}].broken);
  EXPECT_TRUE(after.bonds[BondId{1}].broken);
  EXPECT_FALSE(after.bonds[BondId{2}].broken);
  EXPECT_NE(w.told[0].find("its centre has passed through wall \"wall\"; 2 bonds broke"), std::string::npos)
      << w.told[0];
}

// What is not finite cannot be taken out any more: it is in the velocities of others already.
TEST(Drop, WhatIsNotFiniteStopsTheRun) {
  Specimen s = two_balls(0.0);
  Stage stage = dropping(0.02, 3.0);
  stage.loads = {PointLoad{"all", {ParticleId{2}}, {1e308, 1e308, 1e308}, {}, {}}};
  stage.loads.push_back(stage.loads[0]);
  Watched w(s, stage);
  EXPECT_THROW(w.run.run(), Diverged);
  EXPECT_TRUE(w.run.state().dropped.empty());
}

// Its place is where it was lost; another particle that comes by is not touched, and no bond is made to it.
TEST(Drop, ADroppedParticleTouchesNothingAndIsBondedToNothing) {
  Specimen s = two_balls(2.2);
  s.model.r_0[ParticleId{2}] = s.state.r[ParticleId{2}] = {4.0, 0, 0};
  s.state.v[ParticleId{2}] = {-1.0, 0, 0};  // towards where the other one will be lost
  Stage stage = dropping(0.02, 6.0);
  BondingRule rule;
  rule.name = "glue";
  rule.in_a = {0, 1, 0}, rule.in_b = {0, 0, 1};
  rule.distance = 0.3, rule.recipe = testing::papers_bond();
  stage.bonding = {rule};
  stage.insist = true;
  s.model.contact.pairs = ContactPairs::all;
  s.state.v[ParticleId{0}] = {0, 0, 3.0},
  s.state.r[ParticleId{0}] = s.model.r_0[ParticleId{0}] = {2.0, 0, -2.0};
  Watched w(s, stage);
  w.run.run();
  const State after = w.run.state();
  ASSERT_EQ(after.dropped, std::vector<ParticleId>{ParticleId{1}});
  const Vec3d& place = after.r[ParticleId{1}];
  EXPECT_LT(std::hypot(place.y, place.z), rule.distance);  // so near it came by
  EXPECT_EQ(after.bonds.size(), 0u);
  EXPECT_EQ(after.v[ParticleId{2}], s.state.v[ParticleId{2}]);  // nobody has touched it
  EXPECT_LT(after.r[ParticleId{2}].x, 0.0);
}

TEST(Drop, AStaticStageAfterwardsIsRefused) {
  Specimen s = testing::straight_rod(3);
  s.state.dropped = {ParticleId{2}};
  s.state.bonds[BondId{1}].broken = true;
  StaticStage rest;
  rest.name = "rest";
  Support held{};
  held.group = "held", held.particles = {ParticleId{0}, ParticleId{2}}, held.held = testing::clamped;
  rest.supports = {held};
  vbond::Run run(s.model, s.state, {rest});
  EXPECT_THROW(run.run(), std::invalid_argument);
}

TEST(Drop, AStageThatEndsByTheDistanceToADroppedParticleIsRefused) {
  const Specimen s = two_balls(2.2);
  Stage then = testing::plain_stage(0.02, 1.0);
  then.stops.distance = {ParticleId{1}, ParticleId{2}, 100.0, false};
  vbond::Run run(s.model, s.state, {dropping(0.02, 3.0), then});
  run.add_observer(watch());
  try {
    run.run();
    ADD_FAILURE() << "it runs";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("ends by the distance to particle 1, which was dropped before it"),
              std::string::npos)
        << e.what();
  }
  EXPECT_EQ(run.results().size(), 1u);
}

TEST(Drop, AStateThatCannotBeIsRefused) {
  Specimen s = testing::straight_rod(3);
  s.state.dropped = {ParticleId{2}};  // but its bond is whole
  EXPECT_THROW(vbond::Run(s.model, s.state, {dropping(0.01, 1.0)}), std::invalid_argument);
  s.state.bonds.resize(0);
  s.state.dropped = {ParticleId{3}};
  EXPECT_THROW(vbond::Run(s.model, s.state, {dropping(0.01, 1.0)}), std::invalid_argument);
  s.state.dropped = {ParticleId{2}, ParticleId{1}};
  EXPECT_THROW(vbond::Run(s.model, s.state, {dropping(0.01, 1.0)}), std::invalid_argument);
}

}  // namespace
}  // namespace vbond::drop_test
