#include <gtest/gtest.h>

#include <cmath>

#include "rods.hpp"
#include "teams.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/make_bond.hpp"

namespace vbond {
namespace {

BondingRule any_pair_within(double distance, std::size_t particles, const BondRecipe& recipe) {
  const std::vector<char> everyone(particles, 1);
  return {"any", everyone, everyone, distance, recipe};
}

// Two spinning particles approach and are bonded as soon as they are within 1: the bond starts unstressed
// although both have turned, and energy is conserved through its making.
TEST(Bonding, JoinsParticlesThatComeNearWithoutAJumpInEnergy) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {1.3, 0.1, 0}});
  s.state.v = {{0.01, 0, 0}, {-0.01, 0, 0}};
  s.state.omega = {{0.02, 0.01, 0.03}, {-0.01, 0.02, 0}};
  Stage stage = testing::plain_stage(0.05, 1e9);
  stage.bonding = {any_pair_within(1.0, 2, testing::papers_bond())};
  Simulation run(s.model, stage, s.state);
  double distance = 2.0, before = 2.0;  // at the start of the present step, and of the one before
  while (run.state().bonds.empty()) {
    ASSERT_LT(run.state().clock.time(), 20.0);
    before = distance;
    distance = norm(run.state().r[ParticleId{1}] - run.state().r[ParticleId{0}]);
    run.step();
  }
  EXPECT_GT(before, 1.0);  // the first step at which the distance is within the rule, not a later one
  EXPECT_LE(distance, 1.0);
  EXPECT_EQ(run.state().bonds[BondId{0}].a, distance);
  for (int k = 0; k < 2000; ++k) run.step();
  EXPECT_EQ(run.state().bonds.size(), 1u);
  EXPECT_GT(run.energies().potential(), 1e-6);  // the bond works
  EXPECT_LT(std::abs(run.balance_error()), 1e-4);
}

TEST(Bonding, OnlyJoinsTheGroupsOfItsRule) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.9, 0, 0}, {1.8, 0, 0}});
  Stage stage = testing::plain_stage(0.05, 1.0);
  stage.bonding = {{"first with second", {1, 0, 0}, {0, 1, 0}, 1.0, testing::papers_bond()}};
  Simulation run(s.model, stage, s.state);
  run.step();
  ASSERT_EQ(run.state().bonds.size(), 1u);
  EXPECT_EQ(run.state().bonds[BondId{0}].i, ParticleId{0});
  EXPECT_EQ(run.state().bonds[BondId{0}].j, ParticleId{1});
}

TEST(Bonding, BooksTheContactEnergyThatABondedPairGivesUp) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.82, 0, 0}}, 0.4);
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0, 0};
  s.state.v = {{0.02, 0, 0}, {-0.02, 0, 0}};
  Stage stage = testing::plain_stage(0.01, 1e9);
  stage.bonding = {any_pair_within(0.79, 2, testing::papers_bond())};
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < 1000; ++k) run.step();
  EXPECT_EQ(run.state().bonds.size(), 1u);
  EXPECT_EQ(run.energies().contact, 0.0);
  EXPECT_GT(run.state().books.dissipated, 0.0);
  EXPECT_LT(std::abs(run.balance_error()), 1e-4);
}

TEST(Bonding, NamesTheParticlesWhenABondWouldHaveNoLength) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.9, 0, 0}}, 0.5);
  BondRecipe recipe = testing::papers_bond();
  recipe.attachment = Attachment::surfaces;
  Stage stage = testing::plain_stage(0.05, 1.0);
  stage.bonding = {any_pair_within(1.0, 2, recipe)};
  Simulation run(s.model, stage, s.state);
  try {
    run.step();
    FAIL() << "no error";
  } catch (const Diverged& e) {
    EXPECT_NE(std::string(e.what()).find("particles 0 and 1"), std::string::npos) << e.what();
  }
}

// Spheres of different size: a gap of surfaces, and a factor of the radii, not a distance of centres.
TEST(Bonding, ByAGapOrAFactorFollowsTheRadiiOfEachPair) {
  for (const bool by_gap : {true, false}) {
    // gaps .1, .3, .1; in parts of R_i + R_j 1.1, 1.15, 1.025
    testing::Specimen s = testing::particles_at({{0, 0, 0}, {1.1, 0, 0}, {3.4, 0, 0}, {7.5, 0, 0}});
    s.model.radius = {0.5, 0.5, 1.5, 2.5};
    Stage stage = testing::plain_stage(0.001, 1.0);
    BondingRule rule = any_pair_within(by_gap ? 0.2 : 0.0, 4, testing::papers_bond());
    rule.factor = by_gap ? 1.0 : 1.12;
    stage.bonding = {rule};
    Simulation run(s.model, stage, s.state);
    run.step();
    ASSERT_EQ(run.state().bonds.size(), 2u);
    EXPECT_EQ(run.state().bonds[BondId{0}].j, ParticleId{1});
    EXPECT_EQ(run.state().bonds[BondId{1}].i, ParticleId{2});
  }
}

// The share that is bonded on approach is the one that the pairs' numbers say, whenever they come near.
TEST(Bonding, ALeftOutPairStaysLeftOut) {
  std::vector<Vec3d> r;
  for (int k = 0; k < 200; ++k) r.push_back({10.0 * (k / 2) + 0.9 * (k % 2), 0, 0});
  testing::Specimen s = testing::particles_at(r);
  Stage stage = testing::plain_stage(0.05, 1e9);
  BondingRule rule = any_pair_within(1.0, 200, testing::papers_bond());
  rule.share = {0.4, 3};
  stage.bonding = {rule};
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < 10; ++k) run.step();
  std::size_t wanted = 0;
  for (std::size_t k = 0; k < 200; k += 2) wanted += pair_variate(3, ParticleId{k}, ParticleId{k + 1}) < 0.4;
  EXPECT_GT(wanted, 20u);
  EXPECT_LT(wanted, 60u);
  ASSERT_EQ(run.state().bonds.size(), wanted);
  for (const Bond& b : run.state().bonds) EXPECT_LT(pair_variate(3, b.i, b.j), 0.4);
}

// Pairs whose own strength does not bear the prestrain are left unbonded, and not made and broken for ever.
TEST(Bonding, LeavesPairsTooWeakForThePrestrain) {
  std::vector<Vec3d> r;
  for (int k = 0; k < 40; ++k) r.push_back({10.0 * (k / 2) + 0.9 * (k % 2), 0, 0});
  testing::Specimen s = testing::particles_at(r);
  BondRecipe recipe = testing::papers_bond();
  recipe.prestrain = 0.01;
  recipe.rules.strength = elongation_strength(0.02);
  recipe.weibull.modulus = 2.0;
  Stage stage = testing::plain_stage(0.05, 1e9);
  stage.bonding = {any_pair_within(1.0, 40, recipe)};
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < 50; ++k) run.step();
  const std::size_t made = run.state().bonds.size();
  EXPECT_GT(made, 10u);  // exp(-(1/2)^2) = 0.78 of 20
  EXPECT_LT(made, 20u);
  EXPECT_EQ(run.breaks(), 0);
  for (const Bond& b : run.state().bonds) EXPECT_GT(strength_factor(b), 0.5);
}

// Bonds are numbered as they are made, so the order is part of the result: rules one after another, pairs of
// a rule by their particles, whatever rows these stand in; a pair that two rules join is bonded by the first.
TEST(Bonding, FindsPairsInTheOrderOfRulesAndParticles) {
  testing::Specimen s =
      testing::particles_at({{0, 0, 0}, {0.9, 0, 0}, {0.9, 0.9, 0}, {0, 0.9, 0}, {5, 0, 0}});
  Stage stage = testing::plain_stage(0.05, 1.0);
  stage.bonding = {{"sides of 2", {0, 0, 1, 0, 0}, {1, 1, 1, 1, 1}, 1.0, testing::papers_bond()},
                   any_pair_within(1.0, 5, testing::papers_bond())};
  Order backwards;
  PerParticle<Row> rows;
  for (std::size_t k = 0; k < 5; ++k) {
    backwards.particle.push_back(ParticleId{4 - k});
    rows.push_back(Row{4 - k});
  }
  backwards.row = RowOf(rows);
  backwards.own = backwards.known = 5;
  std::vector<PoseRow> pose(5);
  for (const ParticleId p : s.state.r.ids()) pose[backwards.row[p].value].r = s.state.r[p];

  BondIndex index(backwards, s.state.bonds);
  Bonding bonding(s.model, stage, backwards, index);
  const Team team = testing::team_of(1, 5);
  const std::vector<Bonding::Pair> pairs = bonding.find(pose, team);
  ASSERT_EQ(pairs.size(), 4u);
  const std::size_t wanted[4][3] = {{0, 1, 2}, {0, 2, 3}, {1, 0, 1}, {1, 0, 3}};  // rule, i, j
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(stage.bonding[pairs[k].rule].name, stage.bonding[wanted[k][0]].name) << k;
    EXPECT_EQ(pairs[k].i.value, wanted[k][1]) << k;
    EXPECT_EQ(pairs[k].j.value, wanted[k][2]) << k;
  }

  bonding.make(pairs, s.state);
  ASSERT_EQ(s.state.bonds.size(), 4u);
  EXPECT_EQ(s.state.bonds[BondId{3}].j, ParticleId{3});
  index = BondIndex(backwards, s.state.bonds);
  EXPECT_TRUE(bonding.find(pose, team).empty());  // bonded pairs are not found again
}

}  // namespace
}  // namespace vbond
