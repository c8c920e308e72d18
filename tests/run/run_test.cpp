#include "vbond/run/run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "dynamics/rods.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond {
namespace {

using testing::Specimen;

/// A rod held at one end, with something to do.
Stage swing(const std::string& name, double duration, const Vec3d& force = {0, 1e-3, 0}) {
  Stage stage = testing::plain_stage(0.05, duration);
  stage.name = name;
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  stage.loads = {PointLoad{"end", {ParticleId{4}}, force, {}, {}}};
  return stage;
}

std::vector<AnyStage> two_stages() {
  return {swing("up", 5.0), swing("down", 7.0, {0, -2e-3, 1e-3})};
}

/// What the books say is missing, relative to what has come in.
double balance_error(const vbond::Run& run) {
  const State s = run.state();
  const EnergyBooks& b = s.books;
  const double now = kinetic_energy(run.model(), s) + potential_energies(run.model(), s).total();
  return std::abs(now + b.dissipated - b.work_loads - b.work_supports - b.at_start) /
         std::max(b.largest, b.at_start);
}

TEST(Run, GoesThroughItsStagesWithOneClock) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, two_stages());
  const std::vector<StageResult>& results = run.run();
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].name, "up");
  EXPECT_EQ(results[0].steps, 100);
  EXPECT_EQ(results[1].steps, 140);  // not 40: its own steps are counted from its own beginning
  EXPECT_EQ(results[1].stop, StopReason::duration);
  EXPECT_TRUE(run.complete());
  EXPECT_EQ(run.clock().step, 240);
  EXPECT_NEAR(run.clock().time(), 12.0, 1e-12);
  EXPECT_LT(balance_error(run), 1e-3);  // leap-frog at 0.05 of the critical step: measured 1.3e-5
}

TEST(Run, StepsAreThoseOfWholeStagesToTheLastBit) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run whole(s.model, s.state, two_stages());
  whole.run();
  vbond::Run by_steps(s.model, s.state, two_stages());
  std::int64_t made = 0;
  while (!by_steps.complete()) made += by_steps.step(7);
  EXPECT_EQ(made, 240);
  EXPECT_TRUE(by_steps.state() == whole.state());
  EXPECT_EQ(by_steps.results().size(), 2u);
}

// step(7) does not run on into the next stage.
TEST(Run, StepsEndWithTheStage) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, two_stages());
  EXPECT_EQ(run.step(98), 98);
  EXPECT_EQ(run.step(7), 2);
  EXPECT_EQ(run.stage_index(), 1u);
  EXPECT_EQ(run.clock().stage_step, 0);
  EXPECT_EQ(run.step(0), 0);
}

TEST(Run, ASnapshotGoesOnToTheLastBit) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run whole(s.model, s.state, two_stages());
  whole.run();
  for (const std::int64_t at : {0, 1, 99, 100, 101, 200}) {
    vbond::Run first(s.model, s.state, two_stages());
    for (std::int64_t left = at; left > 0;) left -= first.step(left);
    vbond::Run second(s.model, first.state(), two_stages(), 2);
    second.run();
    EXPECT_TRUE(second.state() == whole.state()) << "stopped at step " << at;
  }
}

// state() is a copy of one instant: it does not change as the run goes on.
TEST(Run, ASnapshotIsOfOneInstant) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, two_stages());
  run.step(10);
  const State then = run.state();
  const Clock clock = then.clock;
  const Vec3d end = then.r[ParticleId{4}];
  run.step(10);
  EXPECT_EQ(then.clock, clock);
  EXPECT_EQ(then.r[ParticleId{4}], end);
  EXPECT_EQ(run.state().clock.step, 20);
  EXPECT_NE(run.state().r[ParticleId{4}], end);
}

// Nothing is kept by reference: model, state and stages may be temporaries.
TEST(Run, OwnsWhatItIsGiven) {
  const auto make = [] {
    Specimen s = testing::straight_rod(5);
    return std::make_unique<vbond::Run>(Model(s.model), State(s.state), two_stages());
  };
  const std::unique_ptr<vbond::Run> run = make();
  run->run();
  EXPECT_EQ(run->clock().step, 240);
}

TEST(Run, CanBeInterruptedAndGoOn) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run whole(s.model, s.state, two_stages());
  whole.run();
  vbond::Run run(s.model, s.state, two_stages());
  RunHooks hooks;
  hooks.interrupted = [&run] { return run.clock().step == 33; };
  run.set_hooks(hooks);
  EXPECT_TRUE(run.run().empty());
  EXPECT_EQ(run.clock().step, 33);
  EXPECT_EQ(run.run().size(), 2u);
  EXPECT_TRUE(run.state() == whole.state());
}

TEST(Run, ADynamicStageCanBeEndedByHand) {
  const Specimen s = testing::straight_rod(5);
  std::vector<AnyStage> stages = two_stages();
  std::get<Stage>(stages[0]).stops.duration = INFINITY;
  vbond::Run run(s.model, s.state, stages);
  run.step(100);
  run.end_stage();
  EXPECT_EQ(run.stage_index(), 1u);
  run.run();
  vbond::Run whole(s.model, s.state, two_stages());
  whole.run();
  EXPECT_TRUE(run.state() == whole.state());
}

// A push: the kinetic energy that it brings is booked, before a stage and in the midst of one.
TEST(Run, NewVelocitiesAreBookedAsWork) {
  for (const std::int64_t at : {0, 50, 100, 150}) {
    const Specimen s = testing::straight_rod(5);
    vbond::Run run(s.model, s.state, two_stages());
    run.step(at);
    run.set_velocity({ParticleId{2}, ParticleId{4}}, {0, 0.02, 0.01}, {0.1, 0, 0});
    EXPECT_EQ(run.state().v[ParticleId{4}], (Vec3d{0, 0.02, 0.01}));
    run.run();
    EXPECT_LT(balance_error(run), 1e-3) << "at step " << at;
    EXPECT_EQ(run.clock().step, 240);
  }
}

TEST(Run, VelocitiesSetToWhatTheyAreChangeNothing) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run whole(s.model, s.state, two_stages()), run(s.model, s.state, two_stages());
  whole.run();
  run.step(31);
  run.set_velocities(run.state().v, run.state().omega);
  run.run();
  EXPECT_TRUE(run.state() == whole.state());
}

/// Two particles one apart, without bonds, as one body that may go along x and y, and turn about z.
Stage sledge() {
  Stage stage = testing::plain_stage(0.01, 1.0);
  stage.supports = {testing::held({ParticleId{0}, ParticleId{1}}, {false, false, true, true, true, false})};
  stage.supports[0].rigid = true;
  return stage;
}

// A clump goes on with the momentum that its particles are given, before its first step and after some: here
// of one of them, so that the pair turns, too.
TEST(Run, NewVelocitiesOfAClumpAreItsMotion) {
  const Specimen s = testing::straight_rod(2);
  for (const std::int64_t at : {0, 1, 40}) {
    vbond::Run run(s.model, s.state, {sledge()});
    run.step(at);
    run.set_velocity({ParticleId{1}}, {0, 0.5, 0});
    run.step(1);
    const double m = s.model.mass[ParticleId{0}], theta = s.model.inertia[ParticleId{0}],
                 spin = 0.5 * m * 0.5 / (0.5 * m + 2 * theta);  // arms of 1/2
    const Vec3d v = 0.5 * (run.state().v[ParticleId{0}] + run.state().v[ParticleId{1}]);
    EXPECT_LE(norm(v - Vec3d{0, 0.25, 0}), 1e-14) << at;
    EXPECT_NEAR(run.state().omega[ParticleId{1}].z, spin, 1e-14) << at;
    run.run();
    EXPECT_LT(balance_error(run), 1e-12) << at;
  }
}

// What is driven goes on as it is told, with the same state as without.
TEST(Run, NewVelocitiesLeaveADrivenGroupOnItsWay) {
  const Specimen s = testing::straight_rod(5);
  Stage stage = testing::plain_stage(0.05, 4.0);
  stage.supports = {testing::held({ParticleId{0}, ParticleId{1}}, all_held, {0.01, 0, 0})};
  stage.supports[0].rigid = true, stage.supports[0].angular_velocity = {0, 0, 0.1};
  vbond::Run whole(s.model, s.state, {stage}), run(s.model, s.state, {stage});
  whole.step(40);
  run.step(20);
  run.set_velocities(run.state().v, run.state().omega);
  run.step(20);
  EXPECT_TRUE(run.state() == whole.state());
}

// The books have what particles move beside the flow of the cell.
TEST(Run, NewVelocitiesInACellThatMovesAreBookedAsWork) {
  Specimen s = testing::straight_rod(5);
  s.model.cell = {{Vec3d{9, 0, 0}, Vec3d{0, 9, 0}, Vec3d{0, 0, 9}}, {true, true, true}, {}, false};
  s.state.cell = cell_at_start(s.model);
  Stage stage = testing::plain_stage(0.05, 4.0);
  stage.cell.component[0] = {CellComponent::By::strain, 0.01, {}};
  stage.cell.component[5] = {CellComponent::By::strain, 0.02, {}};
  for (const std::int64_t at : {0, 20}) {
    vbond::Run run(s.model, s.state, {stage});
    run.step(at);
    PerParticle<Vec3d> v = run.state().v;
    for (Vec3d& of : v) of += {0.01, 0.02, -0.01};
    const double before = run.state().books.work_loads;
    run.set_velocities(v, run.state().omega);
    if (at > 0) {
      double work = 0.0;
      const Tensor L = cell_velocity_gradient(run.state().cell);
      for (const ParticleId p : v.ids()) {
        const Vec3d c = v[p] - times(L, run.state().r[p]), change{0.01, 0.02, -0.01};
        work += 0.5 * s.model.mass[p] * (norm2(c) - norm2(c - change));
      }
      EXPECT_NEAR(run.state().books.work_loads - before, work, 1e-15) << at;
    }
    run.run();
  }
}

// A load that is added at step 0 is one that the stage had from the start.
TEST(Run, AnAddedLoadActsFromThereOn) {
  const Specimen s = testing::straight_rod(5);
  const PointLoad push{"more", {ParticleId{3}}, {0, 0, 2e-3}, {}, {}};
  std::vector<AnyStage> stages = two_stages();
  vbond::Run run(s.model, s.state, stages), later(s.model, s.state, stages);
  run.add_load(push);
  run.run();
  std::get<Stage>(stages[0]).loads.push_back(push);
  vbond::Run whole(s.model, s.state, stages);
  whole.run();
  EXPECT_TRUE(run.state() == whole.state());

  later.step(50);
  later.add_load(push);
  later.run();
  EXPECT_FALSE(later.state() == whole.state());
  EXPECT_LT(balance_error(later), 1e-3);
}

TEST(Run, ObserversSeeEveryStage) {
  struct Counter : Observer {
    void observe(const Simulation&) override { ++looks; }
    void finish(const Simulation&, StopReason) override { ++ends; }
    int looks = 0, ends = 0;
  };
  const auto counter = std::make_shared<Counter>();
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, two_stages());
  run.add_observer(counter);
  run.run();
  EXPECT_EQ(counter->looks, 240 + 2);
  EXPECT_EQ(counter->ends, 2);
}

}  // namespace
}  // namespace vbond
