// What an equilibrium stage says of stability where it cannot be told.
#include <gtest/gtest.h>

#include <string>

#include "bodies.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond {
namespace {

using testing::fixed;
using testing::pushed;

/// A pinned rod of ten bonds under this force along it and this moment about it, in straight balance. Its
/// critical force is about pi^2 EJ / L^2 = pi^2 0.0025 / 100 = 2.47e-4.
StaticResult straight_column(double P, double M, std::string& told) {
  const testing::Specimen rod = testing::straight_rod(11);
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium,
                            {fixed({ParticleId{0}}, {true, true, true, true, false, false}),
                             fixed({ParticleId{10}}, {false, true, true, false, false, false})},
                            {pushed(10, {-P, 0, 0}, {M, 0, 0})});
  stage.at_saddle = AtSaddle::keep;
  StaticHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text; };
  return run_static_stage(rod.model, stage, rod.state, hooks).result;
}

// 5 % above the critical force the lowest eigenvalue of the symmetric part is some -0.05 P (pi / L)^2 =
// -1e-6. The moment adds an antisymmetric part of half of it, 5e-6: the whole tangent may have eigenvalues of
// either sign, so that nothing is known. That is not the same as neutral.
TEST(Equilibrium, NeitherStableNorNeutralIsSaidWhereAMomentHidesIt) {
  std::string told;
  const StaticResult hidden = straight_column(2.6e-4, 1e-5, told);
  EXPECT_EQ(hidden.ended, "converged");
  EXPECT_FALSE(hidden.unstable.has_value());
  EXPECT_FALSE(hidden.neutral);
  EXPECT_FALSE(hidden.smallest_eigenvalue.has_value());
  EXPECT_EQ(told.find("neutral"), std::string::npos) << told;
}

// Far above it they are below what the moment could hide, and far below it all are positive.
TEST(Equilibrium, IsToldToBeUnstableOrStableWhereAMomentCannotHideIt) {
  std::string told;
  const StaticResult above = straight_column(5e-4, 1e-7, told), below = straight_column(2e-4, 1e-7, told);
  EXPECT_EQ(above.unstable, 2);  // in two planes
  EXPECT_LT(above.smallest_eigenvalue.value(), 0.0);
  EXPECT_EQ(below.unstable, 0);
  EXPECT_GT(below.smallest_eigenvalue.value(), 0.0);
  EXPECT_FALSE(above.neutral || below.neutral);
}

}  // namespace
}  // namespace vbond
