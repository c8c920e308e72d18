// What takes time or rubs in motion, at rest: creep stays as it is, contacts have no friction.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "dynamics/spheres_and_walls.hpp"
#include "vbond/model/energies.hpp"
#include "walks.hpp"

namespace vbond {
namespace {

using testing::Specimen;

/// A straight bar of N bonds one long, c_A = 1, that creep.
Specimen bar(std::size_t N, double rate, double yield = 0.0) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= N; ++k) r.push_back({static_cast<double>(k), 0, 0});
  Specimen s = testing::particles_at(r);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.1, 0.02, 0.02};
  recipe.rules.creep.rate = rate;
  if (yield > 0.0)
    recipe.rules.yield.limit.axial = recipe.rules.yield.compression = yield,
    recipe.rules.yield.isotropic.axial = 0.2;
  for (std::size_t k = 0; k < N; ++k) testing::bond(s, k, k + 1, recipe);
  return s;
}
StaticStage pulled(std::size_t N, double force, StageKind kind = StageKind::equilibrium) {
  return testing::static_stage(kind, {testing::fixed({ParticleId{0}}, testing::clamped)},
                               {testing::pushed(N, {force, 0, 0})});
}
double end(const State& s) {
  return s.r[ParticleId{s.r.size() - 1}].x;
}

// Loaded at rest, then left to creep: the elongation grows by N/eta, from N/c_A on. The balance afterwards
// keeps what has crept.
TEST(Frozen, LoadFirstAndCreepThen) {
  constexpr std::size_t N = 4;
  const double rate = 1e-3, force = 0.01, T = 200.0;
  Specimen s = bar(N, rate);
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text; };
  StaticOutcome loaded = run_static_stage(s.model, pulled(N, force), s.state, hooks);
  EXPECT_NE(told.find("4 bonds that creep keep the length"), std::string::npos) << told;
  EXPECT_NEAR(end(loaded.state), N + N * force, 1e-12);

  Stage creep = testing::plain_stage(0.05, T);
  creep.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  creep.loads = {{"load", {ParticleId{N}}, {force, 0, 0}, {}, {}}};
  loaded.state.books = opened_books(loaded.state, potential_energies(s.model, loaded.state).total());
  Simulation run(s.model, creep, loaded.state);
  run.run();
  const double crept = N * force * rate * T;
  EXPECT_NEAR(end(run.state()), N + N * force + crept, 0.01 * crept);  // inertia swings a little
  EXPECT_LT(std::abs(run.balance_error()), 1e-5);

  s.state = run.state();
  double kept = 0.0;
  for (const BondHistory& h : s.state.bond_history) kept += h[memory::crept];
  EXPECT_NEAR(kept, crept, 0.01 * crept);
  const testing::Walked off = testing::walk(s, pulled(N, 0.0)), on = testing::walk(s, pulled(N, 2 * force));
  EXPECT_NEAR(end(off.last()), N + kept, 1e-12);
  EXPECT_NEAR(end(on.last()), N + kept + 2 * N * force, 1e-12);
  EXPECT_EQ(on.last().bond_history, s.state.bond_history);
}

// Bonds that yield as well do what those do that do not creep.
TEST(Frozen, CreepDoesNotChangeYielding) {
  const Specimen creeping = bar(3, 5.0, 0.02), plastic = bar(3, 0.0, 0.02);
  StaticStage load = pulled(3, 0.05);
  load.steps = 5;
  const testing::Walked a = testing::walk(creeping, load), b = testing::walk(plastic, load);
  EXPECT_EQ(a.last().r, b.last().r);
  EXPECT_EQ(a.last().bond_history, b.last().bond_history);
  EXPECT_GT(end(a.last()), 3 + 3 * 0.05 + 0.1);  // 0.03 / 0.2 each of flow
}

// Paths, critical loads and modes too: those of a bar whose bonds are as long as they have crept to.
TEST(Frozen, CriticalLoadsAndModesAreThoseOfTheLengthCreptTo) {
  constexpr std::size_t N = 4;
  const double grown = 0.1;
  Specimen crept = bar(N, 1.0);
  crept.state.bond_history.assign(N, {});
  for (BondHistory& h : crept.state.bond_history) h[memory::crept] = grown;
  Specimen longer = bar(N, 0.0);
  for (Bond& b : longer.state.bonds) b.a += grown;
  for (Specimen* s : {&crept, &longer})
    for (const ParticleId p : s->state.r.ids())
      s->state.r[p].x = (1.0 + grown) * static_cast<double>(p.value);
  for (const StageKind kind : {StageKind::buckling, StageKind::path, StageKind::modes}) {
    StaticStage stage = pulled(N, -0.002, kind);  // Euler: pi^2 0.02 / 4 / 4.4^2 = 0.0025
    stage.path.above = 0.9;
    stage.count = 2;
    const StaticResult a = testing::walk(crept, stage).result, b = testing::walk(longer, stage).result;
    ASSERT_EQ(a.critical_loads.size(), b.critical_loads.size());
    ASSERT_EQ(a.modes.size(), b.modes.size());
    for (std::size_t k = 0; k < a.critical_loads.size(); ++k)
      EXPECT_NEAR(a.critical_loads[k].load_factor, b.critical_loads[k].load_factor, 1e-8);
    EXPECT_EQ(a.critical_loads.empty(), kind != StageKind::buckling);
    EXPECT_EQ(a.load_factor, b.load_factor);
    for (std::size_t k = 0; k < a.modes.size(); ++k) EXPECT_NEAR(a.modes[k].omega2, b.modes[k].omega2, 1e-12);
  }
}

// A ball that friction holds on a slope of walls comes to rest where it would without friction; the run goes
// on from there, and what friction remembered is gone.
TEST(Frozen, ContactsHaveNoFrictionAtRest) {
  const std::vector<Wall> walls{{"left", PlaneWall{{0, 0, 0}, {0.6, 0, 0.8}}, 0, {}},
                                {"right", PlaneWall{{0, 0, 0}, {-0.8, 0, 0.6}}, 0, {}},
                                {"back", PlaneWall{{0, 1, 0}, {0, -1, 0}}, 0, {}},
                                {"front", PlaneWall{{0, -1, 0}, {0, 1, 0}}, 0, {}}};
  Specimen s = testing::sphere({-0.2, 0, 1.45}, 1.0002, 1.0, testing::linear(1e3, 0.5), walls);
  Specimen smooth = s;
  smooth.model.contact.tangential = TangentialForm::none;
  Stage fall = testing::plain_stage(1e-3, 2.0);
  fall.gravity = {0, 0, -1};
  fall.b_translation = fall.b_rotation = 1.0;
  Simulation run(s.model, fall, s.state);
  run.run();
  s.state = run.state();
  ASSERT_FALSE(s.state.wall_history.empty());
  smooth.state = s.state;
  smooth.state.wall_history.clear();
  StaticStage rest = testing::static_stage(
      StageKind::equilibrium, {testing::fixed({ParticleId{0}}, {false, false, false, true, true, true})});
  rest.gravity = {0, 0, -1};
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text; };
  const StaticOutcome a = run_static_stage(s.model, rest, s.state, hooks),
                      b = run_static_stage(smooth.model, rest, smooth.state, {});
  EXPECT_NE(told.find("no friction"), std::string::npos) << told;
  EXPECT_LE(norm(a.state.r[ParticleId{0}] - b.state.r[ParticleId{0}]), 1e-9);
  EXPECT_TRUE(a.state.wall_history.empty());
  EXPECT_TRUE(a.state.contact_history.empty());
  Simulation on(s.model, fall, a.state);  // a later stage goes on, with friction
  on.run();
  EXPECT_LE(norm(on.state().r[ParticleId{0}] - a.state.r[ParticleId{0}]), 1e-6);
}

}  // namespace
}  // namespace vbond
