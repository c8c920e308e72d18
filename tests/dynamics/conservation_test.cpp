#include <gtest/gtest.h>

#include <cmath>

#include "rods.hpp"

namespace vbond {
namespace {

struct Momenta {
  Vec3d linear, angular;
};
Momenta momenta(const Model& m, const State& s) {
  Momenta p;
  for (const ParticleId k : s.r.ids()) {
    p.linear += m.mass[k] * s.v[k];
    p.angular += m.mass[k] * cross(s.r[k], s.v[k]) + m.inertia[k] * s.omega[k];
  }
  return p;
}

testing::Specimen tumbling_rod(const BondLaw* law, unsigned seed) {
  BondRecipe recipe = testing::papers_bond(law);
  recipe.attachment = Attachment::given;
  recipe.R_i = 0.2;
  recipe.R_j = 0.3;
  testing::Specimen s = testing::straight_rod(10, recipe);
  testing::Dice dice(seed);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = {dice(-.01, .01), dice(-.01, .01), dice(-.01, .01)};
    s.state.omega[p] = {dice(-.05, .05), dice(-.05, .05), dice(-.05, .05)};
  }
  return s;
}

// Forces come in pairs and moments balance to rounding: 1e5 steps of errors near 1e-17 each, relative to
// momenta of 0.1 to 1, stay below 1e-11 even if they all point one way.
TEST(FreeBody, KeepsMomentumAndAngularMomentumOver100000Steps) {
  for (const BondLaw* law : bond_laws()) {
    const testing::Specimen s = tumbling_rod(law, 3);
    const Momenta before = momenta(s.model, s.state);
    Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
    for (int k = 0; k < 100000; ++k) run.step();
    const Momenta after = momenta(s.model, run.state());
    EXPECT_LT(norm(after.linear - before.linear), 1e-11 * norm(before.linear));
    EXPECT_LT(norm(after.angular - before.angular), 1e-11 * norm(before.angular));
    EXPECT_GT(norm(before.angular), 0.01);  // there was something to keep
  }
}

TEST(FreeBody, EnergyErrorFallsByFourWhenTheStepIsHalved) {
  const auto largest_error = [](double dt) {
    const testing::Specimen s = tumbling_rod(&bond_law<VModel>, 5);
    Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
    double largest = 0.0;
    while (run.state().clock.time() < 100.0) {
      run.step();
      largest = std::max(largest, std::abs(run.balance_error()));
    }
    return largest;
  };
  const double coarse = largest_error(0.04), fine = largest_error(0.02);
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);  // the next term is of order (omega dt)^2 = 0.6 % a halving; the
                                         // largest value is also sampled at other instants
}

// What a checkpoint relies on: the state alone continues a run bit for bit.
TEST(Simulation, ContinuesFromItsStateBitForBit) {
  testing::Specimen s = testing::straight_rod(8);
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0, 0};
  s.state.v[ParticleId{3}] = {0, 1e-3, 0};
  Stage stage = testing::plain_stage(0.1, 1e9);
  stage.supports = {testing::held({ParticleId{0}}, testing::translations, {1e-3, 0, 0}),
                    testing::held({ParticleId{7}}, testing::translations, {-1e-3, 0, 0})};
  stage.strain = StrainProgram{s.model.groups[0].particles, {1, 0, 0}, {3.5, 0, 0}, -1e-5, 1.0};
  stage.stops.peak =
      PeakStop{PeakQuantity::compressive_force, s.model.groups[0].particles, {1, 0, 0}, 0.5, 0.7};
  Simulation whole(s.model, stage, s.state);
  for (int k = 0; k < 400; ++k) whole.step();
  for (const int cut : {1, 133, 399}) {
    Simulation first(s.model, stage, s.state);
    for (int k = 0; k < cut; ++k) first.step();
    Simulation second(s.model, stage, first.state());
    for (int k = cut; k < 400; ++k) second.step();
    EXPECT_TRUE(second.state() == whole.state()) << "cut at step " << cut;
  }
}

}  // namespace
}  // namespace vbond
