#include <gtest/gtest.h>

#include <cmath>

#include "rods.hpp"

namespace vbond {
namespace {

struct Collision {
  double overlap = 0, force = 0, duration = 0;
};

/// Two equal particles, c_H = a = m = 1, that meet head-on with relative speed v.
Collision collide(double v, double dt) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.8 + 1e-9, 0, 0}});
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::all, 1.0, 1.0, 0, 0};
  s.state.v = {{v / 2, 0, 0}, {-v / 2, 0, 0}};
  Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
  Collision c;
  double began = -1.0;
  double overlap = 0.0;
  while (began < 0 || overlap > 0) {
    run.step();
    overlap = 0.8 - (run.state().r[ParticleId{1}].x - run.state().r[ParticleId{0}].x);
    if (overlap > 0 && began < 0) began = run.state().clock.time();
    if (overlap > 0) c.duration = run.state().clock.time() - began;
    c.overlap = std::max(c.overlap, overlap);
    c.force = std::max(c.force, -run.loads().F[ParticleId{0}].x);
  }
  return c;
}

// Validation case C1: closed forms d_m = (5 v^2 m / (16 c_H))^(2/5) ... , duration 2.943275184 d_m / v, given
// to 12 digits. 1e-4 is what the case asks; the step, a 20000th of the contact, leaves some 1e-6, and the
// duration is counted in whole steps.
TEST(PapersHertz, HeadOnCollisionHasTheExactOverlapForceAndDuration) {
  const struct {
    double v, overlap, force, duration;
  } cases[] = {{0.001, 0.00329876977693, 0.000189464570814, 9.70918722324},
               {0.01, 0.020813830185, 0.00300281108495, 6.12608298744},
               {0.1, 0.13132639022, 0.0475913484679, 3.86529705382}};
  for (const auto& c : cases) {
    const double dt = c.duration / 20000;
    const Collision found = collide(c.v, dt);
    EXPECT_NEAR(found.overlap / c.overlap, 1.0, 1e-4);
    EXPECT_NEAR(found.force / c.force, 1.0, 1e-4);
    EXPECT_NEAR(found.duration, c.duration, 3 * dt);
  }
}

TEST(Contacts, LeaveOutBondedPairsIfTheModelSaysSo) {
  for (const ContactPairs pairs : {ContactPairs::all, ContactPairs::unbonded}) {
    testing::Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}}, 0.6);
    testing::bond(s, 0, 1, testing::papers_bond());
    s.model.contact = {ContactLaw::paper_hertz, pairs, 1.0, 1.0, 0, 0};
    const Simulation run(s.model, testing::plain_stage(0.1, 1), s.state);
    const double expected = pairs == ContactPairs::all ? std::pow(0.2, 1.5) : 0.0;
    EXPECT_NEAR(-run.loads().F[ParticleId{0}].x, expected, 1e-15);
    EXPECT_NEAR(run.energies().contact, 0.4 * 0.2 * expected, 1e-15);
  }
}

}  // namespace
}  // namespace vbond
