// Supports along and about axes that are not those of the world. A body that has turned together with its
// supports and loads behaves as before: what supports along the axes of the world do is tested elsewhere.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "differences.hpp"
#include "dynamics/rods.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/agreement.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {
namespace {

using testing::Dice;
using testing::Specimen;

StaticStage turned(StaticStage stage, const Quatd& turn) {
  for (Support& s : stage.supports) {
    s.axes = testing::turned_axes(turn);
    s.velocity = rotate(turn, s.velocity), s.angular_velocity = rotate(turn, s.angular_velocity);
  }
  for (PointLoad& l : stage.loads) l.force = rotate(turn, l.force), l.moment = rotate(turn, l.moment);
  return stage;
}

struct Pair {
  Specimen plain, turned;
  StaticStage stage, turned_stage;
  Quatd turn;
};

/// The first particle clamped; two more held in some degrees of freedom, which may move.
Pair random_pair(unsigned seed, StageKind kind) {
  Dice dice(seed);
  Pair p;
  p.plain = testing::random_body(dice);
  p.stage = testing::static_stage(kind, {testing::fixed({ParticleId{0}}, testing::clamped)});
  const std::size_t n = p.plain.model.particles();
  for (const std::size_t k : {n - 1, n - 2}) {
    Support s = testing::fixed({ParticleId{k}}, testing::some_dofs(dice, 0.4));
    for (int a = 0; a < 3; ++a) {
      const auto dof = static_cast<std::size_t>(a);
      const bool moves = kind != StageKind::modes;
      if (s.held[dof] && moves) component(s.velocity, a) = dice(-0.05, 0.05);
      if (s.held[dof + 3] && moves) component(s.angular_velocity, a) = dice(-0.1, 0.1);
    }
    p.stage.supports.push_back(s);
  }
  p.stage.loads = {testing::pushed(1, dice.vector(0.01), dice.vector(0.002)),
                   testing::pushed(2, dice.vector(0.01))};
  p.stage.newton.tolerance = 1e-12;
  p.turn = rotation_of(dice.vector(1.5));
  p.turned = testing::turned(p.plain, p.turn);
  p.turned_stage = turned(p.stage, p.turn);
  return p;
}

// Also through history.csv: reactions and energies. Tolerances: the residual of 1e-12 over the softest of
// these bodies (1e-3).
TEST(SlantedSupports, BalanceTurnsWithTheBody) {
  const testing::Tally all = testing::campaign("slanted supports at rest", 20, [](unsigned seed) {
    const Pair p = random_pair(seed, StageKind::equilibrium);
    Reaction reaction[2];
    State ends[2];
    double energy[2];
    for (const bool t : {false, true}) {
      const Specimen& s = t ? p.turned : p.plain;
      const StaticStage& stage = t ? p.turned_stage : p.stage;
      ends[t] = run_static_stage(s.model, stage, s.state, {}).state;
      StaticBody body(s.model, stage, s.state);
      body.move(Vector::Zero(body.unknowns().size()), 1.0);
      body.restore({ends[t].r, ends[t].q, 1.0});
      reaction[t] = body.reaction({ParticleId{s.model.particles() - 1}});
      energy[t] = body.power_of_supports();
    }
    EXPECT_LE(testing::distance_between(testing::turned({p.plain.model, ends[0]}, p.turn).state, ends[1]),
              1e-8);
    EXPECT_LE(norm(reaction[1].force - rotate(p.turn, reaction[0].force)), 1e-9);
    EXPECT_LE(norm(reaction[1].moment - rotate(p.turn, reaction[0].moment)), 1e-9);
    EXPECT_NEAR(energy[1], energy[0], 1e-10);
  });
  EXPECT_LE(all["given up"], all.full ? all.cases / 10 : all.cases);
}

TEST(SlantedSupports, FrequenciesAreThoseOfTheBodyThatHasNotTurned) {
  const testing::Tally all = testing::campaign("slanted modes", 10, [](unsigned seed, testing::Tally& tally) {
    const Pair p = random_pair(seed, StageKind::modes);
    const auto modes = [](const Specimen& s, const StaticStage& stage) {
      return run_static_stage(s.model, stage, s.state, {}).result.modes;
    };
    const auto plain = modes(p.plain, p.stage), turned = modes(p.turned, p.turned_stage);
    ASSERT_EQ(plain.size(), turned.size());
    for (std::size_t k = 0; k < plain.size(); ++k)
      EXPECT_NEAR(turned[k].omega2, plain[k].omega2, 1e-8);  // the largest are some 10
    tally.add("bodies with modes", !plain.empty());
  });
  EXPECT_GE(all.sum("bodies with modes") * 10, all.cases * 9);
}

// The tangent is the derivative of the loads, and the load direction that with the load factor, in slanted
// axes as well.
TEST(SlantedSupports, TangentIsTheDerivativeOfTheLoads) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const Pair p = random_pair(seed, StageKind::equilibrium);
    StaticBody body(p.turned.model, p.turned_stage, p.turned.state);
    const int size = body.unknowns().size();
    body.move(Vector::Zero(size), 0.5);
    const testing::ByDifferences d = testing::by_differences(body);
    // the antisymmetric part of what is out of balance is left out on purpose: compare the symmetric sums
    const DenseMatrix K = DenseMatrix(body.full_tangent());
    EXPECT_LE((K + K.transpose() - d.tangent - d.tangent.transpose()).cwiseAbs().maxCoeff(), 2e-7);
    EXPECT_LE((body.load_direction() - d.load_direction).cwiseAbs().maxCoeff(), 1e-7);
  }
}

// A rod on a roller that runs down a slope of 30 degrees, pushed along: the roller's force is normal to the
// slope, and the end moves along it.
TEST(SlantedSupports, RollerOnASlope) {
  Specimen s = testing::straight_rod(5);
  const Vec3d normal = normalised(Vec3d{0.5, 0, std::sqrt(0.75)});
  Support roller = testing::fixed({ParticleId{4}}, {});
  const HeldDirections d = held_directions({}, {normal}, {});
  roller.held = d.held, roller.axes = d.axes;
  const StaticStage stage = testing::static_stage(StageKind::equilibrium,
                                                  {testing::fixed({ParticleId{0}}, testing::clamped), roller},
                                                  {testing::pushed(4, {-1e-4, 0, 0})});
  const StaticOutcome out = run_static_stage(s.model, stage, s.state, {});
  const Vec3d went = out.state.r[ParticleId{4}] - s.state.r[ParticleId{4}];
  EXPECT_LE(std::abs(dot(went, normal)), 1e-15);
  EXPECT_GT(norm(went), 1e-5);
  StaticBody body(s.model, stage, s.state);
  body.restore({out.state.r, out.state.q, 1.0});
  const Vec3d F = body.reaction({ParticleId{4}}).force;
  EXPECT_LE(norm(across(F, normal)), 1e-16);
  // balance of the whole rod
  const Vec3d clamp = body.reaction({ParticleId{0}}).force;
  EXPECT_LE(norm(clamp + F + Vec3d{-1e-4, 0, 0}), 1e-12);
  // The end goes along the slope, by u_x = -4 P of a rod that is pressed, and so up by -u_x tan 30. Pressed
  // by P it resists that by the beam-column's P/(tan(k L)/k - L), k^2 = P/EI: the transverse part of the
  // roller's force. Four bonds are (k a)^2/12 = 3e-3 from the beam.
  const double P = 1e-4, L = 4.0, k = std::sqrt(P / 0.0025);
  const double across = P / (std::tan(k * L) / k - L) * P * L * std::tan(M_PI / 6);
  EXPECT_NEAR(F.z / across, 1.0, 0.01);
}

// Two supports, each along its own direction: perpendicular ones are held both; others are a mistake.
TEST(SlantedSupports, OfTwoSupportsArePerpendicularOrRefused) {
  Support a = testing::fixed({ParticleId{0}}, {}), b = a, c = testing::fixed({ParticleId{0}}, {true});
  a.group = "a", b.group = "b";
  const auto take = [](Support& s, const std::vector<Vec3d>& along) {
    const HeldDirections d = held_directions({}, along, {});
    s.held = d.held, s.axes = d.axes;
  };
  take(a, {{0, 0.6, 0.8}});
  take(b, {{0, -0.8, 0.6}});
  EXPECT_TRUE(disagreements({a, b, c}, 1).empty());
  const Unknowns all(1, {a, b, c}, 1.0);
  EXPECT_EQ(all.size(), 3);  // the turns
  take(b, {{0, -0.8, 0.7}});
  const auto found = disagreements({a, b}, 1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].oblique);
  b.velocity = {};
  take(b, {{0, 1.2, 1.6}});  // the same direction
  EXPECT_TRUE(disagreements({a, b}, 1).empty());
  b.velocity = {0, 0.06, 0.08};
  EXPECT_EQ(disagreements({a, b}, 1).size(), 1u);
}

// Directions at any angle hold what they span; three of them hold all.
TEST(SlantedSupports, HoldWhatTheirDirectionsSpan) {
  const HeldDirections plane = held_directions({true}, {{1, 1, 0}}, {});
  EXPECT_FALSE(plane.axes.has_value());  // x and y of the world
  EXPECT_EQ(plane.held, (HeldDofs{true, true, false, false, false, false}));
  const HeldDirections two = held_directions({}, {{1, 1, 0}, {1, 1, 1e-12}}, {{0, 3, 4}});
  ASSERT_TRUE(two.axes.has_value());
  EXPECT_EQ(two.held, (HeldDofs{true, false, false, true, false, false}));
  EXPECT_TRUE(are_right_handed(two.axes->along) && are_right_handed(two.axes->about));
  EXPECT_NEAR(norm(two.axes->about[0] - Vec3d{0, 0.6, 0.8}), 0.0, 1e-15);
  const HeldDirections all = held_directions({}, {{1, 1, 0}, {1, 0, 0}, {1, 1, 1}}, {});
  EXPECT_FALSE(all.axes.has_value());
  EXPECT_EQ(all.held, (HeldDofs{true, true, true, false, false, false}));
}

// Held about one axis, a particle has no balance apart from the way there. Load steps are its chords: an
// error of the second order, so that with twice as many the difference falls to a quarter; 0.295 and 0.246
// were found.
TEST(OneHeldRotation, DependsOnLoadStepsBySecondOrderAndThatIsTold) {
  BondRecipe recipe;
  recipe.parameters = GivenCoefficients{{1.0, 0.1, 0.1, 0.1}};
  const testing::Specimen rod = testing::straight_rod(6, recipe);
  const auto end_of = [&rod](const HeldDofs& held, int steps, int told) {
    StaticStage stage = testing::static_stage(
        StageKind::equilibrium,
        {testing::fixed({ParticleId{0}}, testing::clamped), testing::fixed({ParticleId{5}}, held)},
        {testing::pushed(5, {0, 0.03, 0.02}, {0, 0.05, 0})});
    stage.steps = steps;
    StaticHooks hooks;
    int times = 0;
    hooks.tell = [&times](const std::string& text) {
      times += text.find("is held about one axis and has turned") != std::string::npos;
    };
    const State end = run_static_stage(rod.model, stage, rod.state, hooks).state;
    EXPECT_EQ(times, told);
    return end.r[ParticleId{5}];
  };
  const HeldDofs one{false, false, false, true, false, false}, two{false, false, false, true, false, true};
  std::vector<Vec3d> end;
  for (const int steps : {5, 10, 20, 40}) end.push_back(end_of(one, steps, 1));
  for (std::size_t k = 2; k < end.size(); ++k)
    EXPECT_NEAR(norm(end[k] - end[k - 1]) / norm(end[k - 1] - end[k - 2]), 0.25, 0.06);
  EXPECT_LT(norm(end_of(two, 5, 0) - end_of(two, 40, 0)), 1e-7);
}

}  // namespace
}  // namespace vbond
