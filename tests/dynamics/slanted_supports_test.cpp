// Supports along and about axes that are not those of the world, in motion.
#include <gtest/gtest.h>

#include <cmath>

#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"

namespace vbond::slanted_supports_test {
namespace {

using testing::Dice;
using testing::Specimen;

/// On a plane that slopes by this angle about y, with its normal in x and z.
Support on_slope(const std::vector<ParticleId>& particles, double angle) {
  Support s = testing::held(particles, {});
  const HeldDirections d = held_directions({}, {{std::sin(angle), 0, std::cos(angle)}}, {});
  s.held = d.held, s.axes = d.axes;
  return s;
}

// g sin(angle) down the slope; the reaction is m g cos(angle) along the normal, and does no work.
TEST(SlantedSupports, ParticleSlidesDownASlope) {
  Specimen s = testing::particles_at({{0, 0, 0}});
  Stage stage = testing::plain_stage(0.01, 2.0);
  stage.gravity = {0, 0, -9.81};
  const double angle = 0.4;
  stage.supports = {on_slope({ParticleId{0}}, angle)};
  Simulation run(s.model, stage, s.state);
  run.run();
  const Vec3d down{std::cos(angle), 0, -std::sin(angle)}, normal{std::sin(angle), 0, std::cos(angle)};
  const double way = 0.5 * 9.81 * std::sin(angle) * 4.0;  // leap-frog is exact for a constant force
  EXPECT_LE(norm(run.state().r[ParticleId{0}] - way * down), 1e-13);
  const Reaction r = run.reaction({ParticleId{0}});
  EXPECT_LE(norm(r.force - 9.81 * std::cos(angle) * normal), 1e-14);
  EXPECT_NEAR(run.books().work_supports, 0.0, 1e-13);
  EXPECT_NEAR(run.books().work_loads, 0.5 * sq(9.81 * std::sin(angle) * 2.0), 1e-12);
}

// A body that has turned with its supports, their motion and its loads moves as before. 300 steps: rounding
// of 1e-16 a step grows by less than 1e4 in them. The balance of energy closes as it does without slant.
TEST(SlantedSupports, MotionTurnsWithTheBody) {
  testing::campaign("slanted supports", 10, [](unsigned seed) {
    Dice dice(seed);
    const Specimen plain = testing::random_body(dice);
    const std::size_t n = plain.model.particles();
    const double local_damping = dice(0, 1) < 0.5 ? 0.0 : dice(0, 0.5);
    Stage stage = testing::plain_stage(0.02, 6.0);
    for (const std::size_t k : {std::size_t{0}, n - 1, n - 2}) {
      Support s = testing::held({ParticleId{k}}, testing::some_dofs(dice, 0.5));
      for (int a = 0; a < 3; ++a) {
        const auto dof = static_cast<std::size_t>(a);
        if (s.held[dof]) component(s.velocity, a) = dice(-0.05, 0.05);
        if (s.held[dof + 3]) component(s.angular_velocity, a) = dice(-0.1, 0.1);
      }
      s.factor.points = {{0, 0}, {2, 1}, {5, -0.5}};
      stage.supports.push_back(s);
    }
    PointLoad load{"load", {ParticleId{1}}, dice.vector(0.01), dice.vector(0.002), {}};
    stage.loads = {load};
    const Quatd turn = rotation_of(dice.vector(1.5));
    Stage slanted = stage;
    for (Support& s : slanted.supports) {
      s.axes = testing::turned_axes(turn);
      s.velocity = rotate(turn, s.velocity), s.angular_velocity = rotate(turn, s.angular_velocity);
    }
    slanted.loads[0].force = rotate(turn, load.force), slanted.loads[0].moment = rotate(turn, load.moment);
    const Specimen turned = testing::turned(plain, turn);
    Simulation before(plain.model, stage, plain.state), after(turned.model, slanted, turned.state);
    before.run(), after.run();
    for (const ParticleId p : plain.state.r.ids()) {
      ASSERT_LE(norm(after.state().r[p] - rotate(turn, before.state().r[p])), 1e-11);
      ASSERT_LE(norm(after.state().omega[p] - rotate(turn, before.state().omega[p])), 1e-11);
    }
    const Reaction a = before.reaction({ParticleId{n - 1}}), b = after.reaction({ParticleId{n - 1}});
    ASSERT_LE(norm(b.force - rotate(turn, a.force)), 1e-11);
    ASSERT_LE(norm(b.moment - rotate(turn, a.moment)), 1e-11);
    ASSERT_NEAR(after.books().work_supports, before.books().work_supports, 1e-12);
    ASSERT_NEAR(after.books().work_loads, before.books().work_loads, 1e-12);

    // Local damping goes by axes. Those of a particle turn with it where one translation and one turn of it
    // are free: which two a single held direction leaves free is up to the code. Where a rate is zero to
    // rounding, as before the first wave comes, its sign may differ, and so the damping of a step: places by
    // 3e-8 and energies by 6e-12 at most in 300 bodies, measured.
    if (local_damping == 0.0) return;
    for (Stage* st : {&stage, &slanted}) {
      st->local_damping = local_damping;
      st->supports.resize(1);
      st->supports[0] = testing::held({ParticleId{0}}, testing::clamped);
      for (std::size_t k = 1; k < n; ++k) {
        HeldDofs most = all_held;
        most[k % 3] = most[3 + (k + 1) % 3] = false;
        st->supports.push_back(testing::held({ParticleId{k}}, most));
        if (st == &slanted) st->supports.back().axes = testing::turned_axes(turn);
      }
    }
    Simulation damped(plain.model, stage, plain.state), damped_after(turned.model, slanted, turned.state);
    damped.run(), damped_after.run();
    for (const ParticleId p : plain.state.r.ids())
      ASSERT_LE(norm(damped_after.state().r[p] - rotate(turn, damped.state().r[p])), 1e-7);
    ASSERT_NEAR(damped_after.books().dissipated, damped.books().dissipated, 1e-10);
  });
}

// The work of supports that push along a slope is what the body gains.
TEST(SlantedSupports, BalanceOfEnergyCloses) {
  Specimen s = testing::straight_rod(6);
  double error[2];
  for (const int k : {0, 1}) {
    Stage stage = testing::plain_stage(k == 0 ? 0.02 : 0.01, 40.0);
    stage.supports = {testing::held({ParticleId{0}}, testing::clamped), on_slope({ParticleId{5}}, 0.5)};
    stage.supports[1].velocity = 0.002 * stage.supports[1].axes->along[0];
    Simulation run(s.model, stage, s.state);
    run.run();
    // the support brings its particle to 0.002 at once, and pushes the others after it
    EXPECT_GT(run.books().work_supports, 0.5 * sq(0.002));
    error[k] = std::abs(run.balance_error());
  }
  EXPECT_LT(error[1], 1e-4);             // (omega dt)^2 / 4 of leap-frog, with the chain's fastest omega = 2
  EXPECT_LT(error[1], 0.26 * error[0]);  // of second order, but for some (omega dt)^2 of a quarter
}

// Angular velocity about a slanted axis is kept, and its moment told.
TEST(SlantedSupports, TurnAboutASlantedAxis) {
  Specimen s = testing::particles_at({{0, 0, 0}});
  Stage stage = testing::plain_stage(0.01, 1.0);
  const Vec3d axis = normalised(Vec3d{1, 2, 2});
  Support support = testing::held({ParticleId{0}}, {});
  const HeldDirections d = held_directions({}, {}, {axis});
  support.held = d.held, support.axes = d.axes;
  support.angular_velocity = 0.5 * axis;
  stage.supports = {support};
  stage.loads = {{"load", {ParticleId{0}}, {}, {0.3, 0, 0}, {}}};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_NEAR(dot(run.state().omega[ParticleId{0}], axis), 0.5, 1e-15);
  EXPECT_NEAR(norm(across(run.state().omega[ParticleId{0}], axis)),
              norm(across(Vec3d{0.3, 0, 0}, axis)) / 0.064, 1e-12);
  EXPECT_LE(norm(run.reaction({ParticleId{0}}).moment + 0.1 * axis), 1e-15);  // -(0.3, 0, 0) along it
}

}  // namespace
}  // namespace vbond::slanted_supports_test
