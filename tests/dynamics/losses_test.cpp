// What is dissipated, by cause: in each body only what is there takes energy, and the causes add up to what
// the books count.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "rods.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond::losses_test {
namespace {

using testing::Specimen;

BondRecipe recipe_with(const BondRules& rules) {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  recipe.rules = rules;
  return recipe;
}
BondRules yielding() {
  BondRules rules;
  rules.yield.limit = {0.01, 1e-3, 2e-4, 1e-4};
  rules.yield.compression = 0.012;
  rules.yield.isotropic = {0.05, 1e-3, 1e-4, 1e-4};
  rules.yield.kinematic = {0.05, 0.0, 1e-4, 1e-4};
  return rules;
}

/// A chain of eight of these bonds, thrown about.
Specimen lively(const BondRecipe& recipe, double speed = 0.05) {
  return testing::lively_chain(recipe, speed);
}

/// Runs, and finds that these causes and no others took energy, at every step, and all of it.
Losses losses_in(const Specimen& s, const Stage& stage, int steps, std::initializer_list<Loss> expected) {
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < steps; ++k) {
    run.step();
    const Losses lost = losses_of(run);
    double sizes = 0.0;
    for (const double x : lost.of) sizes += std::abs(x);
    // some roundings a step of numbers no larger than these
    EXPECT_NEAR(lost.sum(), run.books().dissipated, 1e-15 * (k + 10) * std::max(sizes, 1e-3)) << "step " << k;
  }
  const Losses lost = losses_of(run);
  for (std::size_t k = 0; k < loss_count; ++k) {
    const auto cause = static_cast<Loss>(k);
    const bool wanted = std::find(expected.begin(), expected.end(), cause) != expected.end();
    EXPECT_EQ(lost[cause] > 0.0, wanted) << "cause " << k << ": " << lost[cause];
  }
  EXPECT_GT(run.books().dissipated, 0.005 * run.books().at_start);
  return lost;
}

TEST(Losses, OfBondsThatYieldAreByChannelTheLimitsTimesTheFlow) {
  const Specimen s = lively(recipe_with(yielding()));
  losses_in(s, testing::plain_stage(0.05, 1e9), 600,
            {Loss::yield_axial, Loss::yield_shear, Loss::yield_bending, Loss::yield_torsion});
  // along the axis alone, in tension and in compression, by hand: 0.03 of elongation with c_A = 1
  BondRules rules;
  rules.yield.limit.axial = 0.01, rules.yield.compression = 0.02;
  Specimen pair = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  testing::bond(pair, 0, 1, recipe_with(rules));
  Stage stage = testing::plain_stage(0.01, 1e9);
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped),
                    testing::held({ParticleId{1}}, testing::clamped, {0.1, 0, 0})};
  stage.supports[1].factor.points = {{0.3, 1}, {0.3, -1}};
  Simulation run(pair.model, stage, pair.state);
  for (int k = 0; k < 30; ++k) run.step();
  EXPECT_NEAR(losses_of(run)[Loss::yield_axial], 0.01 * 0.02, 1e-15);  // beyond 0.01 by 0.02
  for (int k = 0; k < 60; ++k) run.step();
  // back by 0.06 from u = 0.03 with N = 0.01: elastic until N = -0.02, then 0.03 more
  EXPECT_NEAR(losses_of(run)[Loss::yield_axial], 0.01 * 0.02 + 0.02 * 0.03, 1e-4 * 0.02);
}

TEST(Losses, OfCreepDampingAndSofteningAreKeptApart) {
  BondRules rules = yielding();
  rules.creep = {50.0, 3};
  BondRecipe recipe = recipe_with(rules);
  recipe.damping = {DampingBy::coefficients, {0.01, 0.001, 1e-4, 1e-4}};
  losses_in(lively(recipe), testing::plain_stage(0.05, 1e9), 600,
            {Loss::damping_axial, Loss::damping_shear, Loss::damping_bending, Loss::damping_torsion,
             Loss::yield_axial, Loss::yield_shear, Loss::yield_bending, Loss::yield_torsion, Loss::creep});
  BondRules soft;
  soft.softening = {0.02, 0.5};
  losses_in(lively(recipe_with(soft)), testing::plain_stage(0.05, 1e9), 600, {Loss::softening});
}

/// A pair of bonded particles that moves apart at `stretching` and turns about the axis at `twisting`.
Losses losses_of_pair(double stretching, double twisting) {
  Specimen pair = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  BondRecipe recipe = recipe_with({});
  recipe.damping = {DampingBy::coefficients, {0.02, 0.002, 2e-4, 2e-4}};
  testing::bond(pair, 0, 1, recipe);
  pair.state.v[ParticleId{1}] = {stretching, 0, 0};
  pair.state.omega[ParticleId{1}] = {twisting, 0, 0};
  Simulation run(pair.model, testing::plain_stage(0.01, 1e9), pair.state);
  for (int k = 0; k < 200; ++k) run.step();
  return losses_of(run);
}

TEST(Losses, OfDampingAreThoseOfTheChannelThatMoves) {
  const Losses stretched = losses_of_pair(0.01, 0.0), twisted = losses_of_pair(0.0, 0.01);
  EXPECT_GT(stretched[Loss::damping_axial], 0.0);
  EXPECT_EQ(stretched[Loss::damping_axial], stretched.sum());
  EXPECT_GT(twisted[Loss::damping_torsion], 0.0);
  EXPECT_EQ(twisted[Loss::damping_torsion], twisted.sum());
}

// Damping reads the rates of half a step before, which makes all that it takes of first order: half the step,
// half the error, in each channel.
TEST(Losses, OfDampingByChannelConverge) {
  const auto after = [](int finer) {
    BondRecipe recipe = recipe_with({});
    recipe.damping = {DampingBy::coefficients, {0.02, 0.004, 4e-4, 4e-4}};
    const Specimen s = lively(recipe);
    Simulation run(s.model, testing::plain_stage(0.01 / finer, 1e9), s.state);
    for (int k = 0; k < 400 * finer; ++k) run.step();
    return losses_of(run);
  };
  const Losses coarse = after(1), half = after(2), quarter = after(4);
  for (const Loss channel :
       {Loss::damping_axial, Loss::damping_shear, Loss::damping_bending, Loss::damping_torsion}) {
    EXPECT_NEAR(coarse[channel], quarter[channel], 1e-3 * quarter[channel]);
    const double ratio = (coarse[channel] - half[channel]) / (half[channel] - quarter[channel]);
    EXPECT_NEAR(ratio, 2.0, 0.1) << "channel " << static_cast<int>(channel);
  }
}

TEST(Losses, OfLocalDampingAreThoseOfTheSameBodyWhoseBondsDoNotDamp) {
  BondRecipe damped = recipe_with({});
  damped.damping = {DampingBy::coefficients, {0.02, 0.002, 2e-4, 2e-4}};
  Stage local = testing::plain_stage(0.05, 1e9);
  local.local_damping = 0.1;
  losses_in(lively(recipe_with({})), local, 300, {Loss::local_damping});
  losses_in(lively(damped), testing::plain_stage(0.05, 1e9), 300,
            {Loss::damping_axial, Loss::damping_shear, Loss::damping_bending, Loss::damping_torsion});
  local.b_translation = 0.01;
  losses_in(lively(damped), local, 300,
            {Loss::damping_axial, Loss::damping_shear, Loss::damping_bending, Loss::damping_torsion,
             Loss::local_damping, Loss::drag});
  // damping that is next to nothing leaves local damping as it is without
  damped.damping.values = {1e-9, 1e-9, 1e-9, 1e-9};
  local.b_translation = 0.0;
  const Losses both = losses_in(lively(damped), local, 100,
                                {Loss::damping_axial, Loss::damping_shear, Loss::damping_bending,
                                 Loss::damping_torsion, Loss::local_damping});
  const Losses alone = losses_in(lively(recipe_with({})), local, 100, {Loss::local_damping});
  EXPECT_NEAR(both[Loss::local_damping] / alone[Loss::local_damping], 1.0, 1e-6);
}

/// Two balls that meet aslant, one of them turning.
Specimen balls() {
  Specimen s = testing::particles_at({{0, 0, 0}, {1.05, 0.3, 0}});
  s.model.contact.law = ContactLaw::linear;
  s.model.contact.k = 10.0;
  s.model.radius.assign(2, 0.5);
  s.model.inertia.assign(2, 0.1);
  s.state.v[ParticleId{1}] = {-0.3, 0.2, 0.0};
  s.state.omega[ParticleId{1}] = {0.1, 0.2, 0.5};
  return s;
}

TEST(Losses, OfContactsAreByDampingFrictionAndRolling) {
  const Stage stage = testing::plain_stage(0.005, 1e9);
  Specimen s = balls();
  s.model.contact.surface.restitution = 0.6;
  losses_in(s, stage, 400, {Loss::contact_damping});
  s = balls();
  s.model.contact.tangential = TangentialForm::linear, s.model.contact.k_t = 5.0;
  s.model.contact.surface.friction = 0.1;
  losses_in(s, stage, 400, {Loss::friction});
  s.model.contact.surface.restitution = 0.6;
  s.model.contact.rolling = RollingForm::constant;
  s.model.contact.surface.rolling_friction = s.model.contact.surface.twisting_friction = 0.1;
  losses_in(s, stage, 400, {Loss::contact_damping, Loss::friction, Loss::rolling});
}

TEST(Losses, BeginAnewWithTheBooks) {
  const Specimen s = lively(recipe_with(yielding()));
  Simulation first(s.model, testing::plain_stage(0.05, 1e9), s.state);
  for (int k = 0; k < 300; ++k) first.step();
  State later = first.state();
  EXPECT_GT(losses_by_flow(later).sum(), 0.0);
  later.clock = {};
  Simulation second(s.model, testing::plain_stage(0.05, 1e9), later);
  EXPECT_EQ(losses_of(second), Losses{});
  EXPECT_EQ(second.books().dissipated, 0.0);
  for (int k = 0; k < 300; ++k) second.step();
  EXPECT_NEAR(losses_of(second).sum(), second.books().dissipated, 1e-15);
}

TEST(Losses, AreTheSameBitsAfterAnyResumption) {
  BondRules rules = yielding();
  rules.creep = {50.0, 3};
  BondRecipe recipe = recipe_with(rules);
  recipe.damping = {DampingBy::coefficients, {0.01, 0.001, 1e-4, 1e-4}};
  Stage stage = testing::plain_stage(0.05, 1e9);
  stage.local_damping = 0.1;
  const Specimen s = lively(recipe);
  const auto go_on = [&](State state, int steps) {
    Simulation run(s.model, stage, std::move(state));
    for (int k = 0; k < steps; ++k) run.step();
    return std::move(run).handover().state;
  };
  const State whole = go_on(s.state, 100);
  for (const int at : {1, 40, 99}) {
    const State again = go_on(go_on(s.state, at), 100 - at);
    EXPECT_TRUE(again == whole) << at;
    EXPECT_EQ(losses_of(again), losses_of(whole)) << at;
  }
}

}  // namespace
}  // namespace vbond::losses_test
