// Loads that turn with their particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "tops.hpp"

namespace vbond::follower_test {
namespace {

using testing::Dice;
using testing::Specimen;

PointLoad follower(std::size_t particle, const Vec3d& force, const Vec3d& moment = {}) {
  PointLoad l{"load", {ParticleId{particle}}, force, moment, {}};
  l.follower = true;
  return l;
}

/// Where a particle that turns at w about z is at time t, if a force F along its own x pushes it: from rest.
Vec3d on_a_circle(double F, double w, double t) {
  const double R = F / (w * w);
  return {R * (1.0 - std::cos(w * t)), R * (w * t - std::sin(w * t)), 0};
}

// A particle that turns by itself goes on a cycloid. Twice as many steps: a quarter of the error; the work is
// the kinetic energy to rounding, however long the step.
TEST(FollowerForce, DrivesATurningParticleOnACycloid) {
  const double F = 0.3, w = 1.7, T = 5.0;
  double error[2];
  for (const int k : {0, 1}) {
    Specimen s = testing::particles_at({{0, 0, 0}});
    s.state.omega[ParticleId{0}] = {0, 0, w};
    Stage stage = testing::plain_stage(k == 0 ? 0.1 : 0.05, T);
    stage.loads = {follower(0, {F, 0, 0})};
    Simulation run(s.model, stage, s.state);
    run.run();
    error[k] = norm(run.state().r[ParticleId{0}] - on_a_circle(F, w, T));
    const double kinetic = 0.5 * norm2(run.state().v[ParticleId{0}]);
    EXPECT_NEAR(run.books().work_loads, kinetic, 1e-14);
    EXPECT_LT(std::abs(run.balance_error()), 1e-14);
    const double speed = 2.0 * F / w * std::abs(std::sin(0.5 * w * T));
    EXPECT_NEAR(std::sqrt(2.0 * kinetic), speed, k == 0 ? 5e-3 : 1.3e-3);
  }
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.05);
  EXPECT_LT(error[1], 1e-3);
}

// Given along the axes of the particle, also where these are turned as the stage begins.
TEST(FollowerForce, IsAlongTheAxesOfTheParticle) {
  Specimen s = testing::particles_at({{0, 0, 0}});
  s.state.q[ParticleId{0}] = rotation_of({0, 0, M_PI / 2});
  Stage stage = testing::plain_stage(0.1, 1.0);
  stage.loads = {follower(0, {1, 0, 0}, {0, 0.064, 0})};
  Simulation run(s.model, stage, s.state);
  run.step();
  EXPECT_LE(norm(run.state().v[ParticleId{0}] - Vec3d{0, 0.1, 0}), 5e-4);        // turns by 0.005 meanwhile
  EXPECT_LE(norm(run.state().omega[ParticleId{0}] - Vec3d{-0.1, 0, 0}), 1e-15);  // about its own axis
}

// A moment about an axis of the particle goes on about it for ever: after ten turns the energy is M times the
// angle. A dead one would have turned a top over.
TEST(FollowerMoment, TurnsWithItsParticle) {
  Specimen s = testing::particles_at({{0, 0, 0}});
  Stage stage = testing::plain_stage(0.05, 50.0);
  const Vec3d M = 0.003 * normalised(Vec3d{1, -2, 0.5});
  stage.loads = {follower(0, {}, M)};
  Simulation run(s.model, stage, s.state);
  run.run();
  const double angle = 0.5 * norm(M) / 0.064 * 2500.0;
  EXPECT_NEAR(run.books().work_loads, norm(M) * angle, 1e-12 * angle);
  EXPECT_LE(norm(run.state().omega[ParticleId{0}] - (50.0 / 0.064) * M), 1e-12);
}

// Random bodies under follower forces and moments, with factors of time, tops among them: the books close, to
// second order, as both runs are looked at after the same times, and the motion of a body that has turned as
// a whole is the same, turned: loads are then given by the same numbers. Of 300 bodies the largest error is
// 1.6e-4 of the energy, and the ratio of errors within 1e-3 of a quarter.
TEST(FollowerLoads, BalanceOfEnergyClosesAndAxesAreTheParticles) {
  testing::campaign("follower loads", 10, [](unsigned seed) {
    Dice dice(seed);
    Specimen s = testing::random_body(dice);
    if (dice(0, 1) < 0.5) make_top(s.model, ParticleId{1}, {{0.08, 0.1, 0.15}, {}});
    Stage stage = testing::plain_stage(0.04, 16.0);
    stage.loads = {follower(1, dice.vector(0.02), dice.vector(0.004)), follower(2, dice.vector(0.02))};
    stage.loads[0].factor.points = {{0, 0}, {4, 1}, {12, -0.5}};
    stage.loads[1].force_by_mass = dice.vector(0.01);
    double error[2];
    State end;
    for (const int k : {0, 1}) {
      stage.dt = k == 0 ? 0.04 : 0.02;
      Simulation run(s.model, stage, s.state);
      error[k] = 0.0;
      for (int look = 0; look < 20; ++look) {
        for (int n = 0; n < (k == 0 ? 20 : 40); ++n) run.step();
        error[k] = std::max(error[k], std::abs(run.balance_error()));
      }
      end = run.state();
    }
    EXPECT_LT(error[1], 4e-4);
    EXPECT_NEAR(error[1] / error[0], 0.25, 0.01);

    const Quatd turn = rotation_of(dice.vector(1.5));
    const Specimen turned = testing::turned(s, turn);
    Simulation again(turned.model, stage, turned.state);
    again.run();
    for (const ParticleId p : end.r.ids()) ASSERT_LE(norm(again.state().r[p] - rotate(turn, end.r[p])), 1e-9);
  });
}

}  // namespace
}  // namespace vbond::follower_test
