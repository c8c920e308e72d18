// Bonds that grow with temperature, in motion and at rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/rods.hpp"
#include "material_cases.hpp"
#include "statics/bodies.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/run/run.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond {
namespace {

using testing::Specimen;

constexpr double alpha = 1e-3;

BondRecipe warm(BondRecipe recipe = testing::papers_bond()) {
  recipe.expansion = alpha;
  return recipe;
}

/// A straight rod of N particles whose bonds expand.
Specimen warm_rod(std::size_t N, const BondRecipe& recipe) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < N; ++k) r.push_back({static_cast<double>(k), 0, 0});
  Specimen s = testing::particles_at(r);
  for (std::size_t k = 0; k + 1 < N; ++k)
    add_bond(s.model,
             make_bond(recipe, bond_site(s.model, s.state, ParticleId{k}),
                       bond_site(s.model, s.state, ParticleId{k + 1}))
                 .value(),
             recipe, s.state);
  return s;
}

StaticStage heated(StageKind kind, const Specimen& s, double change, std::vector<Support> supports) {
  StaticStage stage = testing::static_stage(kind, std::move(supports));
  stage.heating = {{s.model.groups[0].particles, change}};
  return stage;
}
Support clamp(std::size_t p) {
  return testing::fixed({ParticleId{p}}, testing::clamped);
}
ParticleId last(const Specimen& s) {
  return ParticleId{s.model.particles() - 1};
}

TEST(Heat, LetsAFreeRodGrowAndAHeldOnePush) {
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const double R : {0.0, 0.2}) {
      BondRecipe recipe = warm();
      recipe.law = law;
      recipe.attachment = Attachment::given, recipe.R_i = R, recipe.R_j = 0.5 * R;
      const Specimen s = warm_rod(6, recipe);
      const double c_A = stiffness_of(s.state.bonds[BondId{0}]).c_A, T = 0.1;  // it buckles at 0.3 and more
      vbond::Run free(s.model, s.state, {heated(StageKind::equilibrium, s, T, {clamp(0)})});
      free.run();
      EXPECT_NEAR(free.state().r[last(s)].x, 5.0 * (1.0 + alpha * T), 1e-12);
      EXPECT_NEAR(potential_energies(s.model, free.state()).total(), 0.0, 1e-15);
      // held at both ends: the whole distance grows, and the bond alone gives way
      vbond::Run held(s.model, s.state, {heated(StageKind::equilibrium, s, T, {clamp(0), clamp(5)})});
      held.run();
      EXPECT_NEAR(mean_axial_force(held.state(), s.model.groups[0].particles), -c_A * alpha * T, 1e-12 * c_A);
      EXPECT_EQ(held.state().temperature[last(s)], T);
      // and back again: nothing is left of it
      vbond::Run cycle(s.model, s.state,
                       {heated(StageKind::equilibrium, s, T, {clamp(0), clamp(5)}),
                        heated(StageKind::equilibrium, s, -T, {clamp(0), clamp(5)})});
      cycle.run();
      EXPECT_EQ(cycle.state().bonds[BondId{2}].a, s.state.bonds[BondId{2}].a);
      EXPECT_NEAR(mean_axial_force(cycle.state(), s.model.groups[0].particles), 0.0, 1e-14);
    }
}

// A stage that begins with the balance of its constant loads is not heated on the way to it.
TEST(Heat, BeginsAfterTheConstantLoads) {
  BondRecipe recipe = warm();
  recipe.rules.strength = linear_strength(1.0, 1.0, 1.0, 1.0);
  const Specimen s = warm_rod(4, recipe);
  const double c_A = stiffness_of(s.state.bonds[BondId{0}]).c_A, T = 0.1, F = 1e-3;
  StaticStage stage = heated(StageKind::fracture, s, T, {clamp(0)});
  stage.loads = {testing::pushed(3, {F, 0, 0})};
  stage.loads[0].constant = true;
  const State end = run_static_stage(s.model, stage, s.state, {}).state;
  EXPECT_EQ(end.temperature[last(s)], T);
  EXPECT_NEAR(end.r[last(s)].x, 3.0 * (1.0 + alpha * T + F / c_A), 1e-12);
}

// Changes at rest add up: what no stage takes alone, three do, and are refused before the first.
TEST(Heat, LeavesEveryBondALength) {
  const Specimen s = warm_rod(4, warm());
  const double half = -0.4 / alpha;
  const auto cooled = [&](int times) {
    std::vector<AnyStage> stages;
    for (int k = 0; k < times; ++k) stages.push_back(heated(StageKind::equilibrium, s, half, {clamp(0)}));
    return stages;
  };
  vbond::Run twice(s.model, s.state, cooled(2)), thrice(s.model, s.state, cooled(3));
  EXPECT_NO_THROW(twice.run());
  EXPECT_NEAR(twice.state().bonds[BondId{0}].a, 0.2, 1e-12);
  try {
    thrice.check();
    ADD_FAILURE() << "not refused";
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("no length left: temperature takes 1.2 of it"), std::string::npos)
        << e.what();
  }
  EXPECT_THROW(
      run_static_stage(s.model, heated(StageKind::equilibrium, s, half, {clamp(0)}), twice.state(), {}),
      NoEquilibrium);
  Stage stage = testing::plain_stage(0.01, 1.0);
  stage.heating = {{s.model.groups[0].particles, -1.1 / alpha, {{{0, 0}, {0.5, 1}}}}};
  EXPECT_THROW(Simulation(s.model, stage, s.state), std::invalid_argument);
  stage.heating[0].factor.points[1].t = 2.0;  // the stage ends before
  stage.heating[0].factor.points[1].factor = 1.5;
  EXPECT_NO_THROW(Simulation(s.model, stage, s.state));
}

// The coefficients stay, so that bonds that shrink to half resist shear more: the bound is that of the
// stage's worst temperature.
TEST(Heat, CountsForTheLargestStep) {
  BondRecipe recipe = warm();
  recipe.parameters = BondStiffness<double>{1e-3, 1.0, 0.5, 0.1};
  recipe.attachment = Attachment::given, recipe.R_i = 0.3, recipe.R_j = 0.1;
  const Specimen s = warm_rod(4, recipe);
  Stage stage = testing::plain_stage(0.01, 1.0);
  for (const double growth : {-0.5, 0.5}) {
    stage.heating = {{s.model.groups[0].particles, growth / alpha, {{{0, 0}, {0.5, 1}, {1, 0}}}}};
    Specimen then = s;
    then.state.temperature.assign(4, growth / alpha);
    take_lengths(then.state);
    const double least = std::min(step_bound(s.model, s.state).dt, step_bound(then.model, then.state).dt);
    if (growth < 0.0) {
      EXPECT_LT(least, 0.96 * step_bound(s.model, s.state).dt);
    }
    EXPECT_EQ(step_bound(s.model, s.state, stage).dt, least);
  }
}

// Heated at once far beyond the limit: the bond has flowed before it moves, and only N^2/2 is left to swing.
TEST(Heat, ThatComesAtOnceFlowsAtOnce) {
  BondRecipe recipe = warm();
  recipe.rules.yield.limit.axial = recipe.rules.yield.compression = 0.002;
  const Specimen s = warm_rod(2, recipe);
  const double c_A = stiffness_of(s.state.bonds[BondId{0}]).c_A, limit = 0.002, growth = 15 * alpha;
  Stage stage = testing::plain_stage(1e-3 / std::sqrt(c_A), 1e9);
  stage.heating = {{s.model.groups[0].particles, 15.0, {}}};
  Simulation run(s.model, stage, s.state);
  const double slip = growth - limit / c_A;
  EXPECT_NEAR(run.books().dissipated, limit * slip, 1e-3 * limit * slip);  // the bond is longer by the growth
  EXPECT_NEAR(run.energies().potential(), 0.5 * limit * limit / c_A, 1e-3 * limit * limit / c_A);
  for (int k = 0; k < 2000; ++k) run.step();
  EXPECT_LT(std::abs(run.balance_error()), 1e-5);
}
/// A bond of c_A = 50 between held particles that is to grow by 0.02.
struct HeldBond {
  double work, balance_error;
};
HeldBond grown_between_held_ends(const BondRules& rules, const TimeFunction& factor, double dt) {
  BondRecipe recipe = warm();
  recipe.parameters = BondStiffness<double>{50.0, 20.0, 5.0, 5.0};
  recipe.rules = rules;
  const Specimen s = warm_rod(2, recipe);
  Stage stage = testing::plain_stage(dt, 0.3);
  stage.supports = {testing::held({ParticleId{0}, ParticleId{1}}, testing::clamped)};
  stage.heating = {{s.model.groups[0].particles, 20.0, factor}};
  Simulation run(s.model, stage, s.state);
  run.run();
  return {run.books().work_supports, std::abs(run.balance_error())};
}

// dN/dt = 50 g' - 50 N with g' = 0.2 for 0.1: work of g'^2 (0.1 - (1 - e^-5)/50).
TEST(Heat, OfBondsThatCreepDoesTheExactWorkToSecondOrder) {
  BondRules rules;
  rules.creep = {1.0, 1};
  const double exact = 0.04 * (0.1 - (1 - std::exp(-5.0)) / 50.0);
  const auto off = [&](double dt) {
    const HeldBond b = grown_between_held_ends(rules, {{{0, 0}, {0.05, 0}, {0.15, 1}}}, dt);
    EXPECT_LT(b.balance_error, 2.0 * std::abs(b.work / exact - 1.0) + 1e-9);
    return std::abs(b.work / exact - 1.0);
  };
  const double coarse = off(0.005), fine = off(0.0025);
  EXPECT_LT(fine, 5e-3);
  EXPECT_GT(coarse / fine, 3.0);
}

// At a limit of 0.1 the work is 0.1 (0.02 - 0.001), in a jump within a stage as by a ramp.
TEST(Heat, OfBondsThatYieldDoesTheExactWorkInAJump) {
  BondRules rules;
  rules.yield.limit.axial = rules.yield.compression = 0.1;
  for (const double rise : {1e-6, 0.1}) {
    const HeldBond b = grown_between_held_ends(rules, {{{0, 0}, {0.05, 0}, {0.05 + rise, 1}}}, 0.005);
    EXPECT_NEAR(b.work, 0.0019, 1e-6) << rise;
    EXPECT_LT(b.balance_error, 1e-6) << rise;
  }
}

// TH1: ends' translations held; one particle may not turn about the axis, which nothing else would hold. The
// smallest eigenvalue vanishes between 1e-5 to either side of the exact growth; it is linear there but for
// the square of that.
TEST(Heat, BucklesAPinnedRodAtTheTemperatureOfTheReference) {
  const double exact = testing::material_case("TH1")["expected"]["alpha_dT_critical"];
  const Specimen s = warm_rod(10, warm());
  const std::vector<Support> pinned = {
      testing::fixed({ParticleId{0}}, {true, true, true, true, false, false}),
      testing::fixed({ParticleId{9}}, testing::translations)};
  const auto stiffness_at = [&](double growth) {
    StaticStage stage = heated(StageKind::equilibrium, s, growth / alpha, pinned);
    stage.at_saddle = AtSaddle::keep;
    return run_static_stage(s.model, stage, s.state, {}).result.smallest_eigenvalue.value();
  };
  const double below = exact * (1 - 1e-5), above = exact * (1 + 1e-5);
  const double k_below = stiffness_at(below), k_above = stiffness_at(above);
  EXPECT_GT(k_below, 0.0);
  EXPECT_LT(k_above, 0.0);
  EXPECT_NEAR((below + (above - below) * k_below / (k_below - k_above)) / exact, 1.0, 1e-9);
  // searches find it, too, though nothing moves on the way: the load factor alone goes on
  const StaticStage search = heated(StageKind::buckling, s, 1.0, pinned);
  const auto loads = run_static_stage(s.model, search, s.state, {}).result.critical_loads;
  ASSERT_FALSE(loads.empty());
  EXPECT_NEAR(loads[0].load_factor * alpha / exact, 1.0, 1e-9);
  StaticStage path = heated(StageKind::path, s, 1.0, pinned);
  path.path.above = 1.1 * exact / alpha;
  const StaticResult followed = run_static_stage(s.model, path, s.state, {}).result;
  ASSERT_FALSE(followed.special_points.empty());
  EXPECT_EQ(followed.special_points[0].kind, PointKind::bifurcation);
  EXPECT_NEAR(followed.special_points[0].load_factor * alpha / exact, 1.0, 1e-9);
}

/// The largest error of the energy balance of a rod that is heated and cooled while it swings.
double largest_imbalance(const BondRecipe& recipe, double dt, double strained_by = 0.0) {
  const Specimen made = warm_rod(8, recipe);
  Specimen s = made;
  testing::Dice dice(5);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = {dice(-.02, .02), dice(-.02, .02), dice(-.02, .02)};
    s.state.omega[p] = {dice(-.02, .02), dice(-.02, .02), dice(-.02, .02)};
  }
  Stage stage = testing::plain_stage(dt, 1e9);
  stage.heating = {{s.model.groups[0].particles, 30.0, {{{0, 0}, {8, 1}, {16, -0.5}, {24, 0.25}}}},
                   {{ParticleId{2}}, 20.0, {{{0, 0}, {24, 1}}}}};
  stage.supports = {testing::held({ParticleId{0}, ParticleId{7}}, testing::clamped)};
  if (strained_by != 0.0)  // some of it while lengths change
    stage.strain = {s.model.groups[0].particles, {1, 0, 0}, {3.5, 0, 0}, strained_by, 0.8};
  Simulation run(s.model, stage, s.state);
  double largest = 0.0;
  while (run.clock().time() < 24.0 - 0.5 * dt) {
    run.step();
    const EnergyBooks& b = run.books();
    largest =
        std::max(largest, std::abs(run.energies().total() + b.dissipated - b.at_start - b.work_supports));
  }
  return largest;
}

TEST(Heat, ClosesTheBooksInMotionToSecondOrder) {
  BondRules yielding;
  yielding.yield.limit = {0.02, 2e-3, 4e-4, 2e-4};
  yielding.yield.compression = 0.02;
  BondRules fene;
  fene.stretch.form = StretchForm::fene, fene.stretch.largest = 0.4;
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const BondRules& rules : {BondRules{}, yielding, fene}) {
      BondRecipe recipe = warm();
      recipe.law = law;
      recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
      recipe.rules = rules;
      recipe.attachment = Attachment::given, recipe.R_i = 0.1, recipe.R_j = 0.2;
      const double coarse = largest_imbalance(recipe, 0.04), fine = largest_imbalance(recipe, 0.02);
      EXPECT_LT(fine, 1e-6) << law->name;  // of some 1e-3 that heating stores
      EXPECT_GT(coarse / fine, 3.0) << law->name;
    }
}

// The strain is there at once, and what bonds grow by after it is booked with the places after it.
TEST(Heat, ClosesTheBooksWithImposedStrainToSecondOrder) {
  BondRecipe recipe = warm();
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  const double coarse = largest_imbalance(recipe, 0.04, 5e-4), fine = largest_imbalance(recipe, 0.02, 5e-4);
  EXPECT_LT(fine, 1e-6);  // of some 1e-3 that heating stores
  EXPECT_GT(coarse / fine, 3.0);
}

// The temperature of the start of a stage comes at once, with all its energy.
TEST(Heat, OfTheStartOfAStageIsWorkOfImposedStrain) {
  const Specimen s = warm_rod(4, warm());
  Stage stage = testing::plain_stage(0.05, 1e9);
  stage.heating = {{s.model.groups[0].particles, 10.0, {}}};
  Simulation run(s.model, stage, s.state);
  const double u = alpha * 10.0;
  EXPECT_NEAR(run.books().work_supports, 3 * 0.5 * u * u, 1e-16);
  EXPECT_NEAR(run.energies().total(), 3 * 0.5 * u * u, 1e-16);
  for (int k = 0; k < 200; ++k) run.step();
  EXPECT_LT(std::abs(run.balance_error()), 1e-3);
}

TEST(Heat, IsTheSameBitsAfterAnyResumption) {
  const Specimen s = warm_rod(8, warm());
  Stage stage = testing::plain_stage(0.05, 1e9);
  stage.heating = {{s.model.groups[0].particles, 30.0, {{{0, 0.2}, {3, 1}, {4, -1}}}}};
  const auto go_on = [&](State state, int steps) {
    Simulation run(s.model, stage, std::move(state));
    for (int k = 0; k < steps; ++k) run.step();
    return std::move(run).handover().state;
  };
  const State whole = go_on(s.state, 100);
  EXPECT_NE(whole.bonds[BondId{0}].a, s.state.bonds[BondId{0}].a);
  for (const int at : {1, 33, 90}) EXPECT_TRUE(go_on(go_on(s.state, at), 100 - at) == whole) << at;
}

// A bond that is held yields as it is heated, and pulls when it is cold again: in motion and at rest.
TEST(Heat, LeavesATensionWhereABondHasYielded) {
  BondRecipe recipe = warm();
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  recipe.rules.yield.limit.axial = recipe.rules.yield.compression = 0.01;
  const Specimen s = warm_rod(2, recipe);
  const double T = 15.0, left = alpha * T - 0.01;
  vbond::Run rest(s.model, s.state,
                  {heated(StageKind::equilibrium, s, T, {clamp(0), clamp(1)}),
                   heated(StageKind::equilibrium, s, -T, {clamp(0), clamp(1)})});
  rest.run();
  EXPECT_NEAR(mean_axial_force(rest.state(), s.model.groups[0].particles), left, 1e-14);
  Stage stage = testing::plain_stage(0.05, 20.0);
  stage.supports = {testing::held({ParticleId{0}, ParticleId{1}}, testing::clamped)};
  stage.heating = {{s.model.groups[0].particles, T, {{{0, 0}, {10, 1}, {20, 0}}}}};
  Simulation motion(s.model, stage, s.state);
  motion.run();
  EXPECT_NEAR(mean_axial_force(motion.part(), s.model.groups[0].particles), left, 1e-14);
  EXPECT_NEAR(losses_of(motion)[Loss::yield_axial], 0.01 * left, 1e-14);
}

// A rod that is held breaks as it is cooled, the weakest bond first; the books of fracture close.
TEST(Heat, BreaksAHeldRodThatIsCooled) {
  BondRecipe strong = warm();
  strong.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  strong.rules.strength = linear_strength(0.02, 1.0, 1.0, 1.0);
  Specimen s = warm_rod(5, strong);
  BondRecipe weak = strong;
  weak.rules.strength = linear_strength(0.015, 1.0, 1.0, 1.0);
  const Specimen w = warm_rod(5, weak);
  s.state.bonds[BondId{2}] = w.state.bonds[BondId{2}];
  StaticStage stage = heated(StageKind::fracture, s, -30.0, {clamp(0), clamp(4)});
  vbond::Run run(s.model, s.state, {stage});
  const StageResult result = run.run().front();
  const FractureResult& f = result.statics->fracture;
  ASSERT_EQ(f.breaks.size(), 1u);
  EXPECT_TRUE(run.state().bonds[BondId{2}].broken);
  EXPECT_NEAR(f.breaks[0].use.load_factor * 30.0 * alpha, 0.015, 1e-12);
  EXPECT_LT(std::abs(f.books.error()), 1e-9);
  EXPECT_GT(f.books.work, 0.0);
}

}  // namespace
}  // namespace vbond
