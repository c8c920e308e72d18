// Restitution where contacts meet more than single free particles: clumps, and what supports hold.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "clouds.hpp"
#include "fibres.hpp"
#include "spheres_and_walls.hpp"
#include "vbond/model/contact_bound.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond::contact_masses_test {
namespace {

using testing::grip;
using testing::held;
using testing::Specimen;

constexpr double e = 0.5, v_0 = 0.1, mass = 1.5;
constexpr HeldDofs nothing{};

/// Each form of normal force, without and with attraction.
std::vector<ContactModel> forms() {
  ContactModel linear = testing::linear(1e4, 0.0, e), hertz = testing::hertz(1e5);
  hertz.pairs = ContactPairs::all, hertz.surface.restitution = e;
  ContactModel pulling = linear;
  pulling.attraction = true;
  return {linear, pulling, hertz};
}

/// Balls of radius 0.5 one above the other, each touching the next but for a gap above the first `below`.
Specimen column(std::size_t below, std::size_t above, const ContactModel& contact) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < below + above; ++k)
    r.push_back({0, 0, static_cast<double>(k) + (k < below ? 0.0 : 0.01)});
  Specimen s{equal_particles(r, mass, 0.15, 0.5), {}};
  s.model.contact = contact;
  s.model.contact.pairs = ContactPairs::all;
  s.state = at_rest(s.model);
  for (std::size_t k = below; k < below + above; ++k) s.state.v[ParticleId{k}] = {0, 0, -v_0};
  return s;
}
std::vector<ParticleId> numbers(std::size_t first, std::size_t last) {
  std::vector<ParticleId> all;
  for (std::size_t k = first; k < last; ++k) all.push_back(ParticleId{k});
  return all;
}

/// The speed at which the upper ones part from the lower ones over that at which they met; or from a wall.
double rebound(const Specimen& s, const std::vector<Support>& supports, ParticleId lower, ParticleId upper) {
  Stage stage = testing::plain_stage(2e-5, 0.5);
  stage.supports = supports;
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_LT(std::abs(run.balance_error()), 1e-3);
  const Vec3d v = run.state().v[upper] - (lower == upper ? Vec3d{} : run.state().v[lower]);
  return v.z / v_0;
}
// Damping is of first order in the step, which is 2.4e-3 of sqrt(m*/k) or less.
constexpr double tolerance = 2e-3;

TEST(ContactMasses, ClumpLeavesAWallAsRestitutionSays) {
  for (const ContactModel& contact : forms())
    for (const std::size_t n : {1, 2, 5, 10}) {
      Specimen s = column(0, n, contact);
      s.model.walls = {testing::floor_at(-0.5)};
      EXPECT_NEAR(rebound(s, {grip(numbers(0, n), nothing)}, ParticleId{0}, ParticleId{0}), e, tolerance)
          << static_cast<int>(contact.law) << ", " << n << " particles";
    }
}

TEST(ContactMasses, ClumpLeavesAParticleAndAClumpAsRestitutionSays) {
  for (const ContactModel& contact : forms())
    for (const std::size_t below : {1, 3}) {
      const Specimen s = column(below, 4, contact);
      std::vector<Support> supports = {grip(numbers(below, below + 4), nothing)};
      if (below > 1) supports.push_back(grip(numbers(0, below), nothing));
      EXPECT_NEAR(rebound(s, supports, ParticleId{0}, ParticleId{below}), e, tolerance)
          << static_cast<int>(contact.law) << ", on " << below;
    }
}

// However a particle is held: by one support, by two that hold different directions, or by its grip.
TEST(ContactMasses, WhatSupportsHoldIsLeftAsAWallIs) {
  Support slanted = held({ParticleId{0}}, {true, false, true, false, false, false});
  slanted.axes = HeldAxes{Triad{Vec3d{0.6, 0, 0.8}, Vec3d{0, 1, 0}, Vec3d{-0.8, 0, 0.6}}, world_axes};
  const std::vector<std::vector<Support>> all = {
      {held({ParticleId{0}}, testing::translations)},
      {grip({ParticleId{0}}, all_held)},
      {grip({ParticleId{0}}, {true, true, true, false, false, false})},
      {slanted, held({ParticleId{0}}, {false, true, false, false, false, false})}};
  for (const ContactModel& contact : forms())
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Specimen s = column(1, 1, contact);
      EXPECT_NEAR(rebound(s, all[k], ParticleId{0}, ParticleId{1}), e, tolerance)
          << static_cast<int>(contact.law) << ", held in way " << k;
    }
}

// What is held in part counts as free: e is met along what is.
TEST(ContactMasses, WhatIsHeldInPartCountsAsFree) {
  const HeldDofs plane{true, true, false, true, true, true};
  for (const ContactModel& contact : forms()) {
    const Specimen s = column(1, 1, contact);
    EXPECT_NEAR(rebound(s, {held(numbers(0, 2), plane)}, ParticleId{0}, ParticleId{1}), e, tolerance);
    EXPECT_NEAR(
        rebound(s, {grip(numbers(0, 1), plane), grip(numbers(1, 2), plane)}, ParticleId{0}, ParticleId{1}), e,
        tolerance);
  }
}

// Two that move as prescribed, and one against a wall: nothing moves freely, and nothing is damped.
TEST(ContactMasses, NothingIsDampedWhereNothingIsFree) {
  for (const ContactModel& contact : forms()) {
    Specimen s = column(1, 2, contact);
    s.model.walls = {testing::floor_at(-0.5)};
    Stage stage = testing::plain_stage(1e-4, 0.5);
    stage.supports = {held({ParticleId{0}}, testing::translations), grip({ParticleId{1}}, all_held),
                      held({ParticleId{2}}, testing::translations, {0, 0, -2.0 * v_0})};
    stage.supports[1].velocity = {0, 0, -v_0};
    Simulation run(s.model, stage, s.state);
    run.run();
    EXPECT_EQ(run.books().dissipated, 0.0);
    EXPECT_LT(run.loads().F[ParticleId{0}].z, 0.0);
    EXPECT_TRUE(is_finite(run.loads().F[ParticleId{0}]));
    EXPECT_LT(std::abs(run.balance_error()), 1e-6);
  }
}

TEST(ContactMasses, CapsulesOfClumpsAndHeldOnesPartAsRestitutionSays) {
  ContactModel contact = testing::hertz();
  contact.surface.restitution = e;
  const std::vector<ParticleId> lower = numbers(0, 2), upper = numbers(2, 4);
  const std::vector<std::vector<Support>> all = {{grip(upper, nothing)},
                                                 {grip(lower, nothing), grip(upper, nothing)},
                                                 {held(lower, testing::translations)},
                                                 {held(lower, testing::translations), grip(upper, nothing)}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    Specimen s = testing::crossed_bars(contact, 0.05);
    for (const ParticleId p : s.state.r.ids()) s.state.v[p] = p.value < 2 ? Vec3d{} : Vec3d{0, 0, -0.1};
    Stage stage = testing::plain_stage(2e-4, 6.0);
    stage.supports = all[k];
    Simulation run(s.model, stage, s.state);
    run.run();
    const PerParticle<Vec3d>& v = run.state().v;
    EXPECT_TRUE(run.state().fibre_history.empty());
    EXPECT_NEAR((v[upper[0]] + v[upper[1]] - v[lower[0]] - v[lower[1]]).z / 0.2, e, tolerance) << k;
  }
}

// A clump that lies down: each of its contacts is damped by all of its mass. Damping of what falls on many
// contacts at once is too strong, but the step is chosen for it.
TEST(ContactMasses, StepBoundCountsTheMassOfClumps) {
  constexpr std::size_t n = 25;
  ContactModel contact = testing::linear(1e4, 0.0, 0.05);
  contact.attraction = true;
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) r.push_back({static_cast<double>(k), 0, 0.51});
  Specimen s{equal_particles(r, mass, 0.15, 0.5), {}};
  s.model.contact = contact;
  s.model.walls = {testing::floor_at(0.0)};
  s.state = at_rest(s.model);
  for (Vec3d& v : s.state.v) v = {0, 0, -v_0};
  Stage stage = testing::plain_stage(0.0, 1.0);
  const double apart = step_bound(s.model, s.state, stage).dt;
  stage.supports = {grip(numbers(0, n), nothing)};
  const double as_one = step_bound(s.model, s.state, stage).dt;
  EXPECT_LT(as_one, apart);
  stage.dt = 0.99 * as_one;
  Simulation run(s.model, stage, s.state);
  double fastest = 0.0;
  while (run.clock().time() < 1.0) {
    run.step();
    fastest = std::max(fastest, norm(run.state().v[ParticleId{0}]));
  }
  EXPECT_LE(fastest, v_0);
}

}  // namespace
}  // namespace vbond::contact_masses_test
