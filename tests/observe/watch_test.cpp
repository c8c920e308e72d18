#include "vbond/observe/watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "dynamics/spheres_and_walls.hpp"
#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/statics/point_view.hpp"

namespace vbond::watch_test {
namespace {

using test::Chain;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double allowed = 0.05;

std::vector<BondId> all_bonds(const Chain& chain) {
  std::vector<BondId> all;
  for (const BondId k : chain.state.bonds.ids()) all.push_back(k);
  return all;
}

/// A watch that writes down what it is told.
struct Listener {
  std::vector<std::string> told;
  Watch watch;
  explicit Listener(WatchRecord record = {})
      : watch(
            allowed, [this](const std::string& text) { told.push_back(text); }, std::move(record)) {}
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Shows it every bond: it judges for itself.
  void look(const Chain& chain, const Energies& energies = {}, double error = 0.0) {
    watch.look({energies, all_bonds(chain)}, error, [&chain]() -> const State& { return chain.state; });
  }
};

RangeCounts count_all(const Chain& chain) {
  return count_ranges(chain.state, all_bonds(chain));
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string failure(Listener& l, const Chain& chain, const Energies& energies = {}, double error = 0.0) {
  try {
    l.look(chain, energies, error);
  } catch (const Diverged& e) {
    EXPECT_EQ(e.step, 1200);
    return e.what();
  }
  return "no error";
}

TEST(Watch, RestIsQuiet) {
  Listener l;
  l.look(Chain());
  EXPECT_TRUE(l.told.empty());
  EXPECT_EQ(count_all(Chain()), (RangeCounts{0, 0}));
}

TEST(Watch, TwistBeyond90DegreesIsReportedOnceAsSnapped) {
  Chain chain(2);
  chain.turn(1, {1, 0, 0}, 91 * degree);
  EXPECT_EQ(count_all(chain), (RangeCounts{0, 1}));
  Listener l;
  l.look(chain);
  l.look(chain);
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(contains(l.told[0], "bond 0 (particles 0, 1) has snapped")) << l.told[0];
  EXPECT_TRUE(contains(l.told[0], "t = 120:")) << l.told[0];
  EXPECT_TRUE(contains(l.told[0], "tilted by 0.0 and 0.0 degrees and twisted by")) << l.told[0];
  EXPECT_TRUE(contains(l.told[0], "91.0")) << l.told[0];
}

TEST(Watch, OfAStaticPointTheLoadFactorIsTold) {
  Chain chain(2);
  chain.turn(1, {1, 0, 0}, 91 * degree);
  Listener l;
  const StaticPoint point{chain.state, 0.75, PointKind::regular, {}, {}, {}};
  l.watch.look(PointView(chain.model, point));
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_EQ(l.told[0].rfind("load factor 0.75: bond 0 (particles 0, 1) has snapped", 0), 0u) << l.told[0];
}

TEST(Watch, EachWorseningIsReportedOnceAndRecoveryIsNot) {
  Chain strained(2), snapped(2);
  strained.turn(1, {0, 0, 1}, 46 * degree);
  snapped.turn(1, {0, 0, 1}, 91 * degree);
  Listener l;
  for (const Chain* c : {&strained, &snapped, &strained, &snapped}) l.look(*c);
  l.look(Chain(2));
  l.look(strained);
  ASSERT_EQ(l.told.size(), 2u);
  EXPECT_TRUE(contains(l.told[0], "is strained")) << l.told[0];
  EXPECT_TRUE(contains(l.told[0], "tilted by 0.0 and 46.0 degrees")) << l.told[0];
  EXPECT_TRUE(contains(l.told[1], "has snapped")) << l.told[1];
  EXPECT_EQ(l.watch.record().strained, 1);
  EXPECT_EQ(l.watch.record().snapped, 1);
}

TEST(Watch, StateIsCollectedOnlyIfThereIsSomethingToLookAt) {
  Chain chain;
  chain.turn(2, {1, 0, 0}, 91 * degree);
  Listener l;
  int collected = 0;
  const auto collect = [&]() -> const State& {
    ++collected;
    return chain.state;
  };
  l.watch.look({}, allowed, collect);
  EXPECT_EQ(collected, 0);
  EXPECT_EQ(l.watch.record().bonds.size(), 0u);
  l.watch.look({{}, {BondId{0}}}, 0.0, collect);  // shown, but good
  EXPECT_EQ(collected, 1);
  EXPECT_TRUE(l.told.empty());
  l.watch.look({{}, {BondId{1}}}, 0.0, collect);
  EXPECT_EQ(collected, 2);
  EXPECT_EQ(l.told.size(), 1u);
  EXPECT_THROW(l.watch.look({}, 1.01 * allowed, collect), Diverged);
  EXPECT_EQ(collected, 3);
}

TEST(Watch, RecordReachesAsFarAsTheLastBondReported) {
  Chain chain(5);
  chain.turn(2, {1, 0, 0}, 60 * degree);  // bonds 1 and 2; only the V-model of bond 2 minds
  Listener l;
  l.look(chain);
  ASSERT_EQ(l.watch.record().bonds.size(), 3u);
  EXPECT_EQ(l.watch.record().bonds[BondId{1}].worst, BondRange::good);
  EXPECT_EQ(l.watch.record().bonds[BondId{2}].worst, BondRange::strained);
}

TEST(Watch, JustInsideTheRangeIsQuiet) {
  Chain chain(2);
  chain.turn(1, {1, 0, 0}, 44.9 * degree);
  Listener l;
  l.look(chain);
  EXPECT_TRUE(l.told.empty());
}

TEST(Watch, ManyReportsAreCutAndSummedUpOnce) {
  Chain chain(28);
  for (std::size_t k = 1; k < 28; k += 2)
    chain.turn(k, {1, 0, 0}, 60 * degree);  // past the limit of the 14 bonds that are V-models
  Listener l;
  l.look(chain);
  EXPECT_EQ(l.told.size(), static_cast<std::size_t>(Watch::told_in_full));
  l.watch.summarise();
  l.watch.summarise();
  ASSERT_EQ(l.told.size(), static_cast<std::size_t>(Watch::told_in_full) + 1);
  EXPECT_TRUE(contains(l.told.back(), "4 more bonds were strained: 14 in all")) << l.told.back();
}

TEST(Watch, ManyStretchedBondsAreCutAndSummedUp) {
  Chain chain(15);
  for (Vec3d& r : chain.state.r) r = 2.01 * r;
  Listener l;
  l.look(chain);
  EXPECT_EQ(l.told.size(), static_cast<std::size_t>(Watch::told_in_full));
  l.watch.summarise();
  ASSERT_EQ(l.told.size(), static_cast<std::size_t>(Watch::told_in_full) + 1);
  EXPECT_TRUE(contains(l.told.back(), "4 more bonds were longer than twice their length at rest: 14 in all"))
      << l.told.back();
}

TEST(Watch, ManyOverlapsAreCutAndSummedUp) {
  Chain chain(28);
  chain.state.bonds = {};
  for (std::size_t k = 1; k < 28; k += 2) chain.state.r[ParticleId{k}].x -= 0.6;  // 14 pairs, 0.4 apart
  Listener l;
  l.watch.look_at_overlaps(chain.model, chain.state, 0.1);
  EXPECT_EQ(l.told.size(), static_cast<std::size_t>(Watch::told_in_full));
  l.watch.summarise();
  ASSERT_EQ(l.told.size(), static_cast<std::size_t>(Watch::told_in_full) + 1);
  EXPECT_TRUE(contains(l.told.back(), "4 more pairs of particles that are not bonded overlapped: 14 in all"))
      << l.told.back();
}

TEST(Watch, GoesOnFromItsRecordWithoutRepeatingItself) {
  Chain chain(2);
  chain.turn(1, {1, 0, 0}, 91 * degree);
  Listener before;
  before.look(chain);
  Listener after(before.watch.record());
  after.look(chain);
  EXPECT_TRUE(after.told.empty());
}

TEST(Watch, BondMadeDuringTheRunIsWatchedToo) {
  Chain chain(2);
  Listener l;
  l.look(chain);
  Bond second = chain.state.bonds[BondId{0}];
  chain.state.bonds.push_back(second);
  chain.turn(1, {1, 0, 0}, 60 * degree);
  l.look(chain);
  EXPECT_EQ(l.told.size(), 2u);
}

TEST(Watch, ShortBondIsAWarningAndAClosedOneStopsTheRun) {
  Chain chain(2);
  chain.state.r[ParticleId{1}].x = 0.49;
  Listener l;
  l.look(chain);
  l.look(chain);
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(contains(l.told[0], "shorter than half")) << l.told[0];
  chain.state.r[ParticleId{1}].x = 1.1e-6;
  EXPECT_EQ(failure(l, chain), "no error");
  chain.state.r[ParticleId{1}].x = 0.9e-6;
  EXPECT_TRUE(contains(failure(l, chain), "bond 0 (particles 0, 1)")) << failure(l, chain);
}

TEST(Watch, BondLongerThanTwiceItsLengthIsReportedOnceAndCounted) {
  Chain chain(3);
  chain.state.r[ParticleId{2}].x = 2.99;
  Listener l;
  l.look(chain);
  EXPECT_TRUE(l.told.empty());
  chain.state.r[ParticleId{2}].x = 3.01;
  EXPECT_EQ(deformed_bonds(chain.state), std::vector<BondId>{BondId{1}});
  l.look(chain);
  l.look(chain);
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(
      contains(l.told[0], "bond 1 (particles 1, 2) is longer than twice its length at rest: 2.01 of 1"))
      << l.told[0];
  EXPECT_EQ(l.watch.record().stretched, std::set<BondId>{BondId{1}});
  Listener resumed(l.watch.record());
  resumed.look(chain);
  EXPECT_TRUE(resumed.told.empty());
}

TEST(Watch, TwiceTheLengthIsThatOfTheBondAtRest) {
  Chain chain(3);
  chain.state.bonds[BondId{1}].a = 0.5;
  chain.state.r[ParticleId{2}].x = 1.99;
  Listener l;
  l.look(chain);
  EXPECT_TRUE(l.told.empty());
  chain.state.r[ParticleId{2}].x = 2.01;
  l.look(chain);
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(
      contains(l.told[0], "bond 1 (particles 1, 2) is longer than twice its length at rest: 1.01 of 0.5"))
      << l.told[0];
}

TEST(Watch, NotANumberNamesTheParticle) {
  Chain chain;
  chain.state.v[ParticleId{1}].y = std::numeric_limits<double>::quiet_NaN();
  Energies e;
  e.kinetic_translation = chain.state.v[ParticleId{1}].y;
  Listener l;
  const std::string text = failure(l, chain, e);
  EXPECT_TRUE(contains(text, "step 1200: particle 1")) << text;
  EXPECT_TRUE(contains(text, "time.step")) << text;
}

TEST(Watch, NotANumberInABondNamesTheBond) {
  Chain chain;
  chain.state.bonds[BondId{1}].coefficients.set(
      0, std::numeric_limits<double>::infinity());  // times (D - a)^2 = 0
  Energies e;
  e.U_L = std::numeric_limits<double>::quiet_NaN();
  Listener l;
  EXPECT_TRUE(contains(failure(l, chain, e), "bond 1 (particles 1, 2)")) << failure(l, chain, e);
}

TEST(Watch, EnergyJumpStopsTheRunEitherWayAndNotBelowTheBound) {
  Chain chain;
  Listener l;
  EXPECT_EQ(failure(l, chain, {}, allowed), "no error");
  EXPECT_EQ(failure(l, chain, {}, -allowed), "no error");
  for (const double error : {1.01 * allowed, -1.01 * allowed, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_TRUE(contains(failure(l, chain, {}, error), "watch.energy_error = 0.05")) << error;
}

TEST(Watch, PointOfBalanceIsJudgedByEveryBondOfItsState) {
  Chain chain(3);
  chain.turn(0, {1, 0, 0}, 91 * degree);
  Listener l;
  for (const double load_factor : {0.5, 1.0}) {
    const StaticPoint point{chain.state, load_factor, PointKind::regular, {}, {}, {}};
    l.watch.look(PointView(chain.model, point));
  }
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(contains(l.told[0], "bond 0 (particles 0, 1) has snapped")) << l.told[0];
  EXPECT_EQ(l.watch.record().snapped, 1);
  chain.state.r[ParticleId{1}] = chain.state.r[ParticleId{0}];  // bonded at the centres
  const StaticPoint end{chain.state, 1.0, PointKind::end, {}, {}, {}};
  EXPECT_THROW(l.watch.look(PointView(chain.model, end)), Diverged);
}

/// Chains along x and along y, not bonded to each other, at a height of z above; radii are 0.3 and more.
struct Crossing {
  Chain lower{3};
  Crossing() {
    for (const double y : {-1.0, 0.0, 1.0}) {
      lower.model.mass.push_back(1.0);
      lower.model.inertia.push_back(0.064);
      lower.model.radius.push_back(0.3);
      lower.model.r_0.push_back({1.0, y, 2.0});
      lower.state.r.push_back({1.0, y, 2.0});
      lower.state.v.push_back({});
      lower.state.q.push_back({});
      lower.state.omega.push_back({});
    }
  }
  /// Particle 4 is above particle 1, whose radius is 0.31.
  void lower_to(double z) {
    for (const std::size_t k : {3u, 4u, 5u}) lower.state.r[ParticleId{k}].z = z;
  }
};

TEST(Watch, ReportsParticlesThatOverlapWithoutABondOnce) {
  Listener l;
  Crossing c;
  const auto look = [&] { l.watch.look_at_overlaps(c.lower.model, c.lower.state, 0.1); };
  c.lower_to(0.61 - 0.029);
  look();
  EXPECT_TRUE(l.told.empty());
  c.lower_to(0.61 - 0.031);
  look();
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(contains(l.told[0], "t = 120: particles 1 and 4 are not bonded and overlap by 0.031, 0.103 of"))
      << l.told[0];
  look();
  EXPECT_EQ(l.told.size(), 1u);
  EXPECT_EQ(l.watch.record().overlapping.size(), 1u);
  Listener resumed(l.watch.record());
  resumed.watch.look_at_overlaps(c.lower.model, c.lower.state, 0.1);
  EXPECT_TRUE(resumed.told.empty());
}

TEST(Watch, DoesNotMindOverlapsThatAreMeant) {
  Listener l;
  Crossing c;
  const auto look = [&] { l.watch.look_at_overlaps(c.lower.model, c.lower.state, 0.1); };
  c.lower.state.r[ParticleId{1}].x = 0.2;  // bonded to particle 0
  look();
  EXPECT_TRUE(l.told.empty());
  c = {};
  for (auto* places : {&c.lower.model.r_0, &c.lower.state.r})  // from the start
    for (const std::size_t k : {3u, 4u, 5u}) (*places)[ParticleId{k}].z = 0.4;
  look();
  c.lower_to(0.4 - 0.029);
  look();
  EXPECT_TRUE(l.told.empty());
  c.lower_to(0.4 - 0.031);
  look();
  EXPECT_EQ(l.told.size(), 1u);
  c = {};
  for (double& R : c.lower.model.radius) R = 0.0;  // points
  c.lower_to(0.0);
  look();
  EXPECT_EQ(l.told.size(), 1u);
}

TEST(Watch, TellsTheLoadFactorOfAnOverlap) {
  Listener l;
  Crossing c;
  c.lower_to(0.3);
  const StaticPoint point{c.lower.state, 0.75, PointKind::regular, {}, {}, {}};
  l.watch.look_at_overlaps(PointView(c.lower.model, point), 0.1);
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(contains(l.told[0], "load factor 0.75: particles 1 and 4")) << l.told[0];
}

TEST(Watch, TellsOfTurnsThatAreTooFarAndEndsARunAtHalfATurn) {
  Listener l;
  Clock clock;
  clock.step = 1200, clock.stage_step = 1200, clock.dt = 0.1;
  const auto look = [&](double angle, bool insist = false) {
    l.watch.look_at_turns({ParticleId{3}, angle}, clock, insist);
  };
  look(0.6), look(1.1);
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(contains(l.told[0], "t = 120: step 1200: particle 3 turns by 0.6 rad in a step")) << l.told[0];
  EXPECT_TRUE(contains(l.told[0], "time.step = 0.075 would do")) << l.told[0];
  look(1.3);
  EXPECT_EQ(l.told.size(), 2u);
  look(4.0, true);
  EXPECT_EQ(l.told.size(), 3u);
  try {
    look(4.0);
    FAIL() << "no error";
  } catch (const Diverged& e) {
    EXPECT_TRUE(contains(e.what(), "step 1200: particle 3: it turns by 4 rad in a step")) << e.what();
  }
}

/// A sphere of radius 0.5 that stands 0.3 above a floor.
Chain on_a_floor() {
  Chain c(1);
  c.model.radius[ParticleId{0}] = 0.5;
  c.model.walls = {{"floor", PlaneWall{{0, 0, 0}, {0, 0, 1}}, 0, {}}};
  return c;
}

TEST(Watch, TellsOfParticlesDeepInWallsOnce) {
  Listener l;
  const Chain c = on_a_floor();
  l.watch.look_at_walls(c.model, {{ParticleId{0}, 0, 0.2}}, c.state.clock);
  l.watch.look_at_walls(c.model, {{ParticleId{0}, 0, 0.3}}, c.state.clock);
  ASSERT_EQ(l.told.size(), 1u);
  EXPECT_TRUE(contains(l.told[0], "t = 120: particle 0 overlaps wall \"floor\" by 0.2, 0.4 of its radius"))
      << l.told[0];
}

TEST(Watch, NamesTheWallThatAParticlePassesWhenTheBalanceIsOff) {
  Listener l;
  const Chain c = on_a_floor();
  const auto said = [&](const std::vector<DeepInWall>& deep) -> std::string {
    try {
      l.watch.look(
          {{}, {}}, 0.2, [&c]() -> const State& { return c.state; },
          [&] { return Watch::in_wall(c.model, deep); });
    } catch (const Diverged& e) {
      return e.what();
    }
    return "";
  };
  const std::string with_wall = said({{ParticleId{0}, 0, 0.3}});
  EXPECT_TRUE(
      contains(with_wall, "particle 0 is on its way through wall \"floor\", which it overlaps by 0.6 of"))
      << with_wall;
  EXPECT_TRUE(contains(with_wall, "use a stiffer contact")) << with_wall;
  EXPECT_TRUE(contains(said({}), "all particles: the energy balance is off by 0.2")) << said({});
}

// A servo that meets nothing, and one that has come to its force.
TEST(Watch, TellsOfServosWithoutTheirForce) {
  for (const bool meets : {false, true}) {
    testing::Specimen s = testing::sphere(
        {0, 0, 1}, 1.0, 1.0, testing::linear(10.0, 0.0),
        {testing::floor_at(0.0), {"lid", PlaneWall{{0, 0, meets ? 2.0 : 50.0}, {0, 0, -1}}, 0, {}}});
    Stage stage = testing::plain_stage(0.01, 40.0);
    stage.name = "press";
    stage.b_translation = 1.0;
    stage.walls = {testing::drive("lid", 1)};
    stage.walls[0].servo = WallDrive::Servo{{0, 0, -1}, 0.5, {}, 1.0, 5.0, 1e9};
    Simulation run(s.model, stage, s.state);
    run.run();
    Listener listener;
    listener.watch.look_at_servos(run);
    ASSERT_EQ(listener.told.size(), meets ? 0u : 1u);
    if (meets) continue;
    EXPECT_TRUE(
        contains(listener.told[0],
                 "wall \"lid\" ends stage \"press\" without its force: its servo presses with 0, not 0.5, "
                 "as it touches nothing; since the start of the run it has gone 3."))
        << listener.told[0];
  }
}

}  // namespace
}  // namespace vbond::watch_test
