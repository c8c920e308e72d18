// Sums over bonds that several threads share.
#include "vbond/statics/detail/bond_shares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "periodic.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond::bond_shares_test {
namespace {

using testing::Dice;
using testing::Specimen;

/// Particles in a long cell that repeats, moved and turned anyhow: some bonds lead to images, some stretch by
/// another form and go one by one, some have broken; spheres touch.
Specimen any_body(unsigned seed) {
  Dice dice(seed);
  const auto any = [&dice](double size) {
    return Vec3d{dice(-size, size), dice(-size, size), dice(-size, size)};
  };
  std::vector<Vec3d> r;
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 7; ++y)
      for (int z = 0; z < 6; ++z) r.push_back(Vec3d{1.0 * x, 1.0 * y, 1.0 * z} + any(0.2));
  Specimen s = testing::periodic_body({Vec3d{20, 0, 0}, Vec3d{0, 7, 0}, Vec3d{0, 0, 6}}, r);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
  testing::bond_within(s, 1.1, recipe);
  recipe.rules.stretch.form = StretchForm::morse;
  recipe.rules.stretch.alpha = 2.0;
  testing::bond_within(s, 0.9, recipe);
  for (const BondId k : s.state.bonds.ids()) s.state.bonds[k].broken = k.value % 17 == 3;
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::all}, s.model.contact.k = 0.7;
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] += any(0.02);
    s.state.q[p] = normalised(rotation_of(any(0.05)) * s.state.q[p]);
  }
  return s;
}

/// A grip that is free to turn, held particles, one that moves, and a cell that gives way along one edge.
StaticStage any_stage() {
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium,
                            {testing::fixed({ParticleId{0}, ParticleId{401}}, all_held),
                             testing::fixed({ParticleId{830}}, {true, true, true}, {0.01, 0.02, 0.0}),
                             {"grip",
                              {ParticleId{200}, ParticleId{201}, ParticleId{242}},
                              {true, true, true},
                              {},
                              {},
                              {},
                              true,
                              {}}},
                            {testing::pushed(600, {0.1, 0.2, 0.3}, {0.0, 0.1, 0.0})});
  stage.cell.component[0] = testing::stressed(0.01);
  return stage;
}

struct Sums {
  Vector unbalanced, load_direction;
  DenseMatrix tangent;
  double residual, potential;

  friend bool operator==(const Sums&, const Sums&) = default;
};

Sums sums(const StaticBody& body) {
  const SparseMatrix& K = body.tangent();
  return {body.unbalanced(), body.load_direction(), Eigen::Map<const Vector>(K.valuePtr(), K.nonZeros()),
          body.residual(), body.potential()};
}

TEST(BondShares, AddUpToTheSameBitsWithAnyNumberOfThreads) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Specimen s = any_body(seed);
    const StaticStage stage = any_stage();
    std::optional<Sums> whole, broken;
    for (const std::size_t threads : {0u, 1u, 2u, 3u, 16u}) {
      StaticBody body(s.model, stage, s.state, 0.5);
      if (threads > 0) body.sum_with(std::make_shared<Crew>(threads));
      const Sums found = sums(body);
      if (!whole) whole = found;
      EXPECT_TRUE(found == *whole) << seed << ", " << threads;
      body.break_bond(BondId{1000}, BreakMode::bending);
      const Sums then = sums(body);
      if (!broken) broken = then;
      EXPECT_TRUE(then == *broken) << seed << ", " << threads;
    }
    EXPECT_GT(whole->unbalanced.norm(), 0.0);
    EXPECT_FALSE(*whole == *broken);
  }
}

// Each bond is of the parts of its ends, each particle of one part; all parts have something to do.
TEST(BondShares, ShareOutAllBondsThatHoldAndHaveNoImage) {
  const Specimen s = any_body(4);
  const std::size_t threads = 5;
  const BondShares shares(s.state, std::make_shared<Crew>(threads));
  ASSERT_EQ(shares.parts(), threads);
  std::vector<BondId> images;
  std::size_t once = 0, twice = 0;
  for (const BondId k : s.state.bonds.ids()) {
    const Bond& b = s.state.bonds[k];
    const bool is_shared = !b.broken && image_of_j(b).is_itself();
    if (!b.broken && !is_shared) images.push_back(k);
    std::size_t of_parts = 0;
    for (std::size_t part = 0; part < threads; ++part) {
      const auto& bonds = shares.bonds(part);
      const bool is_here = std::binary_search(bonds.begin(), bonds.end(), k);
      EXPECT_EQ(is_here, is_shared && (shares.owns(part, b.i) || shares.owns(part, b.j)));
      of_parts += is_here ? 1 : 0;
    }
    EXPECT_LE(of_parts, 2u);
    once += of_parts == 1 ? 1 : 0, twice += of_parts == 2 ? 1 : 0;
  }
  EXPECT_EQ(shares.with_images(), images);
  EXPECT_GT(once, 3 * twice);  // slabs along the longest side
  for (std::size_t part = 0; part < threads; ++part) EXPECT_GT(shares.bonds(part).size(), once / 10);
}

}  // namespace
}  // namespace vbond::bond_shares_test
