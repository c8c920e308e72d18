// Bonds that stretch by other forms, damp and break, in motion: reference cases.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "material_cases.hpp"
#include "rods.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond::breaking_test {
namespace {

using testing::Dice;
using testing::material_case;
using testing::Specimen;

constexpr BondStiffness<double> slender_bond{1.0, 0.03, 0.0025, 1.0 / 480};
BondRecipe ruled(const BondRules& rules, const BondLaw* law = &bond_law<VModel>) {
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = slender_bond;
  recipe.rules = rules;
  return recipe;
}

// ---- recipes ---------------------------------------------------------------------------------------

TEST(Weibull, FactorsOfGivenVariatesMatchTheReference) {
  const auto expected = material_case("WB2")["expected"];
  for (const auto& c : expected) {
    Weibull w;
    w.modulus = 6.0, w.volume = 1.0;
    EXPECT_NEAR(2.0 * weibull_factor(w, c["u"], c["V_over_V0"]), c["s"], 1e-12);
  }
}

// WB1: the weakest of n bonds, 4000 chains each; the mean is within 4 standard errors, the chance of missing
// that in one of nine is below 1e-3, and the seed is fixed.
TEST(Weibull, WeakestOfAChainHasTheReferencesMean) {
  const auto expected = material_case("WB1")["expected"];
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 0.002};
  recipe.rules.strength = elongation_strength(1.0);
  const int chains = 4000;
  for (const int m : {3, 8, 20})
    for (const int n : {1, 10, 100}) {
      recipe.weibull.modulus = m;
      recipe.weibull.seed = static_cast<std::uint64_t>(n + m);
      double sum = 0.0;
      for (int chain = 0; chain < chains; ++chain) {
        double weakest = INFINITY;
        for (int k = 0; k < n; ++k) {
          const std::size_t i = static_cast<std::size_t>(chain * (n + 1) + k);
          const auto bond =
              make_bond(recipe, {ParticleId{i}, {0, 0, 0}, {}, 0.0}, {ParticleId{i + 1}, {1, 0, 0}, {}, 0.0});
          weakest = std::min(weakest, 1.0 / (1.0 + bond->coefficients[8]));
        }
        sum += weakest;
      }
      const auto& want = expected["m=" + std::to_string(m) + " n=" + std::to_string(n)];
      EXPECT_NEAR(sum / chains, want["mean"], 4.0 * want["std"].get<double>() / std::sqrt(chains))
          << "m = " << m << ", n = " << n;
    }
}

TEST(Rules, ComeBackFromTheirNumbers) {
  BondRules rules;
  rules.stretch.form = StretchForm::table;
  rules.stretch.k3 = 1, rules.stretch.k4 = 2, rules.stretch.compression = 3, rules.stretch.largest = 4;
  rules.stretch.alpha = 5, rules.stretch.table.count = 3;
  for (std::size_t k = 0; k < StretchTable::most; ++k) {
    const double x = static_cast<double>(k);
    rules.stretch.table.D[k] = 6 + x, rules.stretch.table.U[k] = 7 * x, rules.stretch.table.curvature[k] = -x;
  }
  rules.strength = {Criterion::energy, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  rules.damped = true;
  rules.rubbing = {0.5, 12};
  const auto back = rules_of(numbers_of(rules));
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(*back == rules);
  RuleNumbers damaged = numbers_of(no_rules);
  damaged[0] = 17.0;
  EXPECT_FALSE(rules_of(damaged).has_value());
}

// ---- stretching: NL1 -------------------------------------------------------------------------------

/// Time from the start until the elongation has crossed `level` upwards twice, less the first time: a period.
double period_of(const Stretch& stretch, double u, double v, double level, double dt) {
  BondRules rules;
  rules.stretch = stretch;
  Specimen s = testing::straight_rod(2, ruled(rules));
  s.state.r[ParticleId{1}].x += u;
  s.state.v[ParticleId{1}].x = v;
  Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
  std::vector<double> crossings;
  double before = u, t = 0.0;
  while (crossings.size() < 2) {
    run.step(), t += dt;
    const State& at = run.state();
    const double now = at.r[ParticleId{1}].x - at.r[ParticleId{0}].x - 1.0;
    if (before < level && now >= level) crossings.push_back(t - dt * (now - level) / (now - before));
    before = now;
  }
  return crossings[1] - crossings[0];
}

// Two free particles of mass 1. Leap-frog's period is short by (omega dt)^2/24 of it, 4e-8 for omega = sqrt 2
// (fene: up to omega = 5, 5e-7), the line between two steps adds some 1e-8.
TEST(StretchingForms, SwingWithThePeriodsOfTheReference) {
  const nlohmann::json nl1 = material_case("NL1")["expected"];
  Stretch morse, fene, cubic, two_slopes;
  morse.form = StretchForm::morse, morse.alpha = 5.0;
  fene.form = StretchForm::fene, fene.largest = nl1["fene"]["s"];
  cubic.form = StretchForm::cubic, cubic.k3 = nl1["cubic"]["k3"], cubic.k4 = nl1["cubic"]["k4"];
  two_slopes.form = StretchForm::two_slopes, two_slopes.compression = nl1["bilinear"]["c_minus"];
  const double dt = 7e-4;
  const auto expect = [&](const char* name, double period) {
    EXPECT_NEAR(period / nl1[name]["period"].get<double>(), 1.0, 1e-6) << name;
  };
  expect("morse", period_of(morse, nl1["morse"]["u_max"], 0.0, 0.0, dt));
  expect("fene", period_of(fene, nl1["fene"]["amplitude"], 0.0, 0.0, dt));
  expect("cubic", period_of(cubic, nl1["cubic"]["u_max"], 0.0, 0.0, dt));
  expect("bilinear", period_of(two_slopes, 0.0, nl1["bilinear"]["v_rel"], 1e-9, dt));
}

// The force of a FENE bond has no limit as it nears its largest elongation; past it the run stops and names
// it.
TEST(StretchingForms, FenePastItsLargestElongationStopsTheRunByName) {
  BondRules rules;
  rules.stretch.form = StretchForm::fene, rules.stretch.largest = 0.3;
  Specimen s = testing::straight_rod(4, ruled(rules));
  s.state.r[ParticleId{3}].x += 0.31;
  try {
    const Simulation run(s.model, testing::plain_stage(1e-3, 1e9), s.state);
    FAIL() << "began";
  } catch (const Diverged& e) {
    EXPECT_NE(std::string(e.what()).find("bond 2 (particles 2, 3)"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("largest elongation"), std::string::npos) << e.what();
  }
}

// ---- breaking: FB1 ----------------------------------------------------------------------------

// FB1: twenty parallel bonds with given strengths, pulled at a constant rate, in one step of 1e-4 elongation
// after another: which bond is next, the force before, and the energy released.
TEST(BreakingBonds, OfABundleGoOneAfterAnotherAsInTheExactList) {
  const nlohmann::json fb1 = material_case("FB1")["expected"];
  const auto& thresholds = fb1["thresholds"];
  std::vector<Vec3d> r;
  for (const double z : {0.0, 1.0})
    for (int k = 0; k < 20; ++k) r.push_back({3.0 * k, 0, z});
  Specimen s = testing::particles_at(r);
  std::vector<ParticleId> lower, upper;
  for (std::size_t k = 0; k < 20; ++k) {
    BondRules rules;
    rules.strength = linear_strength(thresholds[19 - k], 1e9, 1e9, 1e9);  // the weakest is the last
    testing::bond(s, k, k + 20, ruled(rules));
    lower.push_back(ParticleId{k}), upper.push_back(ParticleId{k + 20});
  }
  const double rate = 0.01, dt = 0.01;
  Stage stage = testing::plain_stage(dt, 1e9);
  stage.supports.push_back(testing::held(lower, testing::clamped));
  stage.supports.push_back(testing::held(upper, testing::clamped, {0, 0, rate}));
  Simulation run(s.model, stage, s.state);
  double force_before = 0.0;
  std::size_t seen = 0;
  for (const auto& step : fb1["displacement_control"]) {
    while (run.events().size() == seen) {
      force_before = run.reaction(upper).force.z;
      run.step();
    }
    ASSERT_EQ(run.events().size(), seen + 1);
    EXPECT_EQ(run.events()[seen].bond, BondId{19 - seen});
    ++seen;
    const double one_step = rate * dt * 20.0;  // of all bonds
    EXPECT_NEAR(run.clock().time() * rate, step["displacement"], 1.001 * rate * dt);
    EXPECT_NEAR(force_before, step["force_before"], one_step);
    EXPECT_NEAR(run.reaction(upper).force.z, step["force_after"], one_step);
    EXPECT_NEAR(run.books().released, step["released_total"], one_step * static_cast<double>(seen));
  }
  EXPECT_EQ(seen, 20u);
}

// Damping and breaking leave the books closed to the order of the step: kinetic + stored + dissipated +
// released against the start.
TEST(BreakingBonds, KeepTheBooksToTheOrderOfTheStep) {
  const auto error = [](double dt) {
    BondRules rules;
    rules.stretch.form = StretchForm::cubic, rules.stretch.k3 = -0.5, rules.stretch.k4 = 2.0;
    rules.strength = linear_strength(0.05, 0.02, 0.01, 0.01);
    BondRecipe recipe = ruled(rules);
    recipe.damping = {DampingBy::ratio, {0.05, 0.05, 0.05, 0.05}};
    Specimen s = testing::straight_rod(30, recipe);
    Dice dice(4);
    for (const ParticleId p : s.state.r.ids())
      s.state.v[p] = {dice(-.06, .06), dice(-.06, .06), dice(-.06, .06)};
    Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
    double worst = 0.0;
    while (run.clock().time() < 40.0) {
      run.step();
      worst = std::max(worst, std::abs(run.balance_error()));
    }
    EXPECT_GE(run.events().size(), 3u);
    EXPECT_GT(run.books().dissipated, 0.05 * run.books().at_start);
    return worst;
  };
  const double coarse = error(0.02), fine = error(0.01);
  EXPECT_LT(fine, 1e-3);
  EXPECT_GT(coarse / fine, 1.7);
}

TEST(StepBoundOfRules, CountsDampingAndTheStiffestSlope) {
  const auto bound = [](const BondRecipe& recipe) {
    const Specimen s = testing::straight_rod(4, recipe);
    return step_bound(s.model, s.state).dt;
  };
  BondRules stiff;
  stiff.stretch.form = StretchForm::two_slopes, stiff.stretch.compression = 4.0;
  BondRecipe damped = ruled(no_rules);
  damped.damping = {DampingBy::time, {1.0, 0, 0, 0}};
  const double plain = bound(ruled(no_rules));
  EXPECT_NEAR(bound(ruled(stiff)), 0.5 * plain, 1e-12);  // stretching governs here
  // one mode: dt = sqrt(beta^2 + 4/lambda) - beta, with 4/lambda = plain^2
  EXPECT_NEAR(bound(damped), std::sqrt(1.0 + sq(plain)) - 1.0, 1e-9);
}

}  // namespace
}  // namespace vbond::breaking_test
