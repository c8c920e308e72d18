// Loads that turn with their particles, at rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "differences.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond::followers_at_rest {
namespace {

using testing::Dice;
using testing::Specimen;

PointLoad follower(ParticleId p, const Vec3d& force, const Vec3d& moment) {
  PointLoad l = testing::pushed(p.value, force, moment);
  l.follower = true;
  return l;
}

struct Case {
  Specimen body;
  StaticStage stage;
};

/// A random body, its first particle clamped, one held in part, in each second body some in a rigid group,
/// all others under followers.
Case random_case(unsigned seed) {
  Dice dice(seed);
  Case c{testing::random_body(dice), {}};
  const std::size_t n = c.body.model.particles();
  Support slanted = testing::fixed({ParticleId{1}}, {true, false, false, true, false, true});
  slanted.axes = testing::turned_axes(rotation_of(dice.vector(1.0)));
  slanted.angular_velocity = 0.1 * slanted.axes->about[0];
  c.stage = testing::static_stage(StageKind::equilibrium,
                                  {testing::fixed({ParticleId{0}}, testing::clamped), slanted});
  if (seed % 2 == 0) {
    Support grip{"grip", {ParticleId{n - 1}, ParticleId{n - 2}}, {}, {}, {}, {}, true};
    c.stage.supports.push_back(grip);
  }
  for (std::size_t k = 1; k < n; ++k)
    c.stage.loads.push_back(follower(ParticleId{k}, dice.vector(0.01), dice.vector(0.002)));
  c.stage.newton.tolerance = 1e-12;
  return c;
}

// In balance the whole tangent is the derivative of the loads, antisymmetric part and all.
TEST(FollowersAtRest, TangentIsTheDerivativeOfTheLoads) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const Case c = random_case(seed);
    StaticBody body(c.body.model, c.stage, c.body.state);
    try {
      const State end = run_static_stage(c.body.model, c.stage, c.body.state, {}).state;
      body.restore({end.r, end.q, 1.0});
    } catch (const NoEquilibrium&) {
      continue;
    }
    ++compared;
    const testing::ByDifferences d = testing::by_differences(body);  // third derivatives are some 10
    EXPECT_LE((DenseMatrix(body.full_tangent()) - d.tangent).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LE((body.load_direction() - d.load_direction).cwiseAbs().maxCoeff(), 1e-7);
  }
  EXPECT_GE(compared, 18);
}

// A balance under followers is one of the motion as well: whoever goes on from it by steps stays there.
// Forces of 1e-2, balanced to 1e-12 of them, and rounding of places of 1 under stiffness 1: the acceleration
// is some 1e-14, and what it does in 20 units of time less than 1e-11.
TEST(FollowersAtRest, MotionStaysInBalance) {
  const testing::Tally all = testing::campaign("followers at rest", 10, [](unsigned k) {
    Case c = random_case(2 * k - 1);  // those without a rigid group
    c.stage.supports[1].angular_velocity = {};
    const State start = run_static_stage(c.body.model, c.stage, c.body.state, {}).state;
    Stage motion = testing::plain_stage(0.05, 20.0);
    for (const Support& held : c.stage.supports) {
      Support support;
      support.group = held.group, support.particles = held.particles, support.held = held.held;
      support.axes = held.axes;
      motion.supports.push_back(support);
    }
    for (const PointLoad& l : c.stage.loads) {
      PointLoad load{l.group, l.particles, l.force, l.moment, {}};
      load.follower = true;
      motion.loads.push_back(load);
    }
    Simulation run(c.body.model, motion, start);
    run.run();
    double moved = 0.0;
    for (const ParticleId p : start.r.ids()) moved = std::max(moved, norm(run.state().r[p] - start.r[p]));
    EXPECT_LE(moved, 1e-10);
  });
  EXPECT_LE(all["given up"], all.full ? all.cases / 10 : all.cases);
}

/// Where the end of a cantilever of length 1 and bending stiffness 1 comes under a force across its end that
/// turns with it: EI phi'' = P cos(phi), phi the angle to the end, from the end on, where phi = phi' = 0.
/// By Runge and Kutta's method.
Vec3d end_of_elastica(double P) {
  constexpr int n = 2000;
  const double h = 1.0 / n;
  double phi = 0.0, slope = 0.0, along = 0.0, across = 0.0;
  const auto turn = [P](double angle) { return P * std::cos(angle); };
  for (int k = 0; k < n; ++k) {
    const double a1 = slope, b1 = turn(phi);
    const double a2 = slope + 0.5 * h * b1, b2 = turn(phi + 0.5 * h * a1);
    const double a3 = slope + 0.5 * h * b2, b3 = turn(phi + 0.5 * h * a2);
    const double a4 = slope + h * b3, b4 = turn(phi + h * a3);
    const double next = phi + h / 6.0 * (a1 + 2 * a2 + 2 * a3 + a4);
    const double middle = phi + 0.5 * h * (slope + 0.25 * h * b1);
    along += h / 6.0 * (std::cos(phi) + 4 * std::cos(middle) + std::cos(next));
    across += h / 6.0 * (std::sin(phi) + 4 * std::sin(middle) + std::sin(next));
    phi = next, slope += h / 6.0 * (b1 + 2 * b2 + 2 * b3 + b4);
  }
  // the axes of the end have turned by phi against the clamp
  return {std::cos(phi) * along + std::sin(phi) * across, std::sin(phi) * along - std::cos(phi) * across, 0};
}

// The cantilever that turns back on itself under a force across its end. The error of a chain is of second
// order in the length of its bonds, until the stretch of the rod, 1e-6, shows.
TEST(FollowersAtRest, ForceAcrossTheEndGivesTheElastica) {
  const double P = 10.0;
  const Vec3d exact = end_of_elastica(P);
  EXPECT_LT(exact.x, 0.3);  // bent far back
  double error[2];
  for (const int k : {0, 1}) {
    const std::size_t n = k == 0 ? 20 : 40;
    std::vector<Vec3d> r;
    for (std::size_t p = 0; p <= n; ++p) r.push_back({static_cast<double>(p) / static_cast<double>(n), 0, 0});
    Specimen s = testing::particles_at(r);
    BondRecipe recipe;
    recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1e6, 0.0}, {1.0, 1e-6, 2e-6}, 0};
    for (std::size_t p = 0; p < n; ++p) testing::bond(s, p, p + 1, recipe);
    StaticStage stage =
        testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)},
                              {follower(ParticleId{n}, {0, P, 0}, {})});
    stage.steps = 20;
    const State end = run_static_stage(s.model, stage, s.state, {}).state;
    error[k] = norm(end.r[ParticleId{n}] - exact);
    stage.kind = StageKind::path;
    stage.path.above = 1.0;
    const State along_path = run_static_stage(s.model, stage, s.state, {}).state;
    EXPECT_LE(norm(along_path.r[ParticleId{n}] - end.r[ParticleId{n}]), 1e-7);
  }
  EXPECT_LE(error[1], 5e-3);
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.2);
}

TEST(FollowersAtRest, OtherKindsRefuseThem) {
  const Case c = random_case(1);
  for (const StageKind kind : {StageKind::buckling, StageKind::modes, StageKind::fracture}) {
    StaticStage stage = c.stage;
    stage.kind = kind;
    const auto mistakes = mistakes_in(c.body.model, stage);
    ASSERT_FALSE(mistakes.empty());
    EXPECT_NE(mistakes[0].find("equilibria and paths take such loads"), std::string::npos) << mistakes[0];
  }
}

}  // namespace
}  // namespace vbond::followers_at_rest
