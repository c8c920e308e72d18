// Bonds that yield, creep and soften, in motion: books, momenta, the watch, and the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "material_cases.hpp"
#include "rods.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/physics/with_flow.hpp"

namespace vbond {
namespace {

using testing::material_case;
using testing::Specimen;

BondRecipe recipe_with(const BondRules& rules, const BondLaw* law = &bond_law<VModel>) {
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  recipe.rules = rules;
  return recipe;
}
/// Yields in all ways, with hardening of both kinds.
BondRules yielding() {
  BondRules rules;
  rules.yield.limit = {0.01, 1e-3, 2e-4, 1e-4};
  rules.yield.compression = 0.012;
  rules.yield.isotropic = {0.05, 1e-3, 1e-4, 1e-4};
  rules.yield.kinematic = {0.05, 0.0, 1e-4, 1e-4};
  return rules;
}
BondRules creeping() {
  BondRules rules;
  rules.creep = {50.0, 3};
  return rules;
}
BondRules softening(double force = 0.02, double length = 0.2) {
  BondRules rules;
  rules.softening = {force, length};
  return rules;
}

/// A chain of these bonds between attachments, moved and turning at random.
Specimen lively_chain(const BondRules& rules, const BondLaw* law, double speed) {
  BondRecipe recipe = recipe_with(rules, law);
  recipe.attachment = Attachment::given, recipe.R_i = 0.1, recipe.R_j = 0.2;
  return testing::lively_chain(recipe, speed);
}
std::size_t parted(const State& s) {
  return static_cast<std::size_t>(
      std::count_if(s.bonds.begin(), s.bonds.end(), [](const Bond& b) { return b.broken; }));
}

// ---- energy and momentum -------------------------------------------------------------------------------

/// The largest error of the energy balance in a run, and what was dissipated.
std::pair<double, double> largest_imbalance(const BondRules& rules, const BondLaw* law, double dt) {
  const Specimen s = lively_chain(rules, law, 0.05);
  Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
  double largest = 0.0;
  while (run.clock().time() < 30.0) {
    run.step();
    largest =
        std::max(largest, std::abs(run.energies().total() + run.books().dissipated - run.books().at_start));
  }
  EXPECT_EQ(parted(run.state()), 0u);
  return {largest, run.books().dissipated};
}

TEST(FlowInMotion, ClosesTheBooksToSecondOrder) {
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const BondRules& rules : {yielding(), creeping(), softening(0.02, 0.5)}) {
      const auto [coarse, lost] = largest_imbalance(rules, law, 0.04);
      const auto [fine, lost_too] = largest_imbalance(rules, law, 0.02);
      const double start = 8 * 0.05 * 0.05;
      EXPECT_GT(lost, 0.02 * start) << law->name;
      EXPECT_NEAR(lost, lost_too, 0.02 * lost) << law->name;
      EXPECT_LT(fine, 3e-4 * start) << law->name;
      EXPECT_GT(coarse / fine, 3.0) << law->name;
    }
}

TEST(FlowInMotion, KeepsMomentumAndAngularMomentum) {
  const Specimen s = lively_chain(yielding(), &bond_law<VModel>, 0.1);
  Simulation run(s.model, testing::plain_stage(0.05, 1e9), s.state);
  for (int k = 0; k < 1000; ++k) run.step();
  Vec3d P, L;
  for (const ParticleId p : s.state.r.ids()) {
    const State &a = s.state, &b = run.state();
    P += b.v[p] - a.v[p];
    L += cross(b.r[p], b.v[p]) - cross(a.r[p], a.v[p]) + 0.064 * (b.omega[p] - a.omega[p]);
  }
  // 1000 steps, r up to 10: some 1e4 roundings of 1e-16 of numbers of order one
  EXPECT_LT(norm(P), 1e-13);
  EXPECT_LT(norm(L), 1e-12);
  EXPECT_GT(run.books().dissipated, 0.0);
}

TEST(FlowInMotion, TakesNothingFromARigidMotion) {
  for (const BondRules& rules : {yielding(), creeping(), softening()}) {
    Specimen s = testing::straight_rod(8, recipe_with(rules));
    for (const ParticleId p : s.state.r.ids()) {
      s.state.v[p] = Vec3d{0.1, -0.2, 0.3} + cross({0, 0, 1e-3}, s.state.r[p]);
      s.state.omega[p] = {0, 0, 1e-3};
    }
    Simulation run(s.model, testing::plain_stage(0.05, 1e9), s.state);
    for (int k = 0; k < 400; ++k) run.step();
    // the turning pulls with some 8 (1e-3)^2 at most, far from any limit; creep takes 50 N^4 = 2e-19 per time
    EXPECT_LE(run.books().dissipated, rules == creeping() ? 1e-16 : 0.0);
    EXPECT_EQ(parted(run.state()), 0u);
  }
}

// ---- single bonds and bars -----------------------------------------------------------------------------

TEST(FlowInMotion, RelaxesByCreepAsTheReferenceSays) {
  const nlohmann::json c = material_case("CR1");
  const double N_0 = c["setup"]["N0"];
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const bool norton : {false, true}) {
      BondRules rules;
      rules.creep = {1.0 / c["setup"]["eta"].get<double>(), 1};
      if (norton) rules.creep = {c["setup"]["A"], c["setup"]["n"]};
      Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
      testing::bond(s, 0, 1, recipe_with(rules, law));
      s.state.r[ParticleId{1}].x += N_0;
      Stage stage = testing::plain_stage(0.05, 20.0);
      stage.supports = {testing::held({ParticleId{0}, ParticleId{1}}, testing::clamped)};
      Simulation run(s.model, stage, s.state);
      run.run();
      const double N = mean_axial_force(run.part(), s.model.groups[0].particles);
      EXPECT_NEAR(N, c["expected"][norton ? "norton" : "maxwell"][3], 1e-6);
      EXPECT_NEAR(run.books().dissipated, 0.5 * (N_0 * N_0 - N * N), 1e-16);
    }
}

// SO1 with four bonds, of which one is a little weaker: pulled slowly enough, one bond takes up the fracture
// energy, and the others spring back.
TEST(FlowInMotion, PartsABarWithItsFractureEnergy) {
  const nlohmann::json e = material_case("SO1")["expected"]["n4"];
  const double u_f = e["u_f"], N_c = 0.02 * 0.99, speed = 2e-5;
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  for (std::size_t k = 0; k < 4; ++k)
    testing::bond(s, k, k + 1, recipe_with(softening(k == 2 ? N_c : 0.02, u_f)));
  for (const ParticleId p : s.state.r.ids()) s.state.v[p].x = speed / 4.0 * static_cast<double>(p.value);
  Stage stage = testing::plain_stage(0.2, 0.21 / speed);
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped),
                    testing::held({ParticleId{4}}, testing::clamped, {speed, 0, 0})};
  stage.b_translation = 0.1;  // so slow that it takes 1e-4 of N_c
  Simulation run(s.model, stage, s.state);
  double largest = 0.0;
  std::vector<double> wrong;
  while (run.clock().time() < stage.stops.duration) {
    run.step();
    const double total = run.state().r[ParticleId{4}].x - 4.0;
    const double N = mean_axial_force(run.part(), s.model.groups[0].particles);
    largest = std::max(largest, N);
    // up: four bonds alike; down: three of them unload while one softens
    const double up = total / 4.0, down = (u_f - total) / (u_f - 4.0 * N_c) * N_c;
    if (total < u_f) wrong.push_back(std::abs(N - std::min(up, down)));
  }
  EXPECT_NEAR(largest, N_c, 0.005 * N_c);
  EXPECT_LT(*std::max_element(wrong.begin(), wrong.end()), 0.01 * N_c);
  ASSERT_EQ(parted(run.state()), 1u);
  EXPECT_TRUE(run.state().bonds[BondId{2}].broken);
  EXPECT_NEAR(run.state().bond_history[BondId{2}][memory::dissipated], 0.99 * e["energy_total"].get<double>(),
              1e-8);
  EXPECT_LT(std::abs(run.balance_error()), 1e-4);
}

// The memory of a bond whose loads could not be brought to their limits is not a number, and so are they.
TEST(FlowInMotion, StopsAndNamesTheBondWhoseFlowIsLost) {
  Specimen s = lively_chain(yielding(), &bond_law<VModel>, 0.05);
  s.state.bond_history.resize(s.state.bonds.size());
  s.state.bond_history[BondId{3}][memory::turn_i] = std::numeric_limits<double>::quiet_NaN();
  try {
    Simulation run(s.model, testing::plain_stage(0.1, 1e9), s.state);
    ADD_FAILURE() << "it runs";
  } catch (const Diverged& e) {
    EXPECT_NE(std::string(e.what()).find("bond 3 (particles 3, 4): its flow"), std::string::npos) << e.what();
  }
}

// PL2t: particles that turn against each other by more than a right angle, while their bond does not.
TEST(FlowInMotion, IsWatchedByItsElasticAngles) {
  const nlohmann::json row = material_case("PL2t")["expected"]["rows"][0];
  for (const bool yields : {true, false}) {
    BondRules rules;
    rules.yield.limit.torsion = yields ? 4e-4 : 1.0;
    Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
    testing::bond(s, 0, 1, recipe_with(rules));
    Stage stage = testing::plain_stage(0.01, 2.5);
    stage.supports = {testing::held({ParticleId{0}}, testing::clamped),
                      testing::held({ParticleId{1}}, testing::clamped)};
    stage.supports[1].angular_velocity = {1, 0, 0};
    Simulation run(s.model, stage, s.state);
    run.run();
    EXPECT_EQ(run.survey().deformed.empty(), yields);
    const BondShape shape = bond_shape(run.state(), BondId{0});
    EXPECT_EQ(bond_range(run.state().bonds[BondId{0}], shape), yields ? BondRange::good : BondRange::snapped);
    if (yields) {
      EXPECT_NEAR(run.books().dissipated, row["dissipated"], 1e-6);
      EXPECT_NEAR(shape.twist, 2.5 - row["plastic_angle"].get<double>(), 1e-6);
    }
  }
}

/// Two particles one apart, with a bond that is booked as one of a run is.
Specimen prestrained(const BondRules& rules, double prestrain, const BondLaw* law) {
  BondRecipe recipe = recipe_with(rules, law);
  recipe.prestrain = prestrain;
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  const BondSite i = bond_site(s.model, s.state, ParticleId{0}),
                 j = bond_site(s.model, s.state, ParticleId{1});
  add_bond(s.model, make_bond(recipe, i, j).value(), recipe, s.state);
  return s;
}

// A prestrain beyond the limit has flowed before the run: the bond begins at its limit, N(1 + h) = c u - ...,
// and moves on from there without a jump in the books.
TEST(FlowInMotion, BeginsAtTheLimitThatAPrestrainIsBeyond) {
  BondRules plastic;
  plastic.yield.limit.axial = plastic.yield.compression = 0.05;
  plastic.yield.isotropic.axial = 0.25;
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const double prestrain : {-0.1, -0.07, -0.05, 0.03, 0.08}) {
      Specimen s = prestrained(plastic, prestrain, law);
      const double u = prestrain / (1.0 + prestrain);  // D - a of D = 1, with c_A = 1
      const double flowed = std::max(0.0, (std::abs(u) - 0.05) / 1.25);
      const double N = std::copysign(std::abs(u) - flowed, u), lost = (0.05 + 0.125 * flowed) * flowed;
      EXPECT_NEAR(s.state.books.dissipated, lost, 1e-15) << prestrain;
      EXPECT_NEAR(s.state.books.work_supports, 0.5 * N * N + lost, 1e-15) << prestrain;
      Simulation run(s.model, testing::plain_stage(0.05, 1e9), s.state);
      EXPECT_NEAR(mean_axial_force(run.part(), s.model.groups[0].particles), N, 1e-14) << prestrain;
      EXPECT_NEAR(run.energies().total(), 0.5 * N * N, 1e-15) << prestrain;
      for (int k = 0; k < 1000; ++k) {
        run.step();
        ASSERT_LT(std::abs(run.balance_error()), 3e-3) << prestrain << " at step " << k;
      }
      EXPECT_GT(run.energies().kinetic() + run.energies().potential(), 0.9 * 0.5 * N * N);
    }
}

// The same of bonds made on the way, after others that remember nothing yet, and of damage.
TEST(FlowInMotion, BeginsAtTheLimitWhenABondIsMadeOnTheWay) {
  for (const BondRules& rules : {yielding(), softening(0.02, 0.2)}) {
    Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
    testing::bond(s, 0, 1, testing::papers_bond());
    BondRecipe recipe = recipe_with(rules);
    recipe.prestrain = 0.05;
    Stage stage = testing::plain_stage(0.05, 1e9);
    stage.bonding = {{"glue", {1, 1, 1}, {1, 1, 1}, 1.5, recipe}};
    Simulation run(s.model, stage, s.state);
    for (int k = 0; k < 400; ++k) {
      run.step();
      ASSERT_LT(std::abs(run.balance_error()), 3e-3) << k;
    }
    ASSERT_EQ(run.state().bonds.size(), 2u);
    EXPECT_GT(run.books().dissipated, 1e-4);
    EXPECT_EQ(run.state().bond_history.size(), 2u);
  }
}

// ---- the same bits --------------------------------------------------------------------------------------

// 10,000 particles: parts for three threads. Also across an end and a resumption at any step, with another
// number of threads.
TEST(FlowInMotion, GivesTheSameBitsWithAnyThreadsAndAfterAnyResumption) {
  constexpr std::size_t side = 100;
  std::vector<Vec3d> r;
  for (std::size_t x = 0; x < side; ++x)
    for (std::size_t y = 0; y < side; ++y) r.push_back({static_cast<double>(x), static_cast<double>(y), 0});
  Specimen s = testing::particles_at(r);
  BondRules damped = yielding();
  damped.strength = linear_strength(0.1, 0.02, 0.004, 0.002);
  const std::vector<BondRecipe> kinds{recipe_with(damped), recipe_with(creeping(), &bond_law<Evm>),
                                      recipe_with(softening(0.02, 0.08)), testing::papers_bond()};
  std::size_t kind = 0;
  for (std::size_t k = 0; k < side * side; ++k) {
    if (k % side + 1 < side) testing::bond(s, k, k + 1, kinds[kind++ % kinds.size()]);
    if (k + side < side * side) testing::bond(s, k, k + side, kinds[kind++ % kinds.size()]);
  }
  testing::Dice dice(7);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = {dice(-0.1, 0.1), dice(-0.1, 0.1), dice(-0.1, 0.1)};
    s.state.omega[p] = {dice(-0.1, 0.1), dice(-0.1, 0.1), dice(-0.1, 0.1)};
  }
  const auto run_on = [&](State state, int threads, int steps) {
    Simulation run(s.model, testing::plain_stage(0.2, 1e9), std::move(state), threads);
    EXPECT_EQ(run.times().threads > 1, threads > 1);
    for (int k = 0; k < steps; ++k) run.step();
    return std::move(run).handover().state;
  };
  const State whole = run_on(s.state, 1, 50);
  EXPECT_GT(parted(whole), 60u);
  EXPECT_GT(whole.books.dissipated, 0.0);
  EXPECT_TRUE(run_on(s.state, 2, 50) == whole);
  EXPECT_TRUE(run_on(s.state, 4, 50) == whole);
  for (const int at : {1, 17, 42}) {
    const State middle = run_on(s.state, 2, at);
    EXPECT_TRUE(run_on(middle, 3, 50 - at) == whole) << "resumed at step " << at;
  }
}

}  // namespace
}  // namespace vbond
