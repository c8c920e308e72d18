// Rigid supports that are free in some degrees of freedom, at rest. The independent answer: a body whose
// particles are joined by bonds so stiff that they hardly give.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "differences.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond::free_grips_at_rest {
namespace {

using testing::Dice;
using testing::Specimen;

constexpr HeldDofs nothing{};

Support grip(std::vector<ParticleId> particles, const HeldDofs& held, const Vec3d& displacement = {},
             const Vec3d& rotation = {}, std::optional<Vec3d> pivot = {}) {
  return {"grip", std::move(particles), held, displacement, rotation, {}, true, pivot};
}

/// Bodies have stiffnesses of 0.01 to 1.
void stiffen(Specimen& s, const std::vector<ParticleId>& group, double stiffness) {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{stiffness, stiffness, stiffness, stiffness};
  for (const ParticleId i : group)
    for (const ParticleId j : group)
      if (i < j) testing::bond(s, i.value, j.value, recipe);
}

/// A random body, its first particle clamped, with a grip of three or four particles.
struct Case {
  Specimen body, stiffened;
  StaticStage stage, of_stiffened;
  std::vector<ParticleId> group;
};

Case random_case(unsigned seed) {
  Dice dice(seed);
  Case c;
  c.body = testing::random_body(dice);
  const std::size_t n = c.body.model.particles();
  for (std::size_t k = n - (dice(0, 1) < 0.5 ? 3 : 4); k < n; ++k) c.group.push_back(ParticleId{k});
  if (dice(0, 1) < 0.5) std::swap(c.group.front(), c.group.back());
  c.stiffened = c.body;
  stiffen(c.stiffened, c.group, 1e7);
  const ParticleId first = c.group.front();
  const Support clamp = testing::fixed({ParticleId{0}}, testing::clamped);
  Support of_body = grip(c.group, nothing), of_one = testing::fixed({first}, nothing);
  switch (static_cast<int>(dice(0, 4))) {
    case 0: break;
    case 1:  // a ball joint at a particle
      of_body.held = of_one.held = {true, true, true, false, false, false};
      of_body.pivot = c.body.state.r[first];
      break;
    case 2:  // turns as it is told
      of_body.held = of_one.held = {false, false, false, true, true, true};
      of_body.angular_velocity = of_one.angular_velocity = dice.vector(0.2);
      break;
    default:  // goes along x as it is told, and does not turn
      of_body.held = of_one.held = {true, false, false, true, true, true};
      of_body.velocity = of_one.velocity = {dice(-0.1, 0.1), 0, 0};
  }
  c.stage = testing::static_stage(StageKind::equilibrium, {clamp, of_body});
  for (const ParticleId p : c.group) c.stage.loads.push_back(testing::pushed(p.value, dice.vector(0.02)));
  c.stage.loads.push_back(testing::pushed(1, dice.vector(0.02)));
  c.stage.newton.tolerance = 1e-11;
  c.of_stiffened = c.stage;
  c.of_stiffened.supports = {clamp};
  if (of_one.held != nothing) c.of_stiffened.supports.push_back(of_one);
  return c;
}

// Loads of 0.02 turn stiff bonds by 1e-9; bodies as soft as 1e-3 multiply that by some hundreds.
TEST(FreeGripsAtRest, AreTheLimitOfStiffBonds) {
  const testing::Tally all = testing::campaign("grips at rest", 30, [](unsigned seed) {
    const Case c = random_case(seed);
    const StaticOutcome by_grip = run_static_stage(c.body.model, c.stage, c.body.state, {});
    const StaticOutcome by_bonds = run_static_stage(c.stiffened.model, c.of_stiffened, c.stiffened.state, {});
    EXPECT_LE(testing::distance_between(by_grip.state, by_bonds.state), 2e-6);
    double moved = 0.0;
    for (const ParticleId p : c.body.state.r.ids())
      moved = std::max(moved, norm(by_grip.state.r[p] - c.body.state.r[p]));
    EXPECT_GT(moved, 1e-3);
  });
  EXPECT_LE(all["given up"], all.full ? all.cases / 10 : all.cases);
}

// Whether loads grow from zero or are there at the start: a grip has turned by all that it has gone.
TEST(FreeGripsAtRest, TurnUnderConstantLoadsToo) {
  int turned = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Case c = random_case(seed);
    c.stage.path.above = 1.0, c.stage.path.first_step = 0.25;
    const auto angle_at_end = [&c](StageKind kind) {
      c.stage.kind = kind;
      double angle = 0.0;
      StaticHooks hooks;
      hooks.point = [&angle](const StaticPoint& p) { angle = p.grips.at(0).angle; };
      run_static_stage(c.body.model, c.stage, c.body.state, hooks);
      return angle;
    };
    const double of_all = angle_at_end(StageKind::equilibrium);
    for (std::size_t k = 0; k + 1 < c.stage.loads.size(); ++k) c.stage.loads[k].constant = true;
    EXPECT_NEAR(angle_at_end(StageKind::path), of_all, 1e-8);
    turned += of_all > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(turned, 6);
}

// The tangent and the load direction, by differences. As for slanted supports, the antisymmetric part of what
// is out of balance is left out on purpose. Bonds between the particles of every second grip are strained as
// it takes hold.
TEST(FreeGripsAtRest, TangentIsTheDerivativeOfTheLoads) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Case c = random_case(seed);
    Dice dice(seed);
    if (seed % 2 == 0)
      for (std::size_t k = 1; k < c.group.size(); ++k) c.body.state.r[c.group[k]] += dice.vector(0.1);
    StaticBody body(c.body.model, c.stage, c.body.state);
    const int size = body.unknowns().size();
    Vector away(size);
    for (double& x : away) x = dice(-0.05, 0.05);
    body.move(away, 0.5);
    const testing::ByDifferences d = testing::by_differences(body);  // third derivatives are some 10
    const DenseMatrix K = 0.5 * (d.tangent + d.tangent.transpose());
    EXPECT_LE((DenseMatrix(body.tangent()) - K).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LE((body.load_direction() - d.load_direction).cwiseAbs().maxCoeff(), 1e-7);
  }
}

// A column of five bonds below a rigid head of three particles, of which two bonds join these: whatever
// strain they have at the start, they do nothing to the load under which the column buckles sideways.
TEST(FreeGripsAtRest, StrainedBondsInsideDoNothing) {
  const auto critical_load = [](double prestrain) {
    std::vector<Vec3d> r;
    for (int k = 0; k < 8; ++k) r.push_back({double(k), 0, 0});
    Specimen s = testing::particles_at(r, 0.3);
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.12, 0.01, 0.01};
    for (std::size_t k = 0; k < 5; ++k) testing::bond(s, k, k + 1, recipe);
    recipe.prestrain = prestrain;
    for (std::size_t k = 5; k < 7; ++k) testing::bond(s, k, k + 1, recipe);
    StaticStage stage = testing::static_stage(
        StageKind::buckling,
        {testing::fixed({ParticleId{0}}, testing::clamped),
         grip({ParticleId{5}, ParticleId{6}, ParticleId{7}}, {false, false, true, true, true, false})});
    stage.loads = {testing::pushed(7, {-1, 0, 0})};
    const StaticOutcome out = run_static_stage(s.model, stage, s.state, {});
    EXPECT_FALSE(out.result.critical_loads.empty()) << prestrain;
    return out.result.critical_loads.at(0).load_factor;
  };
  const double expected = critical_load(0.0);
  for (const double prestrain : {-0.3, -0.05, 0.05, 0.3})
    EXPECT_NEAR(critical_load(prestrain) / expected, 1.0, 1e-9) << prestrain;
}

// Its particles stay one rigid body, and what is out of balance is minus the slope of the potential.
TEST(FreeGripsAtRest, UnbalancedLoadIsTheSlopeOfThePotential) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const Case c = random_case(seed);
    StaticBody body(c.body.model, c.stage, c.body.state);
    const int size = body.unknowns().size();
    Dice dice(seed);
    Vector away(size), way(size);
    for (double& x : away) x = dice(-0.3, 0.3);
    for (double& x : way) x = dice(-1, 1);
    body.move(away, 0.5);
    for (const ParticleId p : c.group)
      for (const ParticleId q : c.group)
        EXPECT_NEAR(norm(body.state().r[p] - body.state().r[q]), norm(c.body.state.r[p] - c.body.state.r[q]),
                    1e-14);
    const Placement here = body.placement();
    const double expected = -body.unbalanced().dot(way), h = 1e-5;
    const auto potential = [&](double step) {
      body.restore(here);
      const double energy = body.potential();
      body.move(step * way, 0.5);
      return body.potential_change(here, energy);
    };
    EXPECT_NEAR((potential(h) - potential(-h)) / (2.0 * h), expected, 1e-8);
  }
}

/// Two rows of four particles, bonds of different stiffness between them; the upper row is one plate.
struct Bundle {
  Specimen body;
  std::vector<ParticleId> lower, upper;
  double stiffness = 0.0;
  Bundle() {
    std::vector<Vec3d> r;
    for (const double z : {0.0, 1.0})
      for (int k = 0; k < 4; ++k) r.push_back({static_cast<double>(k), 0.2 * k, z});
    body = testing::particles_at(r);
    for (std::size_t k = 0; k < 4; ++k) {
      BondRecipe recipe;
      const double c = 0.5 + 0.3 * static_cast<double>(k);
      recipe.parameters = BondStiffness<double>{c, 0.1, 0.05, 0.05};
      testing::bond(body, k, k + 4, recipe);
      stiffness += c;
      lower.push_back(ParticleId{k}), upper.push_back(ParticleId{k + 4});
    }
  }
};

// A plate that may go along z carries the force by all its bonds, in every kind of stage, and the books of
// fracture close.
TEST(FreeGripsAtRest, PulledPlateStretchesItsBundle) {
  const Bundle b;
  PointLoad pull{"pull", b.upper, {0.3, 0, 0.05}};
  for (const StageKind kind : {StageKind::equilibrium, StageKind::path, StageKind::fracture}) {
    StaticStage stage = testing::static_stage(
        kind,
        {testing::fixed(b.lower, testing::clamped), grip(b.upper, {true, true, false, true, true, true})},
        {pull});
    stage.path.above = 1.0;
    stage.path.first_step = 0.25;
    std::vector<GripView> grips;
    StaticHooks hooks;
    hooks.point = [&](const StaticPoint& p) { grips = p.grips; };
    const StaticOutcome out = run_static_stage(b.body.model, stage, b.body.state, hooks);
    for (const ParticleId p : b.upper)
      EXPECT_LE(norm(out.state.r[p] - b.body.state.r[p] - Vec3d{0, 0, 0.2 / b.stiffness}), 1e-10);
    ASSERT_EQ(grips.size(), 1u);
    EXPECT_LE(norm(grips[0].force - Vec3d{-1.2, 0, 0}), 1e-10);
    if (kind == StageKind::fracture) {
      EXPECT_NEAR(out.result.fracture.books.work, 0.5 * sq(0.2) / b.stiffness, 1e-12);
      EXPECT_LE(std::abs(out.result.fracture.books.error()), 1e-9);
    }
  }
}

/// A column of eight bonds, clamped below, with a rigid bar of two particles across its end that a force
/// presses beside the axis of the column.
struct Column {
  Specimen body;
  std::vector<ParticleId> bar;
  explicit Column(bool by_bonds) {
    std::vector<Vec3d> r;
    for (int k = 0; k <= 8; ++k) r.push_back({0, 0, static_cast<double>(k)});
    r.push_back({0, 0, 9.5});
    body = testing::particles_at(r);
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.1, 0.01, 0.01};
    for (std::size_t k = 0; k < 8; ++k) testing::bond(body, k, k + 1, recipe);
    bar = {ParticleId{8}, ParticleId{9}};
    if (by_bonds) stiffen(body, bar, 1e5);
  }
};

// A column whose end carries a rigid extension buckles at another load than without: that of stiff bonds,
// which are 1e7 times as stiff as the column.
TEST(FreeGripsAtRest, BucklingLoadIsThatOfStiffBonds) {
  double factor[2];
  for (const bool by_bonds : {false, true}) {
    const Column c(by_bonds);
    StaticStage stage =
        testing::static_stage(StageKind::buckling, {testing::fixed({ParticleId{0}}, testing::clamped)},
                              {testing::pushed(9, {0, 0, -1})});
    if (!by_bonds) stage.supports.push_back(grip(c.bar, nothing));
    stage.count = 1;
    const StaticOutcome out = run_static_stage(c.body.model, stage, c.body.state, {});
    ASSERT_FALSE(out.result.critical_loads.empty());
    factor[by_bonds] = out.result.critical_loads[0].load_factor;
  }
  EXPECT_GT(factor[0], 1e-6);
  EXPECT_NEAR(factor[1] / factor[0], 1.0, 1e-6);
}

TEST(FreeGripsAtRest, MistakesAreNamed) {
  const Bundle b;
  const auto mistakes = [&](StageKind kind, const HeldDofs& held) {
    return mistakes_in(b.body.model, testing::static_stage(kind, {grip(b.upper, held)}));
  };
  EXPECT_TRUE(mistakes(StageKind::equilibrium, nothing).empty());
  const auto one_turn = mistakes(StageKind::path, {true, true, true, true, false, false});
  ASSERT_EQ(one_turn.size(), 1u);
  EXPECT_NE(one_turn[0].find("holds one turn"), std::string::npos) << one_turn[0];
  const auto modes = mistakes(StageKind::modes, nothing);
  ASSERT_EQ(modes.size(), 1u);
  EXPECT_NE(modes[0].find("modes take grips that hold all"), std::string::npos) << modes[0];
}

// Nothing holds a plate whose bonds have gone: the stage says so by its name.
TEST(FreeGripsAtRest, WithoutBondsAreRigidMotions) {
  Bundle b;
  b.body.state.bonds = {};
  const StaticStage stage = testing::static_stage(
      StageKind::equilibrium,
      {testing::fixed(b.lower, testing::clamped), grip(b.upper, {true, true, false, true, true, true})});
  try {
    run_static_stage(b.body.model, stage, b.body.state, {});
    FAIL() << "a plate without bonds is in balance";
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("translation along z of particles 4 to 7"), std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace vbond::free_grips_at_rest
