// Bonds with a strength in the step loop: when, where and with what load they break.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "material_cases.hpp"
#include "rods.hpp"
#include "vbond/model/rules.hpp"

namespace vbond::weak_bond_test {
namespace {

using testing::Specimen;

/// c_A = 1, and a strength in tension alone.
BondRecipe bond_of_strength(double N_c) {
  BondRecipe recipe = testing::papers_bond();
  recipe.rules.strength = linear_strength(N_c, 1e9, 1e9, 1e9);
  return recipe;
}

/// WK1: a chain of 20, one end held, the other moved on at once; the weak bond is between particles 6 and 7.
struct WeakChain {
  double time, momentum;  // of the particles on the held side
  BondEvent event;
};
WeakChain break_chain(double dt) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < 20; ++k) r.push_back({static_cast<double>(k), 0, 0});
  Specimen s = testing::particles_at(r);
  for (std::size_t k = 0; k + 1 < 20; ++k)
    testing::bond(s, k, k + 1, bond_of_strength(k == 6 ? 1.2e-3 : 1e9));
  Stage stage = testing::plain_stage(dt, 100.0);
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped),
                    testing::held({ParticleId{19}}, testing::clamped, {1e-3, 0, 0})};
  stage.stops.breaks = BreakStop{1};
  Simulation run(s.model, stage, s.state);
  EXPECT_EQ(run.run(), StopReason::breaks);
  EXPECT_EQ(run.breaks(), 1);
  double momentum = 0.0;
  for (std::size_t k = 1; k <= 6; ++k) momentum += run.state().v[ParticleId{k}].x;
  return {run.clock().time(), momentum, run.events().at(0)};
}

// A bond breaks at the end of the step in which it reaches its strength: as much as a step too late. The
// chain itself is off by the phase of leap-frog, (omega dt)^2/24 of the time for its fastest wave, omega = 2.
TEST(WeakBond, BreaksWhenAndWhereTheReferenceSays) {
  const nlohmann::json exact = testing::material_case("WK1")["expected"];
  const double t = exact["t_break"];
  for (const double dt : {0.04, 0.02, 0.01, 0.005, 0.0005}) {
    const WeakChain broken = break_chain(dt);
    const double leap_frog = t * dt * dt / 6.0;
    EXPECT_GT(broken.time - t, -leap_frog) << dt;
    EXPECT_LT(broken.time - t, dt + leap_frog) << dt;
    EXPECT_EQ(broken.event.bond, BondId{6});
    EXPECT_EQ(broken.event.cause.mode, BreakMode::tension);
    // N grows by some 1.65e-4 in a time of one: of neighbours' velocities, 1.236e-3 - 1.072e-3
    EXPECT_NEAR(broken.event.loads.N, 1.2e-3, 2e-4 * dt);
    EXPECT_GE(broken.event.failure.utilisation, 1.0);
    EXPECT_NEAR(broken.event.energy, exact["energy_released"], 1.2e-3 * 2e-4 * dt);
    EXPECT_NEAR(broken.momentum, exact["momentum_left_part"], 2e-3 * dt);
    const double middle = 0.5 * (exact["positions"][6].get<double>() + exact["positions"][7].get<double>());
    EXPECT_NEAR(broken.event.middle.x, middle, 2e-3 * dt);
  }
}

// The held end of a single bond: after the break it feels nothing, before it the strength.
TEST(WeakBond, LoadBeforeItsBreakIsKnown) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  testing::bond(s, 0, 1, bond_of_strength(0.01));
  Stage stage = testing::plain_stage(0.01, 100.0);
  stage.supports = {testing::held({ParticleId{0}}, testing::translations),
                    testing::held({ParticleId{1}}, testing::translations, {1e-3, 0, 0})};
  stage.stops.breaks = BreakStop{1};
  Simulation run(s.model, stage, s.state);
  ASSERT_EQ(run.run(), StopReason::breaks);
  EXPECT_EQ(run.reaction({ParticleId{0}}).force.x, 0.0);
  const Reaction at_0 = run.reaction({ParticleId{0}}, LastBreaks::counted),
                 at_1 = run.reaction({ParticleId{1}}, LastBreaks::counted);
  EXPECT_NEAR(at_0.force.x, -0.01, 1e-3 * 0.01);  // passed by at most the way of one step
  EXPECT_EQ(at_1.force.x, -at_0.force.x);
  EXPECT_EQ(run.reaction({}, LastBreaks::counted).force.x, 0.0);
}

// The fall of a load is a peak of the reaction: the stop looks at block averages of it.
TEST(WeakBond, FallOfTheLoadEndsAStage) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  testing::bond(s, 0, 1, bond_of_strength(0.01));
  Stage stage = testing::plain_stage(0.01, 100.0);
  stage.supports = {testing::held({ParticleId{0}}, testing::translations),
                    testing::held({ParticleId{1}}, testing::translations, {1e-3, 0, 0})};
  stage.stops.peak = PeakStop{PeakQuantity::reaction, {ParticleId{1}}, {1, 0, 0}, 0.5, 0.1};
  Simulation run(s.model, stage, s.state);
  EXPECT_EQ(run.run(), StopReason::peak);
  EXPECT_NEAR(run.clock().time(), 10.0, 0.2);  // the block of the break, or that behind it
  EXPECT_NEAR(run.peak().peak, 0.01, 1e-3 * 0.2);
}

// Observers see the run in each step that bonds broke in, whenever they wanted to look.
TEST(WeakBond, IsShownToObserversInTheStepOfItsBreak) {
  struct Sleeper : Observer {
    std::vector<std::int64_t> steps;
    void observe(const Simulation& run) override {
      for (const BondEvent& e : run.events()) {
        EXPECT_EQ(e.step, run.clock().step);
        steps.push_back(e.step);
      }
    }
    std::int64_t steps_to_next_look(const Clock&) const override { return 1'000'000; }
  };
  Specimen s = testing::straight_rod(9, bond_of_strength(1e-3));
  for (const ParticleId p : s.state.r.ids()) s.state.v[p].x = 1e-3 * static_cast<double>(p.value * p.value);
  Simulation run(s.model, testing::plain_stage(0.05, 50.0), s.state);
  const auto sleeper = std::make_shared<Sleeper>();
  run.add_observer(sleeper);
  run.run();
  EXPECT_EQ(sleeper->steps.size(), static_cast<std::size_t>(run.breaks()));
  EXPECT_GE(run.breaks(), 5);
  EXPECT_GT(sleeper->steps.back(), sleeper->steps.front());
}

// Breaks are counted from the start of the stage, and the count goes through a resumption.
TEST(WeakBond, StopCountsTheBreaksOfTheStage) {
  Specimen s = testing::straight_rod(9, bond_of_strength(1e-3));
  for (const ParticleId p : s.state.r.ids()) s.state.v[p].x = 1e-3 * static_cast<double>(p.value * p.value);
  Stage stage = testing::plain_stage(0.05, 50.0);
  stage.stops.breaks = BreakStop{5};
  const auto broken = [](const State& state) {
    return std::count_if(state.bonds.begin(), state.bonds.end(), [](const Bond& b) { return b.broken; });
  };
  Simulation whole(s.model, stage, s.state);
  ASSERT_EQ(whole.run(), StopReason::breaks);
  EXPECT_GE(broken(whole.state()), 5);

  Simulation first(s.model, stage, s.state);
  while (broken(first.state()) < 1) first.step();
  State middle = std::move(first).handover().state;
  ASSERT_LT(broken(middle), 5);
  Simulation rest(s.model, stage, middle);
  EXPECT_EQ(rest.run(), StopReason::breaks);
  EXPECT_TRUE(rest.state() == whole.state());

  State next = whole.state();
  begin_next_stage(next.clock);
  stage.stops.breaks = BreakStop{1};
  Simulation second(s.model, stage, next);
  EXPECT_EQ(second.run(), StopReason::breaks);
  EXPECT_GE(broken(second.state()), broken(whole.state()) + 1);
}

}  // namespace
}  // namespace vbond::weak_bond_test
