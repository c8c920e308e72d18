// Balances, paths, modes and fracture beside grains that have contacts but no bonds: nothing turns them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "vbond/physics/laws.hpp"
#include "walks.hpp"

namespace vbond::free_turns_test {
namespace {

using testing::fixed;
using testing::pushed;
using testing::Specimen;
using testing::static_stage;
using testing::walk;
using testing::Walked;

constexpr HeldDofs on_a_line{true, true, false, false, false, false};

/// A shallow truss of two bonds whose outer particles are held, and whose middle particle does not turn.
Specimen truss() {
  Specimen s = testing::particles_at({{-1, 0, 0}, {0, 0, 0.1}, {1, 0, 0}});
  BondRecipe recipe;
  recipe.parameters = GivenCoefficients{{1.0, 0.0, 1e-5, 1e-5}};
  recipe.n_2 = Vec3d{0, 1, 0};
  testing::bond(s, 0, 1, recipe);
  testing::bond(s, 1, 2, recipe);
  return s;
}
/// A force of 1e-3 pushes the middle down: some two and a half times what the truss carries.
StaticStage pushed_truss(StageKind kind) {
  StaticStage stage = static_stage(kind,
                                   {fixed({ParticleId{0}, ParticleId{2}}, testing::clamped),
                                    fixed({ParticleId{1}}, {false, true, false, true, true, true})},
                                   {pushed(1, {0, 0, -1e-3})});
  stage.path.above = 1.0;
  return stage;
}

/// The same, and far off a grain that a constant force presses onto one that is held.
Specimen beside_a_grain(const Specimen& alone, StaticStage& stage) {
  std::vector<Vec3d> r(alone.state.r.begin(), alone.state.r.end());
  const std::size_t n = r.size();
  r.push_back({0, 0, 50});
  r.push_back({0, 0, 50.79});
  Specimen s = testing::particles_at(r);
  s.state.bonds = alone.state.bonds;
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::unbonded};
  s.model.contact.k = 0.1;
  stage.supports.push_back(fixed({ParticleId{n}}, testing::clamped));
  stage.supports.push_back(fixed({ParticleId{n + 1}}, on_a_line));
  stage.loads.push_back(pushed(n + 1, {0, 0, -1e-3}));
  stage.loads.back().constant = true;
  return s;
}

std::string told_of(const Specimen& s, const StaticStage& stage, StaticResult* result = nullptr) {
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text + "\n"; };
  const StaticOutcome end = run_static_stage(s.model, stage, s.state, hooks);
  if (result) *result = end.result;
  return told;
}

TEST(FreeTurns, LeaveAPathAsItIs) {
  const StaticStage alone = pushed_truss(StageKind::path);
  StaticStage stage = alone;
  const Specimen both = beside_a_grain(truss(), stage);
  const Walked without = walk(truss(), alone), with = walk(both, stage);
  ASSERT_EQ(without.result.special_points.size(), 2u);
  ASSERT_EQ(with.result.special_points.size(), 2u);
  for (const std::size_t k : {0u, 1u})  // where they are found is left to rounding of 1e-8
    EXPECT_NEAR(with.result.special_points[k].load_factor, without.result.special_points[k].load_factor,
                1e-8);
  EXPECT_EQ(with.result.free_turns, 3);
  EXPECT_EQ(with.result.smallest_eigenvalue, 0.0);
}

// A jump shows where the tangent says whence the body came.
TEST(FreeTurns, HideNoJump) {
  StaticStage stage = pushed_truss(StageKind::equilibrium);
  stage.steps = 20;
  const Specimen s = beside_a_grain(truss(), stage);
  StaticResult result;
  EXPECT_NE(told_of(s, stage, &result).find("the body jumped"), std::string::npos);
  EXPECT_TRUE(result.jumped);
  EXPECT_TRUE(result.neutral);
}

TEST(FreeTurns, AreCountedAndToldOnce) {
  StaticStage stage = pushed_truss(StageKind::equilibrium);
  stage.steps = 4;
  stage.loads[0].force = {0, 0, -1e-4};
  const Specimen s = beside_a_grain(truss(), stage);
  StaticResult result;
  const std::string told = told_of(s, stage, &result), text = "nothing turns particle 4: 3 turns meet no";
  EXPECT_NE(told.find(text), std::string::npos) << told;
  EXPECT_EQ(told.find(text), told.rfind(text)) << told;
  EXPECT_EQ(result.free_turns, 3);
  stage.supports.back().held = {true, true, false, false, true, true};
  told_of(s, stage, &result);
  EXPECT_EQ(result.free_turns, 1);
  stage.supports.back().held = {true, true, false, true, true, true};
  told_of(s, stage, &result);
  EXPECT_EQ(result.free_turns, 0);
  EXPECT_FALSE(result.neutral);
}

// A support bears a moment about what it holds; nothing does about the rest.
TEST(FreeTurns, UnderAMomentAreRefusedByName) {
  for (const StageKind kind :
       {StageKind::equilibrium, StageKind::path, StageKind::fracture, StageKind::modes}) {
    SCOPED_TRACE(static_cast<int>(kind));
    StaticStage stage = pushed_truss(kind);
    const Specimen s = beside_a_grain(truss(), stage);
    stage.loads[0].force = {0, 0, -1e-5};
    stage.loads.push_back(pushed(4, {}, {0, 0, 1e-5}));
    EXPECT_NE(testing::refusal(s, stage).find("can move freely: rotation about z of particle 4"),
              std::string::npos)
        << testing::refusal(s, stage);
    stage.supports.back().held = {true, true, false, false, false, true};
    EXPECT_EQ(testing::refusal(s, stage), "");
  }
}

// Such as those of two loads that are listed apart. Moments that cancel at one load factor alone do not.
TEST(FreeTurns, UnderMomentsThatCancelAreFree) {
  StaticStage stage = pushed_truss(StageKind::equilibrium);
  const Specimen s = beside_a_grain(truss(), stage);
  stage.loads[0].force = {0, 0, -1e-5};
  stage.loads.push_back(pushed(4, {}, {0, 1e-5, 3e-5}));
  stage.loads.push_back(pushed(4, {}, {0, -1e-5, -3e-5}));
  EXPECT_EQ(testing::refusal(s, stage), "");
  StaticResult result;
  told_of(s, stage, &result);
  EXPECT_EQ(result.free_turns, 3);
  stage.loads.back().constant = true;
  EXPECT_NE(testing::refusal(s, stage).find("can move freely: rotation about y of particle 4"),
            std::string::npos)
      << testing::refusal(s, stage);
}

// A support turns the grain, and a moment along y with it, which comes to act about z.
TEST(FreeTurns, UnderAMomentThatIsTurnedOntoThemAreRefusedByName) {
  StaticStage stage = pushed_truss(StageKind::equilibrium);
  const Specimen s = beside_a_grain(truss(), stage);
  stage.loads[0].force = {0, 0, -1e-5};
  stage.loads.push_back(pushed(4, {}, {0, 1e-5, 0}));
  stage.loads.back().follower = true;
  stage.supports.back().held = {true, true, false, true, true, false};
  EXPECT_EQ(testing::refusal(s, stage), "");
  stage.supports.back().angular_velocity = {1.5, 0, 0};
  EXPECT_NE(testing::refusal(s, stage).find("can move freely: rotation about z of particle 4"),
            std::string::npos)
      << testing::refusal(s, stage);
}

// They are modes of frequency zero, before which the others would not be found.
TEST(FreeTurns, AreNotListedAmongModesButTold) {
  const StaticStage alone = pushed_truss(StageKind::modes);
  StaticStage stage = alone;
  const Specimen both = beside_a_grain(truss(), stage);
  stage.loads[0].force = {};
  stage.count = 3;
  StaticResult result;
  EXPECT_NE(told_of(both, stage, &result).find("3 modes of frequency zero are not listed"),
            std::string::npos);
  ASSERT_EQ(result.modes.size(), 3u);  // of the middle along x and z, and of the grain along z
  for (const NaturalMode& m : result.modes) EXPECT_GT(m.omega2, 1e-3);
  EXPECT_EQ(result.free_turns, 3);
}

/// A chain of five particles, bent by gravity and by a movement of its end, whose bonds yield; a grain rests
/// on the end.
StaticResult yielding_chain_below_a_grain() {
  Specimen s = testing::particles_at(
      {{0, 0, 0.5}, {0.9, 0, 0.8}, {1.8, 0, 0.5}, {2.7, 0, 0.8}, {3.6, 0, 0.5}, {3.6, 0, 1.47}}, 0.5);
  s.model.mass[ParticleId{5}] = 0.2;
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::all};
  s.model.contact.k = 80.0;
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{10.15, 4.0, 0.0571, 0.045};
  recipe.rules.yield.limit.axial = recipe.rules.yield.compression = 0.18;
  recipe.rules.yield.limit.bending = 0.045;
  recipe.rules.yield.isotropic.axial = 2.0;
  recipe.rules.yield.isotropic.bending = 0.3;
  for (std::size_t k = 0; k < 4; ++k) testing::bond(s, k, k + 1, recipe);
  StaticStage stage = static_stage(
      StageKind::equilibrium, {fixed({ParticleId{0}}, testing::clamped),
                               fixed({ParticleId{4}}, testing::clamped, {-0.077861, -0.167779, 0.105342}),
                               fixed({ParticleId{5}}, on_a_line)});
  stage.gravity = {0, 0, -1};
  stage.constant_gravity = true;
  stage.steps = 2;
  return run_static_stage(s.model, stage, s.state, {}).result;
}

// Where flow has no potential of its own, Newton's method alone leads to balance: turns that meet nothing
// must not make its tangent singular.
TEST(FreeTurns, LeadYieldingBondsToBalance) {
  const StaticResult r = yielding_chain_below_a_grain();
  EXPECT_EQ(r.ended, "converged");
  EXPECT_LT(r.points, 100);
}

/// A ball far above a floor, on the side of the upper one of two bonded particles, which it overlaps by 0.02:
/// the contact pushes it off with twenty times its weight. At the start nothing but the relief keeps it
/// there.
Specimen ball_on_the_side_of_another() {
  const double lean = 0.3, apart = 0.98;
  Specimen s = testing::particles_at(
      {{0, 0, 3}, {apart * std::sin(lean), 0, 3 + apart * std::cos(lean)}, {0, 0, 2}}, 0.5);
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::unbonded};
  s.model.contact.k = 1.0;
  s.model.walls = {{"floor", PlaneWall{{0, 0, 0}, {0, 0, 1}}, 0, {}}};
  testing::bond(s, 0, 2, testing::papers_bond());
  return s;
}

// What is left of the relief has a part along the floor, which would push the ball on for ever. Let go
// without it the ball comes to lie on the floor.
TEST(Relief, IsDroppedWhereNothingBearsTheBodyWithIt) {
  const Specimen s = ball_on_the_side_of_another();
  StaticStage stage = static_stage(StageKind::equilibrium,
                                   {fixed({ParticleId{0}, ParticleId{2}}, testing::clamped),
                                    fixed({ParticleId{1}}, {false, true, false, false, false, false})});
  stage.gravity = {0, 0, -1e-3};
  stage.constant_gravity = true;
  stage.steps = 5;
  const Walked w = walk(s, stage);
  EXPECT_TRUE(w.result.jumped);
  EXPECT_EQ(w.result.unstable.value_or(1), 0);
  const double sunk = s.model.mass[ParticleId{1}] * 1e-3 / s.model.contact.k;
  EXPECT_NEAR(w.last().r[ParticleId{1}].z, 0.5 - sunk, 1e-9);
  EXPECT_NE(told_of(s, stage).find("was let go without them"), std::string::npos);
}

// Pressed onto another one by the relief a ball stands there unstably, and falls for ever once it is off. Let
// go without the relief it is lifted to a ceiling by its load: it went back, and left no unstable balance.
TEST(Relief, IsDroppedWhereItHoldsAnUnstableBalanceWithNoneDownhill) {
  Specimen s = testing::particles_at({{0, 0, 0}, {0, 0, 0.98}}, 0.5);
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::unbonded};
  s.model.contact.k = 1.0;
  s.model.walls = {{"ceiling", PlaneWall{{0, 0, 3}, {0, 0, -1}}, 0, {}}};
  StaticStage stage = static_stage(StageKind::equilibrium,
                                   {fixed({ParticleId{0}}, testing::clamped),
                                    fixed({ParticleId{1}}, {false, true, false, false, false, false})});
  stage.loads = {pushed(1, {0, 0, 1e-3})};
  stage.loads[0].constant = true;
  stage.steps = 5;
  StaticResult result;
  const std::string told = told_of(s, stage, &result);
  EXPECT_NE(told.find("is unstable, and none was found downhill from it, beside the forces that were out of "
                      "balance at the start, which fade: the body went back to load factor 0, was let go "
                      "without them"),
            std::string::npos)
      << told;
  EXPECT_TRUE(result.jumped);
  EXPECT_FALSE(result.left_saddle);
  EXPECT_NEAR(walk(s, stage).last().r[ParticleId{1}].z, 2.5 + 1e-3 / s.model.contact.k, 1e-9);
}

/// A grain that a bond of little strength holds on one below it, and that a support moves aside; beside them
/// a fibre that is drawn out.
Specimen grain_and_fibre() {
  Specimen s = testing::particles_at({{0, 0, 0}, {0, 0, 0.98}, {5, 0, 0}, {5, 0, 1}}, 0.5);
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::unbonded};
  s.model.contact.k = 1.0;
  BondRecipe recipe;
  recipe.law = &bond_law<WithRules<VModel>::Law>;
  recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.1};
  recipe.rules.strength = linear_strength(0.05, 1e-3, 1e30, 1e30);
  testing::bond(s, 0, 1, recipe);
  testing::bond(s, 2, 3, recipe);
  return s;
}

// Once the grain has broken off it rests on the one below it, and turns freely. The fibre breaks later.
TEST(FreeTurns, OfAGrainThatHasBrokenOffDoNotEndAFracture) {
  const Specimen s = grain_and_fibre();
  StaticStage stage =
      static_stage(StageKind::fracture, {fixed({ParticleId{0}, ParticleId{2}}, testing::clamped),
                                         fixed({ParticleId{1}}, on_a_line, {0.1, 0, 0}),
                                         fixed({ParticleId{3}}, testing::clamped, {0, 0, 0.1})});
  stage.gravity = {0, 0, -0.01};
  stage.constant_gravity = true;
  StaticResult result;
  const std::string told = told_of(s, stage, &result);
  EXPECT_EQ(result.ended, "load factor") << told;
  ASSERT_EQ(result.fracture.breaks.size(), 2u);
  EXPECT_EQ(result.fracture.breaks[0].use.bond, BondId{0});
  EXPECT_NEAR(result.fracture.breaks[1].use.load_factor, 0.5, 1e-9);
  EXPECT_EQ(result.free_turns, 3);
  EXPECT_NE(told.find("nothing turns particle 1"), std::string::npos) << told;
}

}  // namespace
}  // namespace vbond::free_turns_test
