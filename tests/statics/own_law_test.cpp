// Statics with laws that are not the library's: they know a law by what it says of itself.
#include <gtest/gtest.h>

#include <string>

#include "bodies.hpp"
#include "hardening_law.hpp"
#include "inelastic_laws.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/law_with_loops.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

using testing::Specimen;

BondRecipe papers_bond_with(const BondLaw& law, const Coefficients& given) {
  BondRecipe recipe = testing::papers_bond(&law);
  recipe.given = given;
  return recipe;
}
const Coefficients damping{0, 0, 0, 0, 0.2, 0.02, 0.01, 0.001};

/// A rod between pins, pressed along its axis.
StaticStage pressed(StageKind kind, std::size_t N) {
  StaticStage stage = testing::static_stage(kind, {}, {testing::pushed(N - 1, {-1e-4, 0, 0})});
  for (std::size_t k = 0; k < N; ++k) {
    const bool first = k == 0, last = k + 1 == N;
    stage.supports.push_back(
        testing::fixed({ParticleId{k}}, {first, first || last, true, true, true, false}));
  }
  return stage;
}

// At rest a law that damps is its elastic part: the same balance, critical load and modes as the V-model.
TEST(OwnLawAtRest, IsItsElasticPart) {
  const Specimen own = testing::straight_rod(10, papers_bond_with(testing::damped_law, damping));
  const Specimen v_model = testing::straight_rod(10);
  const auto both = [&](StageKind kind) {
    StaticStage stage = pressed(kind, 10);
    stage.count = 3;
    return std::pair{run_static_stage(own.model, stage, own.state, {}),
                     run_static_stage(v_model.model, stage, v_model.state, {})};
  };
  const auto [balance, balance_v] = both(StageKind::equilibrium);
  for (const ParticleId p : own.state.r.ids()) EXPECT_EQ(balance.state.r[p], balance_v.state.r[p]);
  EXPECT_LT(balance.state.r[ParticleId{9}].x, 9.0 - 8e-4);
  const auto [buckled, buckled_v] = both(StageKind::buckling);
  ASSERT_EQ(buckled.result.critical_loads.size(), buckled_v.result.critical_loads.size());
  ASSERT_FALSE(buckled.result.critical_loads.empty());
  EXPECT_EQ(buckled.result.critical_loads[0].force, buckled_v.result.critical_loads[0].force);
  const auto [modes, modes_v] = both(StageKind::modes);
  ASSERT_EQ(modes.result.modes.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(modes.result.modes[k].omega, modes_v.result.modes[k].omega);
}

TEST(OwnLawAtRest, IsRefusedByNameIfItRemembers) {
  const Specimen rod = testing::straight_rod(5, papers_bond_with(testing::brittle_law, {}));
  for (const StageKind kind : {StageKind::equilibrium, StageKind::buckling, StageKind::modes}) try {
      run_static_stage(rod.model, pressed(kind, 5), rod.state, {});
      ADD_FAILURE() << "was not refused";
    } catch (const NoEquilibrium& e) {
      EXPECT_NE(std::string(e.what()).find("law \"brittle\", which remembers its past"), std::string::npos)
          << e.what();
    }
}

// Broken bonds are no part of the body: pulled at its end, what is left of the rod stretches by itself.
TEST(OwnLawAtRest, LeavesBrokenBondsOut) {
  Specimen rod = testing::straight_rod(6, papers_bond_with(testing::damped_law, damping));
  rod.state.bonds[BondId{4}].broken = true;
  StaticStage stage = testing::static_stage(
      StageKind::equilibrium, {testing::fixed({ParticleId{0}, ParticleId{5}}, testing::clamped)},
      {testing::pushed(4, {1e-3, 0, 0})});
  const StaticOutcome balance = run_static_stage(rod.model, stage, rod.state, {});
  EXPECT_NEAR(balance.state.r[ParticleId{4}].x, 4.0 + 4e-3, 1e-12);
  stage.supports[0].particles.pop_back();  // now particle 5 is free, and on its own
  EXPECT_THROW(run_static_stage(rod.model, stage, rod.state, {}), NoEquilibrium);
}

// The exact step of a damped body is not above the bound that knows of damping.
TEST(OwnLawAtRest, HasAnExactStepThatIsStableWithItsDamping) {
  const Specimen rod = testing::straight_rod(10, papers_bond_with(testing::damped_law, damping));
  const double bound = step_bound(rod.model, rod.state).dt;
  EXPECT_EQ(exact_critical_step(rod.model, rod.state, {}), bound);
  EXPECT_LT(bound, 0.9);
}

// ---- an elastic law with rules ------------------------------------------------------------------------

const BondLaw own_hardening = law_with_loops<testing::Hardening>();

/// A bar of such bonds, pulled at its end.
Specimen bar(const BondRules& rules, const BondLaw& law, double per_s2, std::size_t particles = 5) {
  BondRecipe recipe = papers_bond_with(law, {0, 0, 0, 0, per_s2});
  recipe.rules = rules;
  return testing::straight_rod(particles, recipe);
}
StaticStage pulled(StageKind kind, double force) {
  return testing::static_stage(kind, {testing::fixed({ParticleId{0}}, testing::clamped)},
                               {testing::pushed(4, {force, 0, 0})});
}

// Each bond stretches by u = 0.06 at the force N = u (1 + 100 u^2),
// and flows by (N - 0.05)/0.25 besides.
TEST(OwnLawWithRules, YieldsAtRest) {
  BondRules rules;
  rules.yield.limit.axial = rules.yield.compression = 0.05;
  rules.yield.isotropic.axial = 0.25;
  constexpr double u = 0.06, N = u * (1.0 + 100.0 * u * u);
  const Specimen s = bar(rules, own_hardening, 100.0);
  const StaticOutcome balance = run_static_stage(s.model, pulled(StageKind::equilibrium, N), s.state, {});
  EXPECT_NEAR(balance.state.r[ParticleId{4}].x, 4.0 * (1.0 + u + (N - 0.05) / 0.25), 1e-10);
}

// Without hardening it is the EVM, in balance, in fracture, by yielding and by softening.
TEST(OwnLawWithRules, IsThatOfTheLibraryAtRest) {
  BondRules yields, breaks, softens;
  yields.yield.limit = {0.05, 1e-3, 1e-3, 1e-3};
  yields.yield.compression = 0.05;
  yields.yield.isotropic = {0.25, 0.1, 0.1, 0.1};
  breaks.strength = linear_strength(0.1, 0.01, 0.01, 0.01);
  softens.softening = {0.05, 0.6};
  for (const BondRules& rules : {yields, breaks, softens}) {
    const bool in_steps = rules.yield != Yield{};
    StaticStage stage =
        pulled(in_steps ? StageKind::equilibrium : StageKind::fracture, in_steps ? 0.07 : 0.0);
    const std::size_t n =
        rules.softening.any() ? 2 : 5;  // as soon as they soften, bonds in line lose stability
    if (!in_steps) {
      stage.loads.clear();
      stage.supports.push_back(testing::fixed({ParticleId{n - 1}}, testing::clamped, {0.7, 0, 0}));
    }
    const Specimen own = bar(rules, own_hardening, 0.0, n), evm = bar(rules, bond_law<Evm>, 0.0, n);
    const StaticOutcome a = run_static_stage(own.model, stage, own.state, {}),
                        b = run_static_stage(evm.model, stage, evm.state, {});
    // flow is worked out otherwise where a tension may be no straight line: to 1e-12 of its load in each
    // increment
    const double far = rules.flow() ? 1e-9 : 0.0;
    for (const ParticleId p : own.state.r.ids()) EXPECT_LE(norm(a.state.r[p] - b.state.r[p]), far);
    EXPECT_EQ(a.result.fracture.breaks.size(), b.result.fracture.breaks.size());
    EXPECT_EQ(a.result.fracture.breaks.empty(), in_steps);
    EXPECT_EQ(dissipated_by_flow(a.state) > 0.0, rules.flow());
    EXPECT_NEAR(dissipated_by_flow(a.state), dissipated_by_flow(b.state), 1e-3 * far);
  }
}

}  // namespace
}  // namespace vbond
