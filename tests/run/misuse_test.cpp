#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "misuse_parts.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/run/static_solver.hpp"

namespace vbond::misuse_test {
namespace {

TEST(Misuse, NothingIsRefusedThatIsRight) {
  EXPECT_EQ(Parts().run()->run().size(), 2u);
}

TEST(Misuse, ColumnsOfAnotherSize) {
  refuses([](Parts& p) { p.body.state = {}; }, "begin with at_rest(model)");
  refuses([](Parts& p) { p.body.state.r.resize(3); },
          "the state has 3 entries in particles/r for 4 particles");
  refuses([](Parts& p) { p.body.state.v.resize(5); }, "5 entries in particles/v");
  refuses([](Parts& p) { p.body.state.q.resize(0); }, "0 entries in particles/q");
  refuses([](Parts& p) { p.body.state.omega.resize(3); }, "3 entries in particles/omega");
  refuses([](Parts& p) { p.body.model.mass.resize(3, 1.0); }, "the model has 4 entries in inertia");
  refuses([](Parts& p) { p.body.model.radius.resize(3); }, "3 entries in radius");
  refuses([](Parts& p) { p.body.model.r_0.resize(3); }, "3 entries in r_0");
  refuses([](Parts& p) { p.body.model.specimen.resize(3); }, "3 entries in specimen");
}

// A support that swings within a few steps does not do what it was told.
TEST(Misuse, FewStepsInASwing) {
  const auto swing = [](Parts& p) {
    p.second.supports[0].velocity = {1e-3, 0, 0};
    for (int k = 0; k <= 10; ++k)
      p.second.supports[0].factor.points.push_back({0.1 * k, k % 2 == 0 ? 1.0 : -1.0});
  };
  refuses(swing,
          "dt is 0.05, 4 steps in a period of 0.2 of the factor over time of the support of group \"held\"; "
          "10 are the fewest: use 0.01, 20 steps a period, or insist = true");
  Parts insists;
  swing(insists);
  insists.second.insist = true;
  EXPECT_EQ(insists.run()->run().size(), 2u);
}

TEST(Misuse, AnEmptyModelOrNoStage) {
  expect_refusal([] { vbond::Run(Model{}, State{}, {Stage{}}); }, "the model has no particles");
  const Parts p;
  expect_refusal([&p] { vbond::Run(p.body.model, p.body.state, std::vector<AnyStage>{}); },
                 "there is no stage to run");
  expect_refusal([&p] { vbond::Run(p.body.model, p.body.state, std::unique_ptr<const Stages>{}); },
                 "there is no stage");
}

TEST(Misuse, NumbersThatAreNone) {
  for (const double bad : {nan, infinite, -infinite}) {
    refuses([bad](Parts& p) { p.body.state.r[ParticleId{2}].y = bad; }, "the position of particle 2 is (");
    refuses([bad](Parts& p) { p.body.state.v[ParticleId{1}].z = bad; }, "the velocity of particle 1");
    refuses([bad](Parts& p) { p.body.state.omega[ParticleId{3}].x = bad; },
            "the angular velocity of particle 3");
    refuses([bad](Parts& p) { p.body.state.q[ParticleId{0}].w = bad; }, "the orientation of particle 0");
    refuses([bad](Parts& p) { p.body.model.mass[ParticleId{2}] = bad; }, "the mass of particle 2");
    refuses([bad](Parts& p) { p.body.model.inertia[ParticleId{2}] = bad; }, "the inertia of particle 2");
    refuses([bad](Parts& p) { p.body.model.radius[ParticleId{2}] = bad; }, "the radius of particle 2");
    refuses([bad](Parts& p) { p.body.model.r_0[ParticleId{2}].x = bad; }, "r_0 of particle 2");
    refuses([bad](Parts& p) { p.second.gravity.x = bad; }, "stage 1 \"second\": gravity");
    refuses([bad](Parts& p) { p.second.loads[0].force.x = bad; }, "the force of a load on \"end\"");
    refuses([bad](Parts& p) { p.second.loads[0].moment.x = bad; }, "the moment of a load");
    refuses([bad](Parts& p) { p.second.supports[0].velocity.x = bad; }, "the velocity of a support");
    refuses([bad](Parts& p) { p.second.supports[0].angular_velocity.x = bad; },
            "the angular velocity of a support");
    refuses([bad](Parts& p) { p.second.b_translation = bad; }, "the damping is");
  }
}

TEST(Misuse, MassesAndDampingOutOfRange) {
  for (const double bad : {0.0, -1.0}) {
    refuses([bad](Parts& p) { p.body.model.mass[ParticleId{2}] = bad; }, "must be > 0 and finite");
    refuses([bad](Parts& p) { p.body.model.inertia[ParticleId{2}] = bad; }, "must be > 0 and finite");
  }
  refuses([](Parts& p) { p.body.model.radius[ParticleId{2}] = -0.1; }, "must be >= 0 and finite");
  refuses([](Parts& p) { p.second.b_rotation = -1e-3; }, "the damping is");
}

TEST(Misuse, OrientationsThatAreNotRotations) {
  refuses([](Parts& p) { p.body.state.q[ParticleId{1}] = {0, 0, 0, 0}; }, "must be a unit quaternion");
  refuses([](Parts& p) { p.body.state.q[ParticleId{1}] = {1, 0.1, 0, 0}; }, "must be a unit quaternion");
}

TEST(Misuse, StepsOutOfRange) {
  for (const double bad : {0.0, -0.1, nan, infinite})
    refuses([bad](Parts& p) { p.second.dt = bad; }, "stage.dt must be above zero");
  refuses([](Parts& p) { p.second.dt = 5.0; }, "above 1 the run may blow up");
  Parts insisting;
  insisting.first.dt = 1.01, insisting.first.insist = true;
  EXPECT_EQ(insisting.run()->step(), 1);
}

TEST(Misuse, TimesOutOfRange) {
  for (const double bad : {0.0, -1.0, nan})
    refuses([bad](Parts& p) { p.second.stops.duration = bad; }, "the duration is");
  refuses([](Parts& p) { p.second.stops.rest = RestStop{1e-9, 0.0}; }, "the stop at rest is during 0");
  refuses([](Parts& p) { p.second.stops.rest = RestStop{nan, 1.0}; }, "the stop at rest is below nan");
  refuses([](Parts& p) { p.second.loads[0].factor.points = {{1, 0}, {0, 1}}; }, "points in increasing time");
  refuses([](Parts& p) { p.second.loads[0].factor.points = {{nan, 0}}; }, "has the point (nan, 0)");
}

TEST(Misuse, ParticlesThatThereAreNot) {
  const ParticleId fifth{4};
  refuses([=](Parts& p) { p.body.state.bonds[BondId{0}].j = fifth; },
          "bonds[0].j is particle 4, and there are 4");
  refuses([](Parts& p) { p.body.state.bonds[BondId{1}].j = p.body.state.bonds[BondId{1}].i; },
          "bonds[1] joins a particle with itself");
  refuses([=](Parts& p) { p.second.supports[0].particles = {fifth}; }, "a support names particle 4");
  refuses([=](Parts& p) { p.second.loads[0].particles.push_back(fifth); }, "a load names particle 4");
  refuses([=](Parts& p) { p.body.model.groups[0].particles = {fifth}; }, "group \"all\" names particle 4");
  refuses(
      [](Parts& p) {
        p.body.model.groups[0].particles = {ParticleId{1}, ParticleId{0}};
      },
      "in increasing order");
  refuses(
      [=](Parts& p) {
        p.second.stops.distance = {ParticleId{0}, fifth, 1.0, true};
      },
      "the stop at a distance");
  refuses(
      [](Parts& p) {
        p.second.stops.distance = {ParticleId{1}, ParticleId{1}, 1.0, true};
      },
      "and itself");
  refuses(
      [=](Parts& p) {
        p.second.strain = StrainProgram{{fifth}, {1, 0, 0}, {}, 1e-3, 0.1};
      },
      "the imposed strain names");
  refuses([](Parts& p) { p.second.strain = StrainProgram{{}, {2, 0, 0}, {}, 1e-3, 0.1}; }, "a unit vector");
  refuses(
      [](Parts& p) {
        p.second.bonding = {{"glue", {1}, {1}, 1.0, testing::papers_bond()}};
      },
      "a bonding rule must say of each particle");
  refuses(
      [](Parts& p) {
        const std::vector<char> all(4, 1);
        p.second.bonding = {{"glue", all, all, 1.0, testing::papers_bond()}};
        p.second.bonding[0].recipe.prestrain = 0.02;
        p.second.bonding[0].recipe.rules.strength = elongation_strength(0.01);
      },
      "bonding rule \"glue\": its prestrain alone breaks its bonds");
}

TEST(Misuse, PeaksThatAreNone) {
  const auto peak = [](std::vector<ParticleId> of, double drop, double over) {
    return PeakStop{PeakQuantity::compressive_force, std::move(of), {}, drop, over};
  };
  refuses([&](Parts& p) { p.second.stops.peak = peak({ParticleId{9}}, 0.1, 1); }, "the stop at a peak names");
  refuses(
      [&](Parts& p) {
        p.second.stops.peak = peak({ParticleId{1}, ParticleId{0}}, 0.1, 1);
      },
      "the stop at a peak does not name its particles in increasing order");
  refuses([&](Parts& p) { p.second.stops.peak = peak({}, 1.0, 1); }, "drop = 1");
  refuses([&](Parts& p) { p.second.stops.peak = peak({}, 0.1, 0); }, "averages over 0");
}

TEST(Misuse, DegreesOfFreedomHeldInTwoWays) {
  refuses(
      [](Parts& p) {
        p.second.supports.push_back(p.second.supports[0]);
        p.second.supports.back().velocity.x += 1.0;
      },
      "x of particle 0 is held twice, in two ways");
}

TEST(Misuse, GripsThatAreNone) {
  const auto rigid = [](Parts& p) -> Support& {
    Support& s = p.second.supports[0];
    s.rigid = true;
    s.held = all_held;
    return s;
  };
  refuses([&](Parts& p) { rigid(p).held = {true, true, true, true, false, false}; }, "holds one turn");
  refuses([&](Parts& p) { rigid(p).particles.clear(); }, "is rigid and has no particles");
  refuses([&](Parts& p) { rigid(p).pivot = Vec3d{nan, 0, 0}; }, "the pivot of a support");
  refuses([&](Parts& p) { p.second.supports[0].pivot = Vec3d{}; }, "has a pivot: that is for rigid ones");
  refuses(
      [&](Parts& p) {
        p.second.strain = StrainProgram{rigid(p).particles, {1, 0, 0}, {}, 0.1, 1.0};
      },
      "the imposed strain moves particles of a rigid support");
  // a grip that turns agrees with a grip that turns alike about the same axis, and with nothing else
  const auto turning = [&](Parts& p, const Vec3d& pivot) {
    Support& s = rigid(p);
    s.angular_velocity = {0, 0, 0.1};
    s.pivot = pivot;
    Support other = s;
    other.pivot = Vec3d{1, 0, 3};
    p.second.supports.push_back(other);
  };
  refuses([&](Parts& p) { turning(p, {0, 0, 0}); }, "x of particle 0 is held twice, in two ways");
  refuses(
      [&](Parts& p) {
        turning(p, {1, 0, 0});
        p.second.supports[1].factor.points = {{0, 0}, {1, 1}};
      },
      "x of particle 0 is held twice, in two ways");
  Parts p;
  turning(p, {1, 0, 0});
  EXPECT_TRUE(mistakes_in(p.body.model, p.second).empty());
}

TEST(Misuse, AllMistakesOfAllStagesAtOnce) {
  Parts p;
  p.first.dt = 0;
  p.second.dt = nan;
  p.second.loads[0].particles = {ParticleId{7}};
  const std::string text = refusal([&p] { p.run()->check(); });
  for (const char* part :
       {"stage 0 \"test\": dt is 0", "stage 1 \"second\"", "dt is nan", "a load names particle 7"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(Misuse, AStateOfAnotherRun) {
  refuses([](Parts& p) { p.body.state.clock.stage = 3; }, "the state is in stage 3");
  refuses([](Parts& p) { p.body.state.clock.stage = -1; }, "none may be below zero");
  refuses([](Parts& p) { p.body.state.clock.step = -5; }, "none may be below zero");
  refuses([](Parts& p) { p.body.state.clock.dt = nan; }, "none may be below zero");
  refuses([](Parts& p) { p.body.state = testing::straight_rod(5).state; },
          "5 entries in particles/r for 4 particles");
  // under way with another step
  const Parts p;
  const auto run = p.run();
  run->step(3);
  Parts other;
  other.body.state = run->state();
  other.first.dt = 0.04;
  expect_refusal([&other] { other.run()->step(); }, "under way in this stage with dt = 0.05");
}

TEST(Misuse, ThreadsStepsAndObserversThatAreNone) {
  refuses([](Parts& p) { p.threads = 0; }, "threads = 0");
  refuses([](Parts& p) { p.threads = -3; }, "threads = -3");
  const auto run = Parts().run();
  expect_refusal([&run] { run->step(-1); }, "step(-1)");
  expect_refusal([&run] { run->add_observer(nullptr); }, "the observer is null");
  EXPECT_EQ(run->step(2), 2);
}

TEST(Misuse, GoingOnBehindTheEnd) {
  const auto run = Parts().run();
  run->run();
  for (const std::function<void()>& misuse : {std::function<void()>([&run] { run->run(); }),
                                              {[&run] { run->step(); }},
                                              {[&run] { run->run_stage(); }},
                                              {[&run] { run->end_stage(); }},
                                              {[&run] { run->prepare(); }},
                                              {[&run] { run->begin(); }},
                                              {[&run] { run->set_velocity({}, {}); }},
                                              {[&run] { run->add_load(PointLoad{}); }}})
    expect_refusal(misuse, "all its stages are behind it");
  EXPECT_EQ(run->state().clock.stage, 2);
}

TEST(Misuse, ChangesThatDoNotFit) {
  const auto run = Parts().run();
  run->step(5);
  const State before = run->state();
  expect_refusal([&run] { run->set_velocities(PerParticle<Vec3d>(3), PerParticle<Vec3d>(4)); },
                 "3 entries in particles/v");
  expect_refusal(
      [&run] {
        run->set_velocities(PerParticle<Vec3d>(4, {nan, 0, 0}), PerParticle<Vec3d>(4));
      },
      "the velocity of particle 0");
  expect_refusal([&run] { run->set_velocity({ParticleId{4}}, {}); }, "particle 4 of 4");
  expect_refusal([&run] { run->set_velocity({}, {nan, 0, 0}); }, "must be finite");
  expect_refusal(
      [&run] {
        run->add_load(PointLoad{"x", {ParticleId{4}}, {}, {}, {}});
      },
      "a load names particle 4");
  expect_refusal([&run] { run->add_load(PointLoad{"x", {}, {nan, 0, 0}, {}, {}}); }, "the force of a load");
  expect_refusal([&run] { run->add_load(PointLoad{.constant = true}); },
                 "a load is constant: in motion a load has a factor over time");
  EXPECT_TRUE(run->state() == before);
  EXPECT_EQ(run->run().size(), 2u);
}

TEST(Misuse, StartOfAStageThatIsUnderWay) {
  const auto run = Parts().run();
  EXPECT_EQ(run->start_of_stage().clock.step, 0);
  run->step();
  expect_refusal([&run] { run->start_of_stage(); }, "the stage is under way");
}

// Two bonded particles in one place: the bond has no direction. Nothing is lost, and nothing goes on.
TEST(Misuse, AStageThatCannotBeginLeavesTheState) {
  Parts p;
  p.body.state.r[ParticleId{1}] = p.body.state.r[ParticleId{0}];
  const auto run = p.run();
  EXPECT_THROW(run->step(), Diverged);
  EXPECT_TRUE(run->state().r == p.body.state.r);
  EXPECT_EQ(run->state().bonds.size(), 3u);
}

TEST(Misuse, AfterAFailureNothingGoesOn) {
  Parts p;
  p.first.dt = 3.0, p.first.insist = true, p.first.stops.duration = 1e6;
  p.body.state.v[ParticleId{0}] = {0.5, 0.1, 0};
  const auto run = p.run();
  EXPECT_THROW(run->run(), Diverged);
  ASSERT_EQ(run->results().size(), 1u);
  EXPECT_EQ(run->results()[0].stop, StopReason::diverged);
  EXPECT_FALSE(run->results()[0].failure.empty());
  EXPECT_EQ(run->state().r.size(), 4u);
  for (const std::function<void()>& misuse : {std::function<void()>([&run] { run->run(); }),
                                              {[&run] { run->step(); }},
                                              {[&run] { run->set_velocity({}, {}); }},
                                              {[&run] { run->end_stage(); }}})
    expect_refusal(misuse, "has failed and cannot go on");
}

TEST(Misuse, StaticStagesOfALibraryWithoutStatics) {
  if (has_statics()) GTEST_SKIP() << "built with statics";
  const Parts p;
  StaticStage bend;
  bend.name = "bend";
  expect_refusal(
      [&] {
        vbond::Run(p.body.model, p.body.state, {p.first, bend}).run();
      },
      "stage 1 \"bend\": it is static: this vbond was built without statics");
}

static_assert(!std::is_copy_constructible_v<vbond::Run> && !std::is_copy_assignable_v<vbond::Run>);
static_assert(std::is_constructible_v<vbond::Run, Model, State, std::vector<AnyStage>>);

TEST(Misuse, WhatBondsAndContactsRememberFitsTheBody) {
  const testing::Specimen good = testing::straight_rod(3);
  const auto refused = [&](auto spoil, const char* part) {
    testing::Specimen s = good;
    spoil(s);
    try {
      const vbond::Run run(s.model, s.state, {testing::plain_stage(0.1, 1.0)});
      ADD_FAILURE() << "taken: " << part;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  using S = testing::Specimen;
  refused([](S& s) { s.state.bond_history.resize(1); }, "1 entries in bonds/history for 2 bonds");
  refused([](S& s) { s.state.loads.F.resize(3); }, "the state has 0 entries in loads/M for 3 particles");
  refused(
      [](S& s) {
        s.state.damping = {PerParticle<Vec3d>(2), PerParticle<Vec3d>(2)};
      },
      "2 entries in loads/damping_M for 3 particles");
  refused(
      [](S& s) {
        s.state.contact_history = {{ParticleId{0}, ParticleId{7}}};
      },
      "contacts[0].j is particle 7, and there are 3");
  refused(
      [](S& s) {
        s.state.wall_history = {{ParticleId{0}, 2, {}, {}}};
      },
      "wall_touches[0] names a wall that is not there");
  refused([](S& s) { s.state.walls.resize(2); }, "2 walls for 0 of the model");
  refused([](S& s) { s.state.bonds[BondId{1}].law = nullptr; }, "bonds[1] has no law");
  refused([](S& s) { s.model.contact.surface.friction = -0.1; }, "contact.friction is -0.1");
  refused([](S& s) { s.model.contact.surface.restitution = 1.5; }, "contact.restitution is 1.5");
  refused([](S& s) { s.model.material.assign(3, 4); }, "one is number 4, and there are 1");
}

}  // namespace
}  // namespace vbond::misuse_test
