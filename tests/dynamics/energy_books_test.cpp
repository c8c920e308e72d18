// The energy balance closes whatever acts on the body, and its error is of second order in the step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "rods.hpp"

namespace vbond {
namespace {

using Setting = std::function<void(testing::Specimen&, Stage&)>;

double largest_error(const Setting& setting, double dt, double duration) {
  testing::Specimen s = testing::straight_rod(10);
  Stage stage = testing::plain_stage(dt, duration);
  setting(s, stage);
  Simulation run(s.model, stage, s.state);
  double largest = 0.0;
  while (run.state().clock.time() < duration - 0.5 * dt) {
    run.step();
    // early on almost nothing has flowed and the relative error says little
    if (run.state().clock.time() > 0.2 * duration) largest = std::max(largest, std::abs(run.balance_error()));
  }
  EXPECT_GT(run.state().books.largest, 1e-12);
  return largest;
}

void expect_second_order(const Setting& setting, double duration) {
  const double coarse = largest_error(setting, 0.1, duration), fine = largest_error(setting, 0.05, duration);
  // (omega dt)^2 / 8 is leap-frog's error if all energy were in the fastest motion, omega = 2
  EXPECT_LT(coarse, 5e-3);
  // 4 up to the next term of the error, a few per cent at omega dt = 0.2, and the instants that are sampled
  EXPECT_NEAR(coarse / fine, 4.0, 0.5);
}

const std::vector<ParticleId> left{ParticleId{0}}, right{ParticleId{9}};

void kick_off(testing::Specimen& s) {
  testing::Dice dice(9);
  for (Vec3d& v : s.state.v) v = {dice(-.01, .01), dice(-.01, .01), dice(-.01, .01)};
}

TEST(EnergyBooks, CloseWithDamping) {
  expect_second_order(
      [](auto& s, Stage& stage) {
        kick_off(s);
        stage.b_translation = 0.02;
        stage.b_rotation = 0.002;
      },
      60.0);
}

TEST(EnergyBooks, CloseWithPrescribedVelocities) {
  expect_second_order(
      [](auto& s, Stage& stage) {
        kick_off(s);
        stage.b_translation = 0.01;
        stage.supports = {testing::held(left, testing::clamped, {0.002, 0.001, 0}),
                          testing::held(right, testing::translations, {-0.002, 0, 0})};
        stage.supports[0].angular_velocity = {0.01, 0, 0};
      },
      60.0);
}

TEST(EnergyBooks, CloseWithAccelerationThatIsPrescribed) {
  expect_second_order(
      [](auto& s, Stage& stage) {
        kick_off(s);
        stage.supports = {testing::held(left, testing::clamped, {0, 0.02, 0})};
        stage.supports[0].factor.points = {{0, 0}, {30, 1}};
      },
      60.0);
}

TEST(EnergyBooks, CloseWithForcesMomentsAndGravity) {
  expect_second_order(
      [](auto&, Stage& stage) {
        stage.supports = {testing::held(left, testing::clamped)};
        stage.gravity = {0, 0, -1e-5};
        PointLoad l;
        l.particles = right;
        l.force = {1e-4, 2e-4, 0};
        l.moment = {1e-5, 0, 2e-5};
        l.factor.points = {{0, 0.2}, {60, 1}};
        stage.loads = {l};
      },
      60.0);
}

TEST(EnergyBooks, CloseWithImposedStrain) {
  expect_second_order(
      [](auto& s, Stage& stage) {
        kick_off(s);
        stage.strain = StrainProgram{s.model.groups[0].particles, {1, 0, 0}, {4.5, 0, 0}, 1e-3, 10.0};
        stage.gravity = {1e-4, 0, 0};
      },
      60.0);
}

// Two heavy particles, drawn apart by 0.02 in jumps of any size: their bond yields at 0.1, after 0.002, and
// takes up 0.1 (0.02 - 0.001).
TEST(EnergyBooks, CloseWithImposedStrainOfBondsThatYield) {
  for (const int jumps : {1, 10, 100}) {
    testing::Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}}, 0.3);
    for (double& m : s.model.mass) m = 1e9;
    BondRecipe recipe;
    recipe.law = &bond_law<VModel>;
    recipe.parameters = BondStiffness<double>{50.0, 20.0, 5.0, 5.0};
    recipe.rules.yield.limit.axial = recipe.rules.yield.compression = 0.1;
    testing::bond(s, 0, 1, recipe);
    Stage stage = testing::plain_stage(0.01, 0.01 * jumps);
    const double increment = std::pow(1.02, 1.0 / jumps) - 1.0;
    stage.strain = StrainProgram{{ParticleId{0}, ParticleId{1}}, {1, 0, 0}, {0.5, 0, 0}, increment, 0.01};
    Simulation run(s.model, stage, s.state);
    run.run();
    EXPECT_NEAR(run.books().work_supports, 0.1 * 0.019, 1e-9) << jumps;
    EXPECT_LT(std::abs(run.balance_error()), 1e-6) << jumps;
  }
}

// The jumps have no velocity, along which contacts would slide or roll.
TEST(EnergyBooks, ImposedStrainIsRefusedWhereContactsSlide) {
  testing::Specimen s = testing::straight_rod(3);
  Stage stage = testing::plain_stage(0.01, 1.0);
  stage.strain = StrainProgram{s.model.groups[0].particles, {1, 0, 0}, {1, 0, 0}, 1e-3, 0.1};
  s.model.contact = {ContactLaw::hertz, ContactPairs::all, 1.0, 1.0, 5.0, 0.3};
  EXPECT_NO_THROW(Simulation(s.model, stage, s.state));
  s.model.contact.tangential = TangentialForm::mindlin;
  EXPECT_THROW(Simulation(s.model, stage, s.state), std::invalid_argument);
  s.model.contact.tangential = TangentialForm::none, s.model.contact.rolling = RollingForm::constant;
  EXPECT_THROW(Simulation(s.model, stage, s.state), std::invalid_argument);
}

TEST(EnergyBooks, CloseWithContacts) {
  expect_second_order(
      [](auto& s, Stage& stage) {
        kick_off(s);
        s.model.radius.assign(10, 0.52);
        s.model.contact = {ContactLaw::hertz, ContactPairs::all, 1.0, 1.0, 5.0, 0.3};
        stage.b_translation = 0.001;
      },
      60.0);
}

// A body at rest in any direction has nothing but rounding in its bonds: that must not look like an energy
// error, nor when loads come on slowly from nothing.
TEST(EnergyBooks, DoNotTakeRoundingForEnergy) {
  for (const double P : {0.0, 1e-9}) {
    std::vector<Vec3d> r;
    for (int k = 0; k < 40; ++k) r.push_back(k * normalised(Vec3d{1, -2, 0.5}));
    testing::Specimen s = testing::particles_at(r);
    for (std::size_t k = 0; k + 1 < 40; ++k)
      testing::bond(s, k, k + 1, testing::papers_bond(k % 2 ? &bond_law<Evm> : &bond_law<VModel>));
    Stage stage = testing::plain_stage(0.1, 1e9);
    stage.supports = {testing::held({ParticleId{0}}, testing::clamped)};
    PointLoad tip;
    tip.particles = {ParticleId{39}};
    tip.force = {P, 0, P};
    tip.factor.points = {{0, 0}, {1e5, 1}};
    stage.loads = {tip};
    Simulation run(s.model, stage, s.state);
    for (int k = 0; k < 2000; ++k) {
      run.step();
      // the floor of the scale is a thousand roundings, and an energy is a sum of a few of them for each bond
      ASSERT_LT(std::abs(run.balance_error()), 0.02) << "step " << k << ", P = " << P;
    }
  }
}

// A lone particle slows down as exp(-b t / m), and what it has lost stands in the books to rounding.
TEST(Damping, OfAFreeParticleIsExact) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}});
  s.state.v = {{1, 0, 0}};
  s.state.omega = {{0, 2, 0}};
  Stage stage = testing::plain_stage(0.5, 1e9);
  stage.b_translation = 0.3;
  stage.b_rotation = 0.02;
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < 20; ++k) run.step();
  const double v = std::exp(-0.3 * 10), omega = 2 * std::exp(-0.02 / 0.064 * 10);
  EXPECT_NEAR(run.state().v[ParticleId{0}].x / v, 1.0, 1e-14);
  EXPECT_NEAR(run.state().omega[ParticleId{0}].y / omega, 1.0, 1e-14);
  EXPECT_NEAR(run.state().books.dissipated, 0.5 * (1 - v * v) + 0.5 * 0.064 * (4 - omega * omega), 1e-14);
}

}  // namespace
}  // namespace vbond
