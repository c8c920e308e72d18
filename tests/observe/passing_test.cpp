#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "vbond/core/error.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/observe/observers.hpp"

namespace vbond {
namespace {

/// Two balls of radius 0.4 and mass 1 that fly at each other along x, and what becomes of them.
struct Flight {
  double speed = 1.0;  ///< of one against the other
  double aside = 0.0;  ///< distance of the lines on which they fly
  double apart = 2.0;  ///< at first, along x
  double step = 0.0;   ///< 0: a tenth of the critical one
  double overlap = 0.1;
  ContactModel contact{ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0, 0};
  std::vector<Vec3d> others{};
  double duration = 0.0;     ///< 0: until they have met
  std::int64_t every = 100;  ///< steps between looks at the balance

  std::vector<std::string> told{};
  std::string failure{};
  double x = 0.0;  ///< of the second against the first at the end: below zero if they have changed places

  Flight& fly(bool watched = true) {
    std::vector<Vec3d> r{{0, 0, 0}, {apart, aside, 0}};
    r.insert(r.end(), others.begin(), others.end());
    const Model model = [&] {
      Model m = equal_particles(r, 1.0, 0.064, 0.4);
      m.contact = contact;
      return m;
    }();
    State state = at_rest(model);
    state.v[ParticleId{0}].x = 0.5 * speed;
    state.v[ParticleId{1}].x = -0.5 * speed;
    Stage stage;
    stage.dt = step > 0.0 ? step : 0.1 * step_bound(model, state).dt;
    stage.stops.duration =
        duration > 0.0 ? duration : 2.0 * apart / speed + 8.0 * stage.dt + (speed < 1.0 ? 20.0 : 0.0);
    Simulation run(model, stage, state);
    OutputPlan plan;
    plan.history_every = 1e9;
    plan.overlap = overlap;
    plan.watch_every = every;
    if (watched)
      run.add_observer(
          std::make_shared<WatchObserver>(plan, [this](const std::string& text) { told.push_back(text); }));
    try {
      while (run.clock().stage_time() < stage.stops.duration) run.step();
    } catch (const Diverged& e) {
      failure = e.what();
    }
    x = run.state().r[ParticleId{1}].x - run.state().r[ParticleId{0}].x;
    return *this;
  }
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A pair whose radii are 0.4 as the watch is shown it, step by step.
struct Shown {
  Model model = equal_particles({{0, 0, 0}, {5, 0, 0}}, 1.0, 0.064, 0.4);
  State state = at_rest(model);
  std::vector<std::string> told;
  Watch watch;
  explicit Shown(WatchRecord record = {})
      : watch(
            0.05, [this](const std::string& text) { told.push_back(text); }, std::move(record)) {
    model.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0, 0};
    state.clock.dt = 0.1;
  }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;
  void show(std::int64_t step, const Vec3d& r) {
    state.clock.step = state.clock.stage_step = step;
    watch.look_at_encounters(model, {{ParticleId{0}, ParticleId{1}, r, r}}, state.clock, 0.1,
                             [this]() -> const State& { return state; });
  }
};

// The contact stores 2/5 0.8^(5/2) = 0.229 where the centres meet: from a relative speed of 0.957 on it
// cannot hold them, whatever the step. Flights begin at several distances, so that steps end at different
// places.
TEST(Passing, HeadOnIsNeverSilentAndNobodyElseIsStopped) {
  int passed = 0, held = 0;
  for (const double speed : {0.05, 0.3, 0.9, 0.94, 0.97, 1.0, 1.3, 2.2, 5.0, 10.0, 20.0, 200.0, 1e4, 1e6})
    for (const double apart : {2.0, 2.1, 2.23, 2.37, 2.5}) {
      const bool changed_places = Flight{.speed = speed, .apart = apart}.fly(false).x < 0.0;
      const Flight seen = Flight{.speed = speed, .apart = apart}.fly();
      EXPECT_EQ(!seen.failure.empty(), changed_places) << speed << ", " << apart << ": " << seen.failure;
      EXPECT_EQ(contains(seen.failure, "particles 0 and 1: they have passed through one another"),
                changed_places)
          << seen.failure;
      ++(changed_places ? passed : held);
    }
  EXPECT_GE(passed, 45);
  EXPECT_GE(held, 15);
}

// Energy is not what lets them pass here: smaller steps would hold them, and the message says which.
TEST(Passing, TheStepThatWouldDoDoes) {
  ContactModel stiff{ContactLaw::paper_hertz, ContactPairs::unbonded, 1e3, 1.0, 0, 0};
  const Flight seen = Flight{.speed = 5.0, .apart = 1.2, .step = 0.4, .contact = stiff}.fly();
  ASSERT_TRUE(contains(seen.failure, "use time.step = ")) << seen.failure;
  const double advised = std::stod(seen.failure.substr(seen.failure.find("time.step = ") + 12));
  EXPECT_LT(advised, 0.05);
  const Flight mended = Flight{.speed = 5.0, .apart = 1.2, .step = advised, .contact = stiff}.fly();
  EXPECT_EQ(mended.failure, "");
  EXPECT_GT(mended.x, 0.0);
}

TEST(Passing, WhereNoStepHelpsItSaysSo) {
  const Flight seen = Flight{.speed = 2.2}.fly();
  EXPECT_TRUE(contains(seen.failure, "this contact stores 0.229 at most, and their motion holds 1."))
      << seen.failure;
  EXPECT_TRUE(contains(seen.failure, "their radii are 0.4 and 0.4, their relative speed is "))
      << seen.failure;
  EXPECT_TRUE(contains(seen.failure, "stiffer contact")) << seen.failure;
}

TEST(Passing, WhereTheStepIsNotToBlameItSaysSo) {
  Shown s;  // at rest, as far as the state knows
  s.show(7, {0.5, 0.1, 0});
  try {
    s.show(8, {-0.5, 0.1, 0});
    ADD_FAILURE() << "nobody was stopped";
  } catch (const Diverged& e) {
    EXPECT_TRUE(contains(e.what(), "the step is small enough: use a stiffer contact")) << e.what();
  }
}

// Off the axis by up to 0.3 the line of centres turns by more than a right angle while they are nearer than
// 0.6.
TEST(Passing, AsideIsToldAsWell) {
  for (const double speed : {2.2, 5.0, 20.0, 1e3})
    for (const double apart : {2.0, 2.1, 2.23, 2.37, 2.5}) {
      for (const double aside : {0.1, 0.2, 0.3}) {
        const Flight seen = Flight{.speed = speed, .aside = aside, .apart = apart}.fly();
        EXPECT_NE(seen.failure, "") << speed << ", " << apart << ", " << aside;
      }
      const Flight grazing = Flight{.speed = speed, .aside = 0.58, .apart = apart}.fly();
      EXPECT_EQ(grazing.failure, "");
      const Flight missing = Flight{.speed = speed, .aside = 0.85, .apart = apart}.fly();
      EXPECT_EQ(missing.failure, "");
    }
}

TEST(Passing, TooFastIsToldBeforeAnythingHappensAndAgainWhenTwiceAsFast) {
  // 0.1 a step each; 0.1 is an eighth of the sum of the radii
  const Flight slow = Flight{.speed = 1.98, .apart = 30.0, .step = 0.1, .duration = 5.0}.fly();
  ASSERT_EQ(slow.told.size(), 0u) << slow.told[0];
  const Flight fast = Flight{.speed = 2.02, .apart = 30.0, .step = 0.1, .duration = 5.0}.fly();
  ASSERT_GE(fast.told.size(), 1u);
  EXPECT_TRUE(contains(fast.told[0], "step 1: particle 0 moves by 0.101 in a step, at a speed of 1.01"))
      << fast.told[0];
  EXPECT_TRUE(contains(fast.told[0], "time.step = 0.0891 would do")) << fast.told[0];
  EXPECT_EQ(Flight({.speed = 2.02, .apart = 30.0, .step = 0.0891, .duration = 5.0}).fly().told.size(), 0u);

  std::vector<std::string> told;
  Watch watch(0.05, [&told](const std::string& text) { told.push_back(text); });
  Clock clock;
  clock.dt = 0.1;
  for (const double way : {1.1, 2.1, 2.3, 1.5, 4.7}) watch.look_at_speed({ParticleId{3}, way, 1.0}, clock);
  EXPECT_EQ(told.size(), 3u);  // 1.1, 2.3, 4.7
}

// A body may fly as fast as it likes; the mean of three is that of all.
TEST(Passing, ABodyThatFliesAsAWholeIsNotFast) {
  Model model = equal_particles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1.0, 0.064, 0.4);
  model.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0, 0};
  State state = at_rest(model);
  for (Vec3d& v : state.v) v = {1e3, 0, 0};
  Stage stage;
  stage.dt = 0.1;
  Simulation run(model, stage, state);
  run.step();
  EXPECT_FALSE(run.deep().particles.fastest());
  EXPECT_TRUE(run.deep().particles.found().empty());
}

TEST(Passing, CanBeSwitchedOff) {
  for (const double speed : {1.3, 20.0}) {
    const Flight unwatched = Flight{.speed = speed, .overlap = 0.0}.fly();
    EXPECT_EQ(unwatched.failure, "");
    EXPECT_TRUE(unwatched.told.empty());
    EXPECT_LT(unwatched.x, 0.0);
  }
}

// Without a contact law nothing is deep: only the look at overlaps after a thousand steps finds it.
TEST(Passing, AnOverlapWithoutAContactLawIsToldUnlessSwitchedOff) {
  const auto told = [](double overlap) {
    return Flight{.step = 0.0015, .overlap = overlap, .contact = {}, .duration = 1.5}.fly().told;
  };
  ASSERT_EQ(told(0.1).size(), 1u);
  EXPECT_TRUE(contains(told(0.1)[0], "t = 1.5: particles 0 and 1 are not bonded and overlap by 0.3, 0.75 of"))
      << told(0.1)[0];
  EXPECT_EQ(told(0.0).size(), 0u);
}

// Whatever passes: many others stand around, in other blocks of rows.
TEST(Passing, IsSeenAmongMany) {
  std::vector<Vec3d> crowd;
  for (int k = 0; k < 600; ++k) crowd.push_back({1.0 * (k % 30), 3.0 + 0.05 * k, 5.0});
  for (const double speed : {1.1, 20.0}) {
    const Flight seen = Flight{.speed = speed, .others = crowd}.fly();
    EXPECT_TRUE(contains(seen.failure, "particles 0 and 1: they have passed")) << seen.failure;
  }
}

TEST(Passing, ALineOfCentresThatTurnsByMoreThanARightAngleHasPassed) {
  Shown s;
  s.show(7, {0.5, 0.1, 0});
  s.show(8, {0.1, 0.4, 0});
  s.show(9, {-0.05, 0.4, 0});
  ASSERT_EQ(s.told.size(), 1u);  // one overlap, once: at step 7 centres are sqrt(0.26) apart
  EXPECT_TRUE(contains(s.told[0], "particles 0 and 1 are not bonded and overlap by 0.2901, 0.725 of the"))
      << s.told[0];
  try {
    s.show(10, {-0.1, 0.45, 0});
    ADD_FAILURE() << "nobody was stopped";
  } catch (const Diverged& e) {
    EXPECT_EQ(e.step, 10);
    EXPECT_TRUE(contains(e.what(), "their centres came within 0.403")) << e.what();  // at step 9
  }
}

TEST(Passing, APairThatWasApartMeanwhileBeginsAnew) {
  Shown s;
  s.show(7, {0.5, 0.1, 0});
  EXPECT_NO_THROW(s.show(9, {-0.5, 0.1, 0}));
}

TEST(Passing, IsRememberedAcrossACheckpoint) {
  Shown before;
  before.show(7, {0.5, 0.1, 0});
  Shown resumed(before.watch.record());
  EXPECT_THROW(resumed.show(8, {-0.5, 0.1, 0}), Diverged);
  EXPECT_TRUE(resumed.told.empty());
}

// Two that jump through one another into a stiff contact: in the same step the balance is off, too.
TEST(Passing, IsNamedBeforeTheBalanceThatItBreaks) {
  Flight f{.speed = 12.0, .apart = 0.9, .step = 0.1, .duration = 1.0, .every = 1};
  f.contact.c_H = 1e4;
  f.fly();
  EXPECT_TRUE(contains(f.failure, "particles 0 and 1: they have passed through one another")) << f.failure;
  f.overlap = 0.0;
  f.fly();
  EXPECT_TRUE(contains(f.failure, "the energy balance is off")) << f.failure;
}

}  // namespace
}  // namespace vbond
