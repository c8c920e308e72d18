// Pairs of a part of a body, which are found in layers: the same as without.
#include "vbond/model/present.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <tuple>
#include <vector>

namespace vbond {
namespace {

using Pairs = std::vector<std::tuple<std::size_t, std::size_t, double>>;

/// Spheres of two sizes near the points of a lattice, whose numbers are in no order.
struct Cloud {
  Cloud(int nx, int ny, int nz) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> shift(-0.2, 0.2);
    std::vector<Vec3d> places;
    for (int x = 0; x < nx; ++x)
      for (int y = 0; y < ny; ++y)
        for (int z = 0; z < nz; ++z)
          places.push_back({x + shift(random), y + shift(random), z + shift(random)});
    std::shuffle(places.begin(), places.end(), random);
    for (const Vec3d& r : places) {
      state.r.push_back(r);
      model.radius.push_back(state.r.size() % 5 == 0 ? 0.55 : 0.45);
      model.mass.push_back(1.0);
      own.push_back(r.x < 0.4 * nx || r.y < 0.3 * ny);
      near.push_back(ParticleId{near.size()});
    }
  }
  Model model;
  State state;
  PerParticle<char> own;
  std::vector<ParticleId> near;
};

TEST(PairLayers, OfAPartAreItsPairsOnceEach) {
  for (const auto& [nx, ny, nz] : {std::tuple(60, 70, 50), std::tuple(3, 4, 17000), std::tuple(5, 4, 3)}) {
    const Cloud cloud(nx, ny, nz);
    const PartBonds none;
    const BodyPart part(cloud.state, cloud.own, none, cloud.near, alone());
    Pairs found, expected;
    for_overlapping_present(
        cloud.model, part, 0.05,
        [&](std::size_t i, std::size_t j, const Image&, double d2) { found.emplace_back(i, j, d2); });
    for_overlapping_pairs(cloud.state.r.values(), cloud.model.radius.values(), 0.05,
                          [&](std::size_t i, std::size_t j, double d2) {
                            if (cloud.own[ParticleId{i}] != 0) expected.emplace_back(i, j, d2);
                          });
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_GT(expected.size(), cloud.near.size() / 4);
    EXPECT_EQ(found, expected) << nx << ' ' << ny << ' ' << nz;
  }
}

TEST(PairLayers, LoseNoPairFarFromTheOrigin) {  // where places are rounded by more than a part of a layer
  PerParticle<Vec3d> r;
  std::vector<ParticleId> all;
  for (std::size_t k = 0; k < 200'000; ++k)
    r.push_back({1e12 + static_cast<double>(k), 0, 0}), all.push_back(ParticleId{k});
  const PairLayers layers(all, r, 1.0);
  ASSERT_EQ(layers.count(), 4u);
  for (std::size_t k = 1; k < all.size(); ++k) {
    EXPECT_TRUE(layers.is_near(r[all[k]], layers.of(r[all[k - 1]])));
    EXPECT_TRUE(layers.is_near(r[all[k - 1]], layers.of(r[all[k]])));
  }
}

TEST(PairLayers, AreOneWhereTheyWouldBeThinnerThanPairsReach) {
  PerParticle<Vec3d> r;
  std::vector<ParticleId> all;
  for (std::size_t k = 0; k < 200'000; ++k)
    r.push_back({1e-6 * static_cast<double>(k), 0, 0}), all.push_back(ParticleId{k});
  EXPECT_EQ(PairLayers(all, r, 0.01).count(), 4u);
  EXPECT_EQ(PairLayers(all, r, 0.1).count(), 1u);
  EXPECT_EQ(PairLayers({}, r, 0.1).count(), 1u);
}

}  // namespace
}  // namespace vbond
