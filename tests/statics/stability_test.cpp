// What an equilibrium stage says of stability where it cannot be told.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bodies.hpp"
#include "vbond/physics/laws.hpp"
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

/// A block of 2 x 3 x 5 particles that stands on its lowest layer, and this many grains on its top that
/// gravity presses on: they stay in place, and turn freely.
StaticResult block_below_grains(std::size_t grains, StageKind kind) {
  std::vector<Vec3d> r;
  for (int z = 0; z < 5; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 2; ++x) r.push_back({double(x), double(y), double(z)});
  const std::size_t n = r.size();
  for (std::size_t k = 0; k < grains; ++k) r.push_back(r[n - 1 - 3 * k] + Vec3d{0, 0, 0.99});
  testing::Specimen s = testing::particles_at(r);
  for (const ParticleId p : s.state.r.ids()) s.model.radius[p] = 0.5;
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::unbonded};
  s.model.contact.k = 80.0;
  BondRecipe recipe;
  recipe.law = &bond_law<VModel>;
  recipe.parameters = BondStiffness<double>{100.0, 33.66, 5.936, 1.103};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (norm(r[j] - r[i]) < 1.01) testing::bond(s, i, j, recipe);
  std::vector<ParticleId> low, loose;
  for (std::size_t k = 0; k < 6; ++k) low.emplace_back(k);
  for (std::size_t k = n; k < r.size(); ++k) loose.emplace_back(k);
  StaticStage stage = testing::static_stage(
      kind, {fixed(low, testing::clamped), fixed(loose, {true, true, false, false, false, false})}, {});
  stage.gravity = {0, 0, -0.25};
  stage.count = 3;
  return run_static_stage(s.model, stage, s.state, {}).result;
}

// The turns of a grain are three zeros of the tangent. Next to them the search for its lowest eigenvalue must
// not lose one in rounding: either it gave up, or it took what it found for stable.
TEST(Equilibrium, IsNeutralBelowGrainsThatTurnFreely) {
  for (const std::size_t grains : {1u, 2u}) {
    SCOPED_TRACE(grains);
    const StaticResult r = block_below_grains(grains, StageKind::equilibrium);
    EXPECT_EQ(r.ended, "converged");
    EXPECT_TRUE(r.neutral);
    EXPECT_EQ(r.unstable, 0);
    EXPECT_NEAR(r.smallest_eigenvalue.value(), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace vbond
