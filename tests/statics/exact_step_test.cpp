// The largest stable step of leap-frog: reference values, and runs just below and just above it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "validation/cases.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

double reference(const char* name) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/statics.json");
  return nlohmann::json::parse(file).at("stability_limits").at(name);
}

std::vector<Support> pinned_ends() {
  return {testing::held({ParticleId{0}, ParticleId{9}}, testing::translations)};
}

TEST(ExactCriticalStep, OfThePapersRodIsTheReference) {
  const testing::Specimen s = testing::straight_rod(10);
  EXPECT_NEAR(exact_critical_step(s.model, s.state, {}) / s.model.T_0 / reference("rod_free_dt_over_T0"), 1.0,
              1e-10);
  EXPECT_NEAR(
      exact_critical_step(s.model, s.state, pinned_ends()) / s.model.T_0 / reference("rod_pinned_dt_over_T0"),
      1.0, 1e-10);
}

TEST(ExactCriticalStep, IsAboveTheElementBound) {
  const testing::Specimen s = testing::straight_rod(10);
  const double bound = step_bound(s.model, s.state).dt, exact = exact_critical_step(s.model, s.state, {});
  EXPECT_GT(exact, bound);
  EXPECT_LT(exact, 1.02 * bound);  // some per cent, see step_bound
}

TEST(ExactCriticalStep, IsInfiniteWhereNothingSwings) {
  const testing::Specimen loose = testing::particles_at({{0, 0, 0}, {5, 0, 0}});
  EXPECT_TRUE(std::isinf(exact_critical_step(loose.model, loose.state, {})));
  const testing::Specimen s = testing::straight_rod(2);
  EXPECT_TRUE(std::isinf(exact_critical_step(
      s.model, s.state, {testing::held({ParticleId{0}, ParticleId{1}}, testing::clamped)})));
}

// Two particles that touch: omega^2 = 2 k_c / m.
TEST(ExactCriticalStep, CountsPresentContacts) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.75, 0, 0}});
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::all, 1.0, 1.0, 0, 0};
  const double k_c = contact_stiffness(paper_hertz(1.0, 1.0), 0.05);
  EXPECT_NEAR(exact_critical_step(s.model, s.state, {}), 2 / std::sqrt(2 * k_c), 1e-9);
}

/// The largest displacement, after 400 steps, of a rod struck at random, over that which the blow causes in a
/// quarter period of its fastest mode.
double growth(double share, const std::vector<Support>& supports) {
  testing::Specimen s = testing::straight_rod(10);
  testing::Dice dice(1);
  const double speed = 1e-12;
  for (const ParticleId p : s.state.v.ids())
    for (int k = 0; k < 3; ++k) {
      component(s.state.v[p], k) = dice(-speed, speed);
      component(s.state.omega[p], k) = dice(-speed, speed);
    }
  Stage stage = testing::plain_stage(share * exact_critical_step(s.model, s.state, supports), 1e99);
  stage.supports = supports;
  Simulation run(s.model, stage, s.state);
  for (int n = 0; n < 400; ++n) run.step();
  double largest = 0.0;
  for (const ParticleId p : s.state.r.ids())  // along the rod: its fastest mode is axial
    largest = std::max(largest, std::abs(run.state().r[p].x - p.value - run.state().r[ParticleId{0}].x));
  return largest / speed;
}

// Above, the fastest mode grows by acosh(2 * 1.001^2 - 1) = 0.0894 a step, exp(36) = 3e15 in 400 steps, until
// bonds turn over. Below, by 1 / sqrt(1 - 0.999^2) = 22 in all, and so by less than 10 modes with 22 each.
TEST(ExactCriticalStep, IsWhereLeapFrogBlowsUp) {
  for (const std::vector<Support>& supports : {std::vector<Support>{}, pinned_ends()}) {
    EXPECT_LT(growth(0.999, supports), 1e3);
    EXPECT_GT(growth(1.001, supports), 1e8);
  }
}

// ---- bonds under tension and pressure --------------------------------------------------------------

/// Three particles in a row whose bonds are soft but for stretching, and pull.
testing::Specimen prestrained_row() {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 1e-4, 1e-7, 1e-7};
  recipe.attachment = Attachment::given, recipe.R_i = recipe.R_j = 0.4;
  recipe.prestrain = 0.3;
  testing::Specimen s = testing::straight_rod(3, recipe);
  for (double& inertia : s.model.inertia) inertia = 1e-4;
  return s;
}

// The middle turns against both bonds, and is held by N R (1 + R/D) of each; N = 0.2 - 0.2/1.3.
TEST(StepBound, KnowsThatTensionHoldsBondsStraight) {
  const testing::Specimen s = prestrained_row();
  const std::vector<Support> ends{testing::held({ParticleId{0}, ParticleId{2}}, testing::translations)};
  const double exact = exact_critical_step(s.model, s.state, ends);
  EXPECT_NEAR(exact, 0.0530321, 1e-6);
  const StepBound bound = step_bound(s.model, s.state);
  EXPECT_LT(bound.dt, exact);
  EXPECT_GT(bound.dt, 0.8 * exact);
  EXPECT_EQ(bound.source.substr(0, 36), "turning against the tension of bond ") << bound.source;
}

// Never longer than the exact step of the body as it stands. What presses makes bodies slower, which the
// bound leaves out.
TEST(StepBound, IsBelowTheExactStepOfPrestrainedBodies) {
  const testing::Tally tally =
      testing::campaign("prestrained bodies", 200, [](unsigned seed, testing::Tally& t) {
        testing::Dice dice(seed);
        testing::Specimen s = testing::random_body(dice);
        s.state.bonds = {};
        for (double& inertia : s.model.inertia) inertia = dice.ratio(1e-5, 0.2);
        BondRecipe recipe;
        if (dice.chance(0.5)) recipe.law = &bond_law<Evm>;
        recipe.parameters = BondStiffness<double>{dice(0.3, 1), dice.ratio(1e-4, 1.0), dice.ratio(1e-6, 0.1),
                                                  dice.ratio(1e-6, 0.1)};
        recipe.attachment = Attachment::given, recipe.R_i = dice(0.0, 0.25), recipe.R_j = dice(0.0, 0.25);
        if (dice.chance(0.3))
          recipe.rules.stretch = {StretchForm::cubic, dice(0, 1), dice(1, 4), 1, 0, 0, {}};
        testing::Specimen at_rest = s;
        testing::bond_near(at_rest, 1.5, recipe);
        recipe.prestrain = dice(-0.4, 0.8);
        testing::bond_near(s, 1.5, recipe);
        const double bound = step_bound(s.model, s.state).dt,
                     exact = exact_critical_step(s.model, s.state, {});
        t.below("bound over exact step", bound / exact, 1.0 + 1e-9);  // eigenvalues are known to 1e-10
        if (recipe.prestrain > 0.0) t.most("exact step over bound", exact / bound);
        // what a bound of the same body without prestrain would do
        if (!(step_bound(at_rest.model, at_rest.state).dt < exact)) t.add("at rest it would be too long");
      });
  EXPECT_EQ(tally["right"], tally.cases);
  if (tally.full) {
    EXPECT_GT(tally.sum("at rest it would be too long"), 20);
    EXPECT_LT(tally.largest("exact step over bound"), 3.0);
  }
}

}  // namespace
}  // namespace vbond
