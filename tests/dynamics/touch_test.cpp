// Particles that touch with friction, damping and adhesion, in the step loop: two bodies against exact
// answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "spheres_and_walls.hpp"
#include "teams.hpp"
#include "vbond/dynamics/contacts.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond::touch_test {
namespace {

using testing::Specimen;

constexpr double pi = std::numbers::pi;

/// Spheres of this radius and mass at these places.
Specimen spheres(const std::vector<Vec3d>& r, double radius, double mass, const ContactModel& contact) {
  Specimen s{equal_particles(r, mass, 0.4 * mass * sq(radius), radius), {}};
  s.model.contact = contact;
  s.state = at_rest(s.model);
  return s;
}

constexpr ParticleId first{0}, second{1};

// X1: LAMMPS' regression test of two Hertz spheres, d = 0.02, density 2800, which meet at 20 m/s.
TEST(LammpsGranular, HertzTrajectory) {
  const double R = 0.01, m = 4.0 / 3.0 * pi * R * R * R * 2800.0;
  // K delta^1.5 with K = 3.33333e10 sqrt(R/2): 4/3 E* = 3.33333e10
  ContactModel contact{.law = ContactLaw::paper_hertz, .pairs = ContactPairs::all};
  contact.c_H = 3.33333e10 * std::sqrt(0.005);
  Specimen s = spheres({{-0.0101, 0, 0}, {0.0101, 0, 0}}, R, m, contact);
  s.state.v = {{10, 0, 0}, {-10, 0, 0}};
  Simulation run(s.model, testing::plain_stage(2e-8, 1.0), s.state);
  const struct {
    int step;
    double x, v;
  } recorded[] = {{500, -0.009999999999999726, 10.0},
                  {1508, -0.009862943621850457, 0.008877155328353505},
                  {2508, -0.009998205337556671, -9.999901542518785}};
  for (const auto& at : recorded) {
    while (run.clock().step < at.step) run.step();
    EXPECT_NEAR(run.state().r[first].x, at.x, 1e-13) << at.step;
    EXPECT_NEAR(run.state().v[first].x, at.v, 1e-8) << at.step;  // the mass is rounded in the test's input
  }
}

// X2: linear, e = 0.5 with attraction, density 2700; the force uses the half-step velocity, as here.
TEST(LammpsGranular, HookeTrajectory) {
  const double R = 0.0025, m = 4.0 / 3.0 * pi * R * R * R * 2700.0;
  ContactModel contact{.law = ContactLaw::linear, .pairs = ContactPairs::all};
  contact.k = 1e6, contact.attraction = true, contact.surface.restitution = 0.5;
  Specimen s = spheres({{-0.00255, 0, 0}, {0.00255, 0, 0}}, R, m, contact);
  s.state.v = {{2, 0, 0}, {-2, 0, 0}};
  Simulation run(s.model, testing::plain_stage(3e-8, 1.0), s.state);
  while (run.clock().step < 2068) run.step();
  EXPECT_NEAR(run.state().r[first].x, -0.002506804594433399, 1e-13);
  EXPECT_NEAR(run.state().v[first].x, -0.9993293792676254, 1e-9);
  while (run.clock().step < 2795) run.step();
  EXPECT_NEAR(run.state().r[first].x, -0.002528599968195357, 1e-13);
}

/// Steps until the two spheres part, the largest overlap and force on the way.
struct Impact {
  double deepest = 0, force = 0, duration = 0;
};
Impact collide(Simulation& run, double reach) {
  Impact impact;
  bool touched = false;
  for (int k = 0; k < 2'000'000; ++k) {
    run.step();
    const double overlap = reach - norm(run.state().r[second] - run.state().r[first]);
    if (overlap <= 0.0 && touched) break;
    if (overlap <= 0.0) continue;
    touched = true;
    impact.deepest = std::max(impact.deepest, overlap);
    impact.force = std::max(impact.force, norm(run.loads().F[first]));
    impact.duration += run.stage().dt;
  }
  return impact;
}

// C2, test 1 of Chung & Ooi 2011: identical elastic spheres, glass and limestone, 10 m/s each. The reference
// is Hertz's closed form; leap-frog with 800 steps per contact errs by less than 1e-5.
TEST(ChungOoi, Test1ElasticImpactOfTwoSpheres) {
  const struct {
    double E, nu, m, deepest, force, duration;
  } rows[] = {{4.8e10, 0.2, 0.0117286125734, 0.000274112702089, 10696.888984, 4.03394556884e-5},
              {2e10, 0.25, 0.010471975512, 0.000368304025553, 7108.2412799, 5.42010049349e-5}};
  for (const auto& row : rows) {
    ContactModel contact{.law = ContactLaw::hertz, .pairs = ContactPairs::all, .E = row.E, .nu = row.nu};
    contact.surface.friction = 0.35, contact.tangential = TangentialForm::mindlin;
    Specimen s = spheres({{-0.0101, 0, 0}, {0.0101, 0, 0}}, 0.01, row.m, contact);
    s.state.v = {{10, 0, 0}, {-10, 0, 0}};
    const double dt = row.duration / 800;
    Simulation run(s.model, testing::plain_stage(dt, 1.0), s.state);
    const Impact got = collide(run, 0.02);
    EXPECT_NEAR(got.deepest / row.deepest, 1.0, 1e-5);
    EXPECT_NEAR(got.force / row.force, 1.0, 2e-5);
    EXPECT_NEAR(got.duration / row.duration, 1.0, 2.0 / 800);
    EXPECT_LT(std::abs(run.balance_error()), 1e-5);
  }
}

// C2, test 7: two equal spheres with opposite spins about parallel axes have no slip where they meet.
TEST(ChungOoi, Test7OppositeSpinsChangeNothing) {
  ContactModel contact{.law = ContactLaw::hertz, .pairs = ContactPairs::all, .E = 7e10, .nu = 0.33};
  contact.surface = {.friction = 0.4, .restitution = 0.5};
  contact.tangential = TangentialForm::mindlin;
  Specimen s = spheres({{-0.11, 0, 0}, {0.11, 0, 0}}, 0.1, 11.3, contact);
  s.state.v = {{0.2, 0, 0}, {-0.2, 0, 0}};
  s.state.omega = {{0, 0, 3}, {0, 0, -3}};
  Simulation run(s.model, testing::plain_stage(1e-6, 1.0), s.state);
  collide(run, 0.2);
  EXPECT_NEAR(run.state().v[first].x, -0.1, 1e-4);
  EXPECT_NEAR(run.state().v[first].y, 0.0, 1e-13);
  EXPECT_NEAR(run.state().omega[first].z, 3.0, 1e-12);
}

// An oblique impact of two spheres: momentum and angular momentum stay to rounding, and the books close to
// second order.
TEST(Friction, KeepsMomentumAngularMomentumAndTheBooks) {
  const auto imbalance = [](double dt, double* twist) {
    ContactModel contact{.law = ContactLaw::hertz, .pairs = ContactPairs::all, .E = 10, .nu = 0.3};
    contact.tangential = TangentialForm::mindlin, contact.rolling = RollingForm::spring;
    contact.surface = {
        .friction = 0.3, .restitution = 0.6, .rolling_friction = 0.1, .twisting_friction = 0.1};
    Specimen s = spheres({{0, 0, 0}, {1.01, 0.3, 0.1}}, 0.5, 1.0, contact);
    s.model.radius[second] = 0.6, s.model.mass[second] = 1.7, s.model.inertia[second] = 0.3;
    s.state.v = {{0.2, 0, 0.05}, {-0.2, 0.02, 0}};
    s.state.omega = {{0.3, 0.1, -0.2}, {0.1, 0, 0.4}};
    Simulation run(s.model, testing::plain_stage(dt, 2.4), s.state);
    run.run();
    Vec3d P, L;
    for (const ParticleId p : s.state.r.ids()) {
      const double m = s.model.mass[p], I = s.model.inertia[p];
      P += m * (run.state().v[p] - s.state.v[p]);
      L += m * (cross(run.state().r[p], run.state().v[p]) - cross(s.state.r[p], s.state.v[p])) +
           I * (run.state().omega[p] - s.state.omega[p]);
    }
    EXPECT_LT(norm(P), 1e-13);
    EXPECT_LT(norm(L), 1e-12);
    EXPECT_GT(run.books().dissipated, 0.1 * run.books().at_start);
    *twist = norm(run.state().omega[first] - s.state.omega[first]);
    return run.balance_error();
  };
  double twist = 0.0;
  const double coarse = imbalance(4e-3, &twist), fine = imbalance(1e-3, &twist);
  EXPECT_GT(twist, 1e-2);
  EXPECT_LT(std::abs(fine), 1e-5);
  EXPECT_LT(std::abs(fine), 0.3 * std::abs(coarse));  // first order, by the turning of friction
}

// Three pairs of four spheres, so that lanes are left over, and a heap of 27: with every instruction set the
// same bits, and nothing in the numbers of a row that no particle has, which sums over rows take with them.
TEST(Friction, LoadsRowsAlikeWithEveryInstructionSet) {
  const std::vector<Vec3d> four{{0, 0, 0}, {0.9, 0.1, 0}, {0.4, 0.8, 0.3}, {0.4, 0.1, 5}};
  std::vector<Vec3d> heap;
  for (int k = 0; k < 27; ++k)
    heap.push_back({0.8 * (k % 3), 0.8 * (k / 3 % 3) + 0.1 * (k % 2), 0.8 * (k / 9)});
  for (const std::vector<Vec3d>& r : {four, heap})
    for (const RollingForm form : {RollingForm::none, RollingForm::constant, RollingForm::spring}) {
      ContactModel contact{.law = ContactLaw::linear, .pairs = ContactPairs::all};
      contact.k = 3.0, contact.k_t = 1.0, contact.tangential = TangentialForm::linear;
      contact.rolling = form, contact.rolling_stiffness = 1.0;
      contact.surface = {.friction = 0.6, .rolling_friction = 0.15, .twisting_friction = 0.15};
      const Specimen s = spheres(r, 0.5, 1.0, contact);
      const Order order = spatial_order(s.model.r_0);
      const BondIndex no_bonds(order, {});
      const Team team = testing::team_of(1, r.size());
      const auto loads_with = [&](const StepKernel& kernel) {
        Bodies bodies(s.model);
        testing::Dice dice(4);
        for (std::size_t k = 0; k < r.size(); ++k)
          bodies.motion[k].v = {dice(-1, 1), dice(-1, 1), dice(-1, 1)},
          bodies.motion[k].omega = {dice(-1, 1), dice(-1, 1), dice(-1, 1)};
        Contacts contacts(s.model, order, no_bonds, kernel);
        contacts.refresh(bodies.poses(), team);
        contacts.work_out({0, r.size()}, bodies, 0.01);
        contacts.add_loads({0, r.size()}, bodies.pose.data(), bodies.load.data());
        return std::vector<LoadRow>(bodies.load.begin(), bodies.load.end());
      };
      const std::vector<LoadRow> expected = loads_with(*available_kernels().front());
      for (const StepKernel* kernel : available_kernels()) {
        const std::vector<LoadRow> load = loads_with(*kernel);
        for (std::size_t k = 0; k < r.size(); ++k) {
          EXPECT_TRUE(load[k].F == expected[k].F && load[k].M == expected[k].M) << kernel->name << k;
          EXPECT_EQ(load[k].unused_1, 0.0) << kernel->name << k;
          EXPECT_EQ(load[k].unused_2, 0.0) << kernel->name << k;
        }
        EXPECT_GT(norm(load[0].M), 1e-3);
      }
    }
}

// Two spheres with JKR that are drawn apart part at the reach of adhesion, and what surfaces have gained is
// dissipated: the books close.
TEST(Adhesion, HoldsTwoSpheresUntilNoEquilibriumIsLeft) {
  ContactModel contact{.law = ContactLaw::hertz, .pairs = ContactPairs::all, .E = 1000, .nu = 0.3};
  contact.adhesion = AdhesionForm::jkr, contact.surface.work_of_adhesion = 0.2;
  Specimen s = spheres({{0, 0, 0}, {1.0001, 0, 0}}, 0.5, 1.0, contact);
  const double reach = reach_of_adhesion(effective_modulus(1000, 0.3), 0.2, 0.25);
  s.state.v = {{0, 0, 0}, {-0.05, 0, 0}};  // they meet,
  Stage stage = testing::plain_stage(2e-4, 100.0);
  Support slow = testing::held({second}, testing::translations, {0.01, 0, 0});
  Support rest = testing::held({first}, testing::clamped);
  slow.factor.points = {{0.0, -5.0}, {0.1, -5.0}, {0.1001, 1.0}};  // and are drawn apart
  stage.supports = {slow, rest};
  Simulation run(s.model, stage, s.state);
  double farthest = 0.0, most = 0.0;
  bool held = false;
  for (int k = 0; k < 100'000; ++k) {
    run.step();
    const double gap = run.state().r[second].x - run.state().r[first].x - 1.0;
    if (k * 2e-4 < 0.1) continue;
    const bool pulls = run.loads().F[first].x > 0.0;
    if (pulls) farthest = gap, most = std::max(most, run.loads().F[first].x), held = true;
    if (held && !pulls && gap > 0.0) break;
  }
  EXPECT_NEAR(most / (1.5 * pi * 0.2 * 0.25), 1.0, 1e-3);
  EXPECT_NEAR(farthest / reach, 1.0, 1e-3);  // a step is 2e-6, the reach 1e-2
  EXPECT_LT(std::abs(run.balance_error()), 1e-3);
}

// Two that overlap are drawn apart until their bond breaks, and overlap still: contact sets in with all of
// its energy, which is taken off what the bond releases, with adhesion as without it. The books close at
// every step, that of the break included.
TEST(Adhesion, SetsInWhereABondBreaks) {
  const auto released = [](AdhesionForm form, double work) {
    ContactModel contact{.law = ContactLaw::hertz, .pairs = ContactPairs::unbonded, .E = 1000, .nu = 0.3};
    contact.adhesion = form, contact.surface.work_of_adhesion = work;
    Specimen s = spheres({{0, 0, 0}, {0.98, 0, 0}}, 0.5, 1.0, contact);
    BondRecipe recipe;
    recipe.law = &bond_law<WithRules<VModel>::Law>;
    recipe.parameters = BondStiffness<double>{300.0, 100.0, 20.0, 20.0};
    recipe.rules.strength = linear_strength(3.0, 1e9, 1e9, 1e9);
    testing::bond(s, 0, 1, recipe);
    s.state.v = {{-0.5, 0, 0}, {0.5, 0, 0}};
    Simulation run(s.model, testing::plain_stage(1e-4, 1.0), s.state);
    for (int k = 0; k < 1000; ++k) {
      run.step();
      EXPECT_LT(std::abs(run.balance_error()), 1e-3) << k;
    }
    EXPECT_EQ(run.events().size(), 1u);
    return run.books().released;
  };
  const double without = released(AdhesionForm::none, 0.0);
  for (const AdhesionForm form : {AdhesionForm::dmt, AdhesionForm::jkr}) {
    EXPECT_NEAR(released(form, 1e-9), without, 1e-6);
    EXPECT_GT(released(form, 0.1), without + 1e-3);  // surfaces that stick store less
  }
}

// A damper of one coefficient on a linear spring: the restitution of the damped oscillator, which depends on
// the mass.
TEST(ContactDamping, ByCoefficientReboundsAsTheDampedOscillator) {
  constexpr double k = 100.0, c_n = 2.0;
  for (const double mass : {0.5, 1.0, 4.0}) {
    ContactModel contact = testing::linear(k, 0.0);
    contact.damping = c_n, contact.attraction = true;
    Specimen ball = testing::sphere({0, 0, 0.5}, 0.5, mass, contact, {testing::floor_at(0.0)});
    ball.state.v[ParticleId{0}] = {0, 0, -1};
    const double omega = std::sqrt(k / mass), zeta = c_n / (2.0 * std::sqrt(k * mass)), dt = 1e-3 / omega;
    Simulation run(ball.model, testing::plain_stage(dt, 1e9), ball.state);
    for (int n = 0; n < 5000; ++n) run.step();  // half a swing takes 3,141 or a few more
    const double e = std::exp(-pi * zeta / std::sqrt(1.0 - zeta * zeta));
    EXPECT_NEAR(run.state().v[ParticleId{0}].z, e, 2e-3);  // damping is of first order in omega dt = 1e-3
    EXPECT_LT(std::abs(run.balance_error()), 1e-3);
  }
}

}  // namespace
}  // namespace vbond::touch_test
