#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bodies.hpp"
#include "validation/cases.hpp"
#include "vbond/core/error.hpp"

namespace vbond {
namespace {

using testing::fixed;
using testing::pushed;
using testing::static_stage;

const ParticleId first{0};

StaticOutcome equilibrium(const testing::Specimen& s, const StaticStage& stage,
                          const StaticHooks& hooks = {}) {
  return run_static_stage(s.model, stage, s.state, hooks);
}

/// The standard rod clamped at its first particle, with a force and a moment at its last.
StaticStage cantilever(std::size_t N, const Vec3d& force, const Vec3d& moment = {}) {
  return static_stage(StageKind::equilibrium, {fixed({first}, testing::clamped)}, {pushed(N, force, moment)});
}

// A chain of Bernoulli-Euler bonds is an exact beam at small load: model of 11 particles, a = 1, d = 0.2.
// Nonlinear terms are of the order of the slope squared, (P L^2 / 2 EI)^2 = 4e-4 P'^2 with P' in 1e-6: a
// load of 1e-9 leaves 4e-10 times a factor below one.
TEST(LinearCantilever, HasTheDeflectionsOfABeam) {
  const testing::Specimen rod = testing::straight_rod(11);
  const double P = 1e-9, scale = P / 1e-6;
  const State bent = equilibrium(rod, cantilever(10, {0, P, 0})).state;
  const ParticleId tip{10};
  EXPECT_NEAR(bent.r[tip].y / scale, 0.4 / 3, 1e-9);
  EXPECT_NEAR(rotation_vector(bent.q[tip]).z / scale, 0.02, 1e-9 * 0.02);
}

}  // namespace
}  // namespace vbond
