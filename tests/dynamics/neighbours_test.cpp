#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>

#include "random_pose.hpp"
#include "vbond/dynamics/neighbours.hpp"

namespace vbond {
namespace {

// Particles of different sizes drift about; after every move every pair within reach must be listed from both
// sides, whether or not the list was rebuilt. Compared with brute force over all pairs.
RC_GTEST_PROP(NeighbourList, NeverMissesAPair, (unsigned seed)) {
  testing::PoseSource random(seed);
  const std::size_t n = 60;
  const double box = random.uniform(1.0, 6.0), R_max = random.uniform(0.1, 0.6);
  PerParticle<double> R;
  PerParticle<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) {
    R.push_back(random.uniform(0.3, 1.0) * R_max);
    r.push_back(random.vector(box));
  }
  const auto reach = [&](ParticleId i, ParticleId j) { return R[i] + R[j]; };
  NeighbourList list(2 * R_max, random.uniform(0.01, 0.5), reach,
                     [](ParticleId, ParticleId) { return false; });
  for (int move = 0; move < 30; ++move) {
    list.refresh(r);
    for (const ParticleId i : r.ids()) {
      const auto near = list.of(i);
      const std::set<ParticleId> listed(near.begin(), near.end());
      RC_ASSERT(std::is_sorted(near.begin(), near.end()));
      for (const ParticleId j : r.ids())
        if (i != j && norm(r[i] - r[j]) < reach(i, j)) RC_ASSERT(listed.count(j) == 1u);
    }
    for (Vec3d& x : r) x += random.vector(0.05);
  }
  RC_ASSERT(list.rebuilds() >= 1);
}

TEST(NeighbourList, IsKeptWhileNothingMovesFar) {
  PerParticle<Vec3d> r{{0, 0, 0}, {1, 0, 0}};
  NeighbourList list(
      1.0, 0.2, [](ParticleId, ParticleId) { return 1.0; }, [](ParticleId, ParticleId) { return false; });
  for (int k = 0; k < 10; ++k) {
    list.refresh(r);
    r[ParticleId{1}].x += 0.009;  // 0.09 in all: less than half the skin
  }
  EXPECT_EQ(list.rebuilds(), 1);
  r[ParticleId{1}].x += 0.03;
  list.refresh(r);
  EXPECT_EQ(list.rebuilds(), 2);
}

TEST(NeighbourList, CopesWithParticlesVeryFarApart) {
  PerParticle<Vec3d> r{{0, 0, 0}, {0.5, 0, 0}, {1e9, -1e9, 1e12}, {1e9, -1e9, 1e12 + 0.5}};
  NeighbourList list(
      1.0, 0.2, [](ParticleId, ParticleId) { return 1.0; }, [](ParticleId, ParticleId) { return false; });
  list.refresh(r);
  for (const std::size_t p : {0u, 1u, 2u, 3u}) {
    const auto near = list.of(ParticleId{p});
    ASSERT_EQ(near.end() - near.begin(), 1);
    EXPECT_EQ(near.begin()->value, p ^ 1u);
  }
}

}  // namespace
}  // namespace vbond
