// Resting shapes, reached by damped dynamics, against exact statics of the bonded rod.
#include <gtest/gtest.h>

#include <cmath>

#include "rods.hpp"

namespace vbond {
namespace {

/// Rest of a cantilever (particle 0 clamped) under a tip load. `slowest` is the lowest frequency of the
/// continuous beam and damping is critical for it. The chain's own is 10 to 20 % lower, its decay therefore
/// no faster than exp(-0.4 slowest t): e^-32 after the time that is run.
State resting(const testing::Specimen& s, const PointLoad& load, double slowest, double b_rotation,
              double dt) {
  Stage stage = testing::plain_stage(dt, 80.0 / slowest);
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  stage.loads = {load};
  stage.b_translation = 2.0 * slowest;
  stage.b_rotation = b_rotation;
  Simulation run(s.model, stage, s.state);
  run.run();
  return run.state();
}

PointLoad tip_load(std::size_t tip, const Vec3d& force, const Vec3d& moment) {
  PointLoad l;
  l.particles = {ParticleId{tip}};
  l.force = force;
  l.moment = moment;
  return l;
}

// Eleven particles, Bernoulli-Euler bonds with EJ = 1/400, EA = 1, G Jp = 1/480, L = 10: a chain of such
// bonds is an exact beam at small load. The loads are 1e-9: nonlinearity, 1.09 (w / L)^2 = 2e-10 relative, is
// out of sight, and a displacement of 1e-8 or more is known to 1e-15 / 1e-8 = 1e-7 relative.
class Cantilever : public ::testing::TestWithParam<const BondLaw*> {
 protected:
  State under(const Vec3d& force, const Vec3d& moment) const {
    const double omega_1 = 3.516 * std::sqrt(0.0025 / 1e4);  // of the continuous beam
    return resting(testing::straight_rod(11, testing::papers_bond(GetParam())), tip_load(10, force, moment),
                   omega_1, 0.0036, 0.6);
  }
  static constexpr double P = 1e-9;
  const ParticleId tip{10};
};

TEST_P(Cantilever, HasTheExactLinearResponses) {
  const State bent = under({0, P, 0}, {});
  EXPECT_NEAR(bent.r[tip].y / (P * 1000.0 / (3 * 0.0025)), 1.0, 1e-6);                  // P L^3 / 3 EJ
  EXPECT_NEAR(rotation_vector(bent.q[tip]).z / (P * 100.0 / (2 * 0.0025)), 1.0, 1e-6);  // P L^2 / 2 EJ
  const State drawn = under({P, 0, 0}, {});
  EXPECT_NEAR((drawn.r[tip].x - 10.0) / (P * 10.0), 1.0, 1e-6);  // P L / EA
  const State twisted = under({}, {P, 0, 0});
  EXPECT_NEAR(rotation_vector(twisted.q[tip]).x / (P * 10.0 * 480.0), 1.0, 1e-6);  // T L / G Jp
  const State rolled = under({}, {0, 0, P});
  EXPECT_NEAR(rotation_vector(rolled.q[tip]).z / (P * 10.0 / 0.0025), 1.0, 1e-6);  // M L / EJ
}

// Cundall's local damping brings the chain to the same rest: the load that is left, and so the damping force,
// vanishes there. A moving support feels nothing of it: its reaction is that of the elastic bonds.
TEST_P(Cantilever, ComesToTheSameRestByLocalDamping) {
  testing::Specimen s = testing::straight_rod(11, testing::papers_bond(GetParam()));
  Stage stage = testing::plain_stage(0.1, 10000.0);
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  stage.loads = {tip_load(10, {P, 0, 0}, {})};
  stage.local_damping = 0.7;
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_NEAR((run.state().r[tip].x - 10.0) / (P * 10.0), 1.0, 1e-6);  // P L / EA
  EXPECT_NEAR(run.reaction({ParticleId{0}}).force.x / -P, 1.0, 1e-6);
  // The work of the load less the energy stored, P^2 L/(2 EA); leap-frog is off by (omega dt)^2/12 of it or
  // less
  EXPECT_NEAR(run.books().dissipated / (0.5 * P * P * 10.0), 1.0, 1e-3);
  EXPECT_LT(std::abs(run.balance_error()), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(BothLaws, Cantilever, ::testing::Values(&bond_law<VModel>, &bond_law<Evm>));

}  // namespace
}  // namespace vbond
