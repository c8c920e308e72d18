// Particles whose moments of inertia differ: free motion, loads, supports, books, what must not change.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "dynamics/tops.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond::tops_test {
namespace {

using testing::after;
using testing::angular_momentum_of_all;
using testing::apart;
using testing::Dice;
using testing::free_top;
using testing::plain_stage;
using testing::spin;

const ParticleId one{0};

testing::Specimen asymmetric_top() {
  return free_top({{1, 2, 3}, {}}, {}, {0.01, 1, 0.02});
}

// Whatever frame of the body its principal axes are told in.
TEST(Tops, MoveAlikeWhateverTheirBodyAxesAre) {
  Dice dice(5);
  const Quatd turn = rotation_of(dice.vector(2.0));
  const testing::Specimen plain = asymmetric_top();
  const testing::Specimen turned =
      free_top({plain.model.principal[one].moments, turn}, conjugate(turn), plain.state.omega[one]);
  const State a = after(plain, 0.01, 60.0), b = after(turned, 0.01, 60.0);
  EXPECT_LT(norm(a.omega[one] - b.omega[one]), 1e-10);
  EXPECT_LT(apart(a.q[one], b.q[one] * turn), 1e-10);
}

TEST(Tops, OfEqualMomentsAreSpheresToTheLastBit) {
  const testing::Specimen spheres = testing::straight_rod(8);
  testing::Specimen tops = spheres;
  for (const ParticleId p : tops.state.r.ids()) make_top(tops.model, p, {{0.064, 0.064, 0.064}, {}});
  testing::Specimen moved = spheres;
  for (testing::Specimen* s : {&tops, &moved})
    for (const ParticleId p : s->state.r.ids()) s->state.omega[p] = {0.01 * p.value, 0.02, -0.03};
  Stage stage = plain_stage(0.05, 10.0);
  stage.b_rotation = 1e-3;
  Simulation a(tops.model, stage, tops.state), b(moved.model, stage, moved.state);
  a.run(), b.run();
  EXPECT_EQ(a.state(), b.state());
}

// The splitting is not exact for equal moments, but of second order.
TEST(Tops, OfNearlyEqualMomentsMoveLikeSpheres) {
  testing::Specimen sphere = testing::particles_at({{0, 0, 0}}, 0.4, 1.0);
  sphere.state.omega[one] = {0.3, -0.7, 0.5};
  const testing::Specimen top = free_top({{1, 1, 1 + 1e-13}, {}}, {}, {0.3, -0.7, 0.5});
  const State exact = after(sphere, 0.01, 20.0);
  const double coarse = apart(exact.q[one], after(top, 0.01, 20.0).q[one]),
               fine = apart(exact.q[one], after(top, 0.005, 20.0).q[one]);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_NEAR(coarse / fine, 4.0, 0.1);
}

// 1e5 steps of rounding near 1e-16 of momenta near 1.
TEST(BondedTops, KeepMomentumAndAngularMomentum) {
  for (const BondLaw* law : bond_laws()) {
    const testing::Specimen s = testing::rod_of_tops(2, law, 7);
    const Vec3d before = angular_momentum_of_all(s.model, s.state);
    Simulation run(s.model, plain_stage(0.02, 1e9), s.state);
    for (int k = 0; k < 100000; ++k) run.step();
    EXPECT_LT(norm(angular_momentum_of_all(s.model, run.state()) - before), 1e-11 * norm(before));
    EXPECT_GT(norm(before), 1e-3);
  }
}

double largest_error(const testing::Specimen& s, Stage stage, double dt) {
  stage.dt = dt;
  Simulation run(s.model, stage, s.state);
  double largest = 0.0;
  while (run.clock().time() < 40.0) {
    run.step();
    largest = std::max(largest, std::abs(run.balance_error()));
  }
  return largest;
}

// Free; under moments that act on tops; damped by drag and by the bonds; held: at rest, turned at a rate that
// changes, about one axis.
TEST(BondedTops, CloseTheirBooksToSecondOrder) {
  testing::Specimen elastic = testing::rod_of_tops(7, &bond_law<VModel>, 9);
  testing::Specimen damped = elastic;
  BondRecipe recipe = testing::papers_bond();
  recipe.damping = {DampingBy::ratio, {0.05, 0.05, 0.05, 0.05}};
  damped.state.bonds = {};
  for (std::size_t k = 0; k + 1 < 7; ++k) testing::bond(damped, k, k + 1, recipe);
  const Stage plain = plain_stage(1.0, 1e9);
  Stage loaded = plain, drag = plain, held = plain, turned = plain, axis = plain, local = plain;
  loaded.loads.resize(1);
  loaded.loads[0].particles = {ParticleId{2}, ParticleId{5}};
  loaded.loads[0].moment = {1e-3, -2e-3, 5e-4};
  drag.b_translation = drag.b_rotation = 0.02;
  local.local_damping = 0.3;
  held.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  turned.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  turned.supports[0].angular_velocity = {0.02, -0.01, 0.03};
  turned.supports[0].factor.points = {{0, 0}, {10, 1}, {20, -1}, {60, 0.5}};
  axis.supports = {testing::held({ParticleId{0}, ParticleId{3}}, {true, true, true, true, false, true})};
  const auto expect_order = [](const char* what, const testing::Specimen& s, const Stage& stage,
                               double least) {
    const double coarse = largest_error(s, stage, 0.04), fine = largest_error(s, stage, 0.02);
    EXPECT_LT(fine, 0.02) << what;
    EXPECT_GT(coarse / fine, least) << what;
  };
  expect_order("free", elastic, plain, 3.6);
  expect_order("loaded", elastic, loaded, 3.6);
  expect_order("drag", elastic, drag, 3.6);
  expect_order("held", elastic, held, 3.6);
  expect_order("turned", elastic, turned, 3.6);
  expect_order("about an axis", elastic, axis, 3.6);
  expect_order("damped bonds", damped, plain, 3.0);
  expect_order("local damping", elastic, local, 3.0);
}

// Drag alone takes what the books say: nothing else changes the energy but the drift's own, of second order.
TEST(FreeTop, SlowsDownByDragAsEachPrincipalAxisDoes) {
  Stage stage = plain_stage(1e-3, 5.0);
  stage.b_rotation = 0.4;
  const Vec3d w{0, 0, 1.5};  // about a principal axis it stays there
  const testing::Specimen s = free_top({{1, 2, 2.5}, {}}, {}, w);
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_LT(norm(run.state().omega[one] - std::exp(-0.4 * 5.0 / 2.5) * w), 1e-12);
  EXPECT_NEAR(run.books().dissipated + run.energies().kinetic_rotation, 0.5 * 2.5 * sq(1.5), 1e-12);
}

// In the drift omega changes: work and what damping takes are those of both ends of it.
TEST(Tops, ThatSpinFastCloseTheirBooksToSecondOrder) {
  const auto error = [](const testing::Specimen& s, const Vec3d& moment, double dt) {
    Stage stage = plain_stage(dt, 8.0);
    stage.loads.resize(1);
    stage.loads[0].particles = {one};
    stage.loads[0].moment = moment;
    Simulation run(s.model, stage, s.state);
    run.run();
    EXPECT_GT(std::abs(run.books().work_loads) + run.books().dissipated, 0.01);
    return std::abs(run.balance_error());
  };
  const testing::Specimen loaded = free_top({{1, 2, 2.5}, {}}, {}, {0.5, 1, -0.7});
  EXPECT_NEAR(error(loaded, {0.3, -0.2, 0.5}, 0.02) / error(loaded, {0.3, -0.2, 0.5}, 0.01), 4.0, 0.2);

  testing::Specimen damped = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{5, 5, 5, 5};
  recipe.damping = {DampingBy::coefficients, {1, 1, 1, 1}};
  testing::bond(damped, 0, 1, recipe);
  make_top(damped.model, one, {{1, 2, 2.5}, rotation_of({0.3, 0.2, -0.9})});
  damped.state.omega = {{0.3, 1, -0.5}, {-0.2, 0.5, 0.3}};
  EXPECT_NEAR(error(damped, {}, 0.02) / error(damped, {}, 0.01), 4.0, 0.5);
}

// About an axis through the world a top turns with its moment about that axis, however it stands.
TEST(HeldTop, TurnsAboutOneAxisByItsMomentAboutIt) {
  const Vec3d moments{1, 2, 2.5};
  const Quatd q = rotation_of({0.4, -0.9, 0.3});
  testing::Specimen s = free_top({moments, rotation_of({1, 0.2, -0.5})}, q, {0.3, -0.2, 0.5});
  const Vec3d L = spin(s.model, s.state);
  const Quatd principal = testing::principal_axes(s.model, s.state, one);
  const Vec3d z{0, 0, 1}, in_body = rotate(conjugate(principal), z);
  const double I = moments.x * sq(in_body.x) + moments.y * sq(in_body.y) + moments.z * sq(in_body.z);
  const double before = kinetic_energy(s.model, s.state), M = 0.7, t = 3.0;
  Stage stage = plain_stage(0.01, t);
  stage.supports = {testing::held({one}, {false, false, false, true, true, false})};
  stage.loads.resize(1);
  stage.loads[0].particles = {one};
  stage.loads[0].moment = {5.0, -3.0, M};
  Simulation run(s.model, stage, s.state);
  run.run();
  const double w_0 = L.z / I, w = w_0 + M * t / I, angle = w_0 * t + 0.5 * M * t * t / I;
  EXPECT_LT(norm(run.state().omega[one] - w * z), 1e-12);
  EXPECT_LT(apart(run.state().q[one], rotation_of(angle * z) * q), 1e-12);
  EXPECT_NEAR(run.books().work_supports, 0.5 * I * sq(w_0) - before, 1e-12);  // as the axis takes hold
  EXPECT_NEAR(run.books().work_loads, M * angle, 1e-12);
  EXPECT_NEAR(run.energies().kinetic_rotation, 0.5 * I * sq(w), 1e-12);
}

// Turned at a constant rate it keeps its energy; what speeds it up is the support's work.
TEST(HeldTop, TurnsAsItsSupportsSay) {
  testing::Specimen s = free_top({{1, 2, 2.5}, rotation_of({1, 0.2, -0.5})}, {}, {});
  const Vec3d w{0.3, -0.6, 0.2};
  Stage stage = plain_stage(0.01, 4.0);
  stage.supports = {testing::held({one}, {false, false, false, true, true, true})};
  stage.supports[0].angular_velocity = w;
  stage.supports[0].factor.points = {{0, 0}, {1, 1}};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_LT(apart(run.state().q[one], rotation_of(3.5 * w)), 1e-12);
  const double E = run.energies().kinetic_rotation;
  EXPECT_NEAR(run.books().work_supports / E, 1.0, 1e-12);
  EXPECT_NEAR(E, rotation_energy({1, 2, 2.5}, run.state().q[one] * s.model.principal[one].axes, w), 1e-13);
}

// Two spheres with the inertia of other bodies hit each other off centre, with friction, resistance to
// rolling and restitution. Rates of contacts are those of the last half step: books are of first order.
TEST(TouchingTops, KeepMomentaAndCloseTheirBooks) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.9, 0.25, 0.1}}, 0.5);
  s.model.mass[ParticleId{1}] = 2.0;
  make_top(s.model, ParticleId{0}, {{0.06, 0.1, 0.12}, rotation_of({0.3, 0.2, -0.9})});
  make_top(s.model, ParticleId{1}, {{0.3, 0.15, 0.2}, rotation_of({-1.3, 0.4, 0.2})});
  ContactModel& c = s.model.contact;
  c.law = ContactLaw::linear, c.pairs = ContactPairs::all, c.k = 1e3, c.k_t = 500;
  c.tangential = TangentialForm::linear, c.rolling = RollingForm::spring;
  c.surface = {.friction = 0.4, .restitution = 0.7, .rolling_friction = 0.05, .twisting_friction = 0.03};
  s.state.r[ParticleId{1}] = {0.98, 0.25, 0.1};
  s.state.v = {{1, 0.1, 0}, {-0.5, 0, 0.2}};
  s.state.omega = {{1, -2, 3}, {0.5, 1, -2}};
  const auto momentum = [&](const State& state) {
    return s.model.mass[one] * state.v[one] + 2.0 * state.v[ParticleId{1}];
  };
  const auto error = [&](double dt) {
    Simulation run(s.model, plain_stage(dt, 0.4), s.state);
    run.run();
    EXPECT_LT(norm(momentum(run.state()) - momentum(s.state)), 1e-12);
    EXPECT_LT(norm(angular_momentum_of_all(s.model, run.state()) - angular_momentum_of_all(s.model, s.state)),
              1e-12);
    EXPECT_GT(norm(run.state().spin[one] - spin(s.model, s.state)), 0.01);
    EXPECT_GT(run.books().dissipated, 0.1);
    return std::abs(run.balance_error());
  };
  EXPECT_LT(error(2e-4), 1e-3);
  EXPECT_LT(error(2e-5), 1e-4);
}

Stage everything(const testing::Specimen& s) {
  Stage stage = plain_stage(0.05, 1e9);
  stage.b_rotation = 1e-3;
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped),
                    testing::held({ParticleId{2}}, {false, false, false, true, true, false})};
  stage.loads.resize(1);
  stage.loads[0].particles = s.model.groups[0].particles;
  stage.loads[0].moment = {1e-4, 2e-4, -1e-4};
  return stage;
}

testing::Specimen damped_tops(std::size_t N) {
  testing::Specimen s = testing::rod_of_tops(N, &bond_law<VModel>, 3);
  BondRecipe recipe = testing::papers_bond();
  recipe.damping = {DampingBy::ratio, {0.05, 0.05, 0.05, 0.05}};
  s.state.bonds = {};
  for (std::size_t k = 0; k + 1 < N; ++k) testing::bond(s, k, k + 1, recipe);
  return s;
}

TEST(Tops, ContinueFromTheirStateBitForBit) {
  for (const testing::Specimen& s : {testing::rod_of_tops(9, &bond_law<VModel>, 3), damped_tops(9)}) {
    const Stage stage = everything(s);
    Simulation whole(s.model, stage, s.state);
    for (int k = 0; k < 300; ++k) whole.step();
    for (const int cut : {1, 133, 299}) {
      Simulation first(s.model, stage, s.state);
      for (int k = 0; k < cut; ++k) first.step();
      Simulation second(s.model, stage, first.state());
      for (int k = cut; k < 300; ++k) second.step();
      EXPECT_EQ(second.state(), whole.state()) << cut;
    }
  }
}

TEST(Tops, MoveAlikeWithAnyNumberOfThreads) {
  const testing::Specimen s = damped_tops(4 * least_part);
  const Stage stage = everything(s);
  Simulation serial(s.model, stage, s.state, 1);
  for (int k = 0; k < 20; ++k) serial.step();
  for (const int threads : {2, 4}) {
    Simulation parallel(s.model, stage, s.state, threads);
    ASSERT_EQ(parallel.times().threads, threads);
    for (int k = 0; k < 20; ++k) parallel.step();
    EXPECT_EQ(parallel.state(), serial.state());
  }
}

TEST(Tops, AreGivenStepsByTheirLeastMoment) {
  testing::Specimen s = testing::straight_rod(4);
  const double spheres = step_bound(s.model, s.state).dt;
  for (const ParticleId p : s.state.r.ids()) make_top(s.model, p, {{0.5, 1e-4, 0.5}, {}});
  testing::Specimen least = testing::particles_at(s.model.r_0.values(), 0.4, 1e-4);
  least.state.bonds = s.state.bonds;
  EXPECT_EQ(step_bound(s.model, s.state).dt, step_bound(least.model, least.state).dt);
  EXPECT_LT(step_bound(s.model, s.state).dt, spheres);
}

// New velocities count, whatever L a state still has.
TEST(Tops, TurnAsTheirOmegaSaysWhereItWasChanged) {
  testing::Specimen s = asymmetric_top();
  s.state = after(s, 0.01, 1.0);
  EXPECT_EQ(s.state.spin[one], (Vec3d{0.01, 2, 0.06}));
  testing::Specimen fresh = s;
  s.state.clock = fresh.state.clock = {};
  s.state.omega[one] = fresh.state.omega[one] = {0.5, -0.3, 0.1};
  fresh.state.spin = {};
  EXPECT_EQ(after(s, 0.01, 1.0), after(fresh, 0.01, 1.0));
}

TEST(Tops, AreRefusedIfTheirInertiaIsThatOfNoMass) {
  const auto mistake = [](const PrincipalInertia& inertia) {
    const testing::Specimen s = free_top(inertia, {}, {});
    const auto found = mistakes_in(s.model);
    return found.empty() ? std::string{} : found.front();
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(mistake({{1, 2, 3}, {}}), "");  // a plate
  EXPECT_TRUE(has(mistake({{1, 2, 3.1}, {}}), "none above the sum of the other two"));
  EXPECT_TRUE(has(mistake({{0, 2, 2}, {}}), "> 0"));
  EXPECT_TRUE(has(mistake({{1, NAN, 2}, {}}), "> 0"));
  EXPECT_TRUE(has(mistake({{1, 2, 2}, {2, 0, 0, 0}}), "a unit quaternion"));
  testing::Specimen s = free_top({{1, 2, 2}, {}}, {}, {});
  s.model.inertia[one] = 1.5;
  EXPECT_TRUE(has(mistakes_in(s.model).front(), "make_top"));
}

TEST(Tops, AreNotHeldInPart) {
  const testing::Specimen s = free_top({{1, 2, 2}, {}}, {}, {});
  const auto mistakes = [&s](HeldDofs dofs, const Vec3d& rate) {
    Stage stage = plain_stage(0.1, 1.0);
    stage.supports = {testing::held({one}, dofs)};
    stage.supports[0].angular_velocity = rate;
    return mistakes_in(s.model, stage).size();
  };
  EXPECT_EQ(mistakes({true, true, true, false, false, false}, {}), 0u);
  EXPECT_EQ(mistakes({false, false, false, true, true, true}, {1, 2, 3}), 0u);
  EXPECT_EQ(mistakes({false, false, false, true, false, true}, {}), 0u);
  EXPECT_EQ(mistakes({false, false, false, true, false, true}, {0, 0, 1}), 1u);
  EXPECT_EQ(mistakes({false, false, false, false, true, false}, {}), 1u);
}

}  // namespace
}  // namespace vbond::tops_test
