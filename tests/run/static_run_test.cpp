#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "dynamics/rods.hpp"
#include "statics/bodies.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/run/run.hpp"

/// Runs with static stages.
namespace vbond {
namespace {

using testing::Specimen;

constexpr std::size_t end = 4;

StaticStage bend(double force = 1e-4) {
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)},
                            {testing::pushed(end, {0, force, 0})});
  stage.name = "bend";
  return stage;
}

StaticStage modes(double force) {
  StaticStage stage = bend(force);
  stage.name = "ring";
  stage.kind = StageKind::modes;
  stage.count = 2;
  return stage;
}

StaticStage buckle() {
  StaticStage stage = bend();
  stage.name = "critical";
  stage.kind = StageKind::buckling;
  stage.count = 1;
  stage.loads = {testing::pushed(end, {-1, 0, 0})};
  return stage;
}

Stage swing(double duration = 20.0) {
  Stage stage = testing::plain_stage(0.05, duration);
  stage.name = "swing";
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  return stage;
}

double imbalance(const vbond::Run& run) {
  const State s = run.state();
  const EnergyBooks& b = s.books;
  return kinetic_energy(run.model(), s) + potential_energies(run.model(), s).total() + b.dissipated -
         b.work_loads - b.work_supports - b.at_start;
}

// Bent, let go, bent again, looked at: one clock and books that close in each stage of dynamics.
TEST(Run, MixesStaticAndDynamicStages) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, {bend(), swing(), bend(-1e-4), modes(-1e-4)});
  run.run_stage();
  const State bent = run.state();
  const double U = potential_energies(run.model(), bent).total();
  EXPECT_EQ(bent.books.at_start, U);
  run.run_stage();
  EXPECT_LT(std::abs(imbalance(run)), 1e-3 * U);
  const std::vector<StageResult>& results = run.run();
  ASSERT_EQ(results.size(), 4u);
  EXPECT_EQ(results[0].statics->ended, "converged");
  EXPECT_EQ(results[1].steps, 400);
  EXPECT_NEAR(run.state().r[ParticleId{end}].y, -bent.r[ParticleId{end}].y, 1e-9);
  EXPECT_EQ(results[3].statics->modes.size(), 2u);
  EXPECT_EQ(run.clock().stage, 4);
  EXPECT_EQ(run.clock().step, 400 + results[0].steps + results[2].steps + results[3].steps);
}

// Buckling leaves the body where it began, with the energy of there and not that of the last point of its
// path.
TEST(Run, BooksAfterBucklingAreThoseOfTheStateItLeaves) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, {buckle(), swing()});
  run.run_stage();
  EXPECT_NEAR(run.state().books.at_start, 0.0, 1e-20);
  run.set_velocity({ParticleId{end}}, {0, 1e-3, 0});
  run.run();
  EXPECT_LT(std::abs(imbalance(run)), 1e-3 * 0.5e-6);
}

TEST(Run, StaticStagesAreRunAsAWhole) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, {bend(), swing()});
  EXPECT_THROW(run.step(), std::invalid_argument);
  EXPECT_THROW(run.end_stage(), std::invalid_argument);
  run.run_stage();
  EXPECT_EQ(run.step(), 1);
}

TEST(Run, AStaticStageThatWasInterruptedBeginsAgain) {
  const Specimen s = testing::straight_rod(5);
  StaticStage slow = bend();
  slow.steps = 8;
  vbond::Run whole(s.model, s.state, {slow}), run(s.model, s.state, {slow});
  whole.run();
  int points = 0;
  RunHooks hooks;
  hooks.balance = [&points](const BodyView&) { ++points; };
  hooks.interrupted = [&points] { return points == 3; };
  run.set_hooks(hooks);
  EXPECT_TRUE(run.run_stage().interrupted());
  EXPECT_EQ(run.state().clock.stage_step, 3);
  EXPECT_TRUE(run.start_of_stage().r == s.state.r);
  run.set_hooks({});
  run.run();
  EXPECT_TRUE(run.state() == whole.state());
}

TEST(Run, AMovingBodyIsToldToComeToRest) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, {bend()});
  std::string told;
  RunHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text; };
  run.set_hooks(hooks);
  run.set_velocity({ParticleId{2}}, {0.1, 0, 0});
  run.run();
  EXPECT_NE(told.find("stage \"bend\": the body was moving"), std::string::npos) << told;
  EXPECT_EQ(run.state().v[ParticleId{2}], Vec3d{});
}

TEST(Run, AStaticLoadIsAddedToTheNextStage) {
  const Specimen s = testing::straight_rod(5);
  vbond::Run run(s.model, s.state, {bend(1e-4)}), twice(s.model, s.state, {bend(2e-4)});
  run.add_load(testing::pushed(end, {0, 1e-4, 0}));
  run.run();
  twice.run();
  EXPECT_NEAR(run.state().r[ParticleId{end}].y, twice.state().r[ParticleId{end}].y, 1e-12);
}

TEST(Run, RefusesCapsulesInStaticStages) {
  Specimen s = testing::straight_rod(5);
  s.model.contact = {.law = ContactLaw::hertz, .E = 10.0, .nu = 0.2};
  for (Bond& b : s.state.bonds) set_capsule(b, 0.2);
  vbond::Run run(s.model, s.state, {bend()});
  try {
    run.run();
    ADD_FAILURE() << "not refused";
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("bonds touch as capsules"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("leave capsule_radius out"), std::string::npos) << e.what();
  }
}

// A bond carries a torque of B4 / 2 = 0.05: of 0.1 that is load factor 0.5.
TEST(Run, AFailedStaticStageKeepsWhatItFound) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  BondRecipe weak;
  weak.parameters = GivenCoefficients{1.0, 0.1, 0.1, 0.1};
  testing::bond(s, 0, 1, weak);
  StaticStage twist =
      testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)},
                            {testing::pushed(1, {}, {0.1, 0, 0})});
  twist.steps = 16;
  vbond::Run run(s.model, s.state, {twist, swing()});
  EXPECT_THROW(run.run(), NoEquilibrium);
  ASSERT_EQ(run.results().size(), 1u);
  const StageResult& failed = run.results()[0];
  EXPECT_EQ(failed.statics->ended, "failed");
  EXPECT_NE(failed.failure.find("no balance found beyond load factor 0."), std::string::npos);
  EXPECT_GT(failed.statics->load_factor, 0.43);
  EXPECT_EQ(run.state().clock.stage_step, failed.steps);  // the last balance
  try {
    run.run_stage();
    ADD_FAILURE() << "goes on after a failure";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("has failed and cannot go on"), std::string::npos) << e.what();
  }
}

TEST(Run, RefusesALaterStageOfAFreeBodyBeforeTheFirst) {
  const Specimen s = testing::straight_rod(5);
  StaticStage loose = bend();
  loose.name = "loose";
  loose.supports[0].held = testing::translations;
  vbond::Run run(s.model, s.state, {swing(), loose});
  try {
    run.run();
    ADD_FAILURE() << "not refused";
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("stage \"loose\": parts of the body can move freely"),
              std::string::npos);
  }
  EXPECT_EQ(run.clock().step, 0);
}

// Held at three points of a line it can turn about it, but not once it is bent: nothing is said before.
TEST(Run, DoesNotRefuseWhatAnEarlierStageMayMend) {
  const Specimen s = testing::straight_rod(5);
  StaticStage pinned = bend();
  pinned.supports = {
      testing::fixed({ParticleId{0}, ParticleId{2}, ParticleId{4}}, {true, true, true, false, false, false})};
  pinned.loads = {testing::pushed(1, {0, 1e-4, 0})};
  EXPECT_EQ(vbond::Run(s.model, s.state, {pinned}).refusals().size(), 1u);
  EXPECT_TRUE(vbond::Run(s.model, s.state, {swing(), pinned}).refusals().empty());
}

TEST(Run, StaticMistakesAreRefusedByStageAndField) {
  const Specimen s = testing::straight_rod(5);
  const auto refuses = [&s](auto change, const std::string& part) {
    StaticStage stage = bend();
    change(stage);
    try {
      vbond::Run(s.model, s.state, {swing(), stage}).check();
      ADD_FAILURE() << "not refused: " << part;
    } catch (const std::invalid_argument& e) {
      const std::string text = e.what();
      EXPECT_NE(text.find("stage 1 \"bend\""), std::string::npos) << text;
      EXPECT_NE(text.find(part), std::string::npos) << text;
    }
    EXPECT_THROW(run_static_stage(s.model, stage, s.state, {}), std::invalid_argument) << part;
  };
  const double nan = std::nan("");
  refuses([](StaticStage& t) { t.supports[0].particles = {ParticleId{5}}; }, "a support names particle 5");
  refuses(
      [](StaticStage& t) {
        t.supports.push_back(t.supports[0]);
        t.supports.back().velocity.x += 0.1;
      },
      "x of particle 0 is held twice, in two ways");
  refuses(
      [](StaticStage& t) {
        t.supports[0].rigid = true, t.supports[0].held = {true, true, true, true};
      },
      "holds one turn: it may hold none, two or all three");
  refuses([](StaticStage& t) { t.supports[0].pivot = Vec3d{}; }, "has a pivot: that is for rigid ones");
  refuses([nan](StaticStage& t) { t.supports[0].velocity.y = nan; }, "the velocity of a support");
  refuses([](StaticStage& t) { t.loads[0].particles = {ParticleId{99}}; }, "a load names particle 99");
  refuses([nan](StaticStage& t) { t.loads[0].force.x = nan; }, "the force of a load");
  refuses([](StaticStage& t) { t.loads[0].moment.x = INFINITY; }, "the moment of a load");
  refuses(
      [](StaticStage& t) {
        t.loads[0].factor = {{{0.0, 2.0}}};
      },
      "a load on \"pushed\" has a factor over time: a stage at rest has none");
  refuses(
      [](StaticStage& t) {
        t.supports[0].factor = {{{0.0, 2.0}}};
      },
      "has a factor over time: a stage at rest has none");
  refuses([nan](StaticStage& t) { t.gravity.z = nan; }, "gravity");
  refuses([](StaticStage& t) { t.steps = 0; }, "steps is 0");
  refuses([](StaticStage& t) { t.newton.tolerance = 0; }, "newton.tolerance is 0");
  refuses([](StaticStage& t) { t.newton.iterations = 0; }, "newton.iterations is 0");
  refuses([](StaticStage& t) { t.kind = StageKind::dynamics; }, "kind = dynamics");
  refuses([](StaticStage& t) { t.kind = StageKind::modes, t.count = 0; }, "count is 0");
  refuses([](StaticStage& t) { t.kind = StageKind::path, t.path.first_step = 0; }, "path.first_step is 0");
  refuses(
      [](StaticStage& t) {
        t.kind = StageKind::path, t.path.distance = {{}, ParticleId{7}, 1.0, true};
      },
      "the stop at a distance names particle 7");
}

TEST(Run, StaticsRefuseAStateOfAnotherSize) {
  Specimen s = testing::straight_rod(5);
  s.state.q.resize(4);
  EXPECT_THROW(run_static_stage(s.model, bend(), s.state, {}), std::invalid_argument);
  EXPECT_THROW(refuse_free_bodies(s.model, bend(), s.state), std::invalid_argument);
  EXPECT_THROW(choose_solver(s.model, bend(), s.state), std::invalid_argument);
  EXPECT_THROW(exact_critical_step(s.model, s.state, {}), std::invalid_argument);
}

}  // namespace
}  // namespace vbond
