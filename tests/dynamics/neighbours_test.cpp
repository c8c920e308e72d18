#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "random_pose.hpp"
#include "vbond/dynamics/neighbours.hpp"

namespace vbond {
namespace {

std::vector<PoseRow> poses_at(const std::vector<Vec3d>& r) {
  std::vector<PoseRow> pose(r.size());
  for (std::size_t k = 0; k < r.size(); ++k) pose[k].r = r[k];
  return pose;
}

NeighbourList list_of_equal(std::size_t rows, double reach, double skin) {
  return NeighbourList(PerRow<double>(rows, 0.5 * reach), skin);
}

/// Every pair within reach is listed from both sides, in increasing order, and nobody is his own neighbour.
/// Returns how many there are.
std::size_t expect_complete(const NeighbourList& list, const std::vector<PoseRow>& pose,
                            const PerRow<double>& R) {
  std::size_t within = 0;
  for (const Row i : R.ids()) {
    const auto near = list.of(i);
    RC_ASSERT(std::adjacent_find(near.begin(), near.end(), std::greater_equal<>()) == near.end());
    RC_ASSERT(!std::binary_search(near.begin(), near.end(), i));
    for (const Row j : R.ids()) {
      if (i == j || !(norm(pose[i.value].r - pose[j.value].r) < R[i] + R[j])) continue;
      RC_ASSERT(std::binary_search(near.begin(), near.end(), j));
      ++within;
    }
  }
  return within;
}

// Particles of different sizes drift about; after every move every pair within reach must be listed from both
// sides, whether or not the list was rebuilt. Compared with brute force over all pairs.
RC_GTEST_PROP(NeighbourList, NeverMissesAPair, (unsigned seed, bool equal)) {
  testing::PoseSource random(seed);
  const double box = random.uniform(1.0, 6.0), R_max = random.uniform(0.1, 0.6);
  PerRow<double> R;
  std::vector<Vec3d> r;
  for (int k = 0; k < 60; ++k) {
    R.push_back(equal ? R_max : random.uniform(0.3, 1.0) * R_max);
    r.push_back(random.vector(box));
  }
  std::vector<PoseRow> pose = poses_at(r);
  NeighbourList list(R, random.uniform(0.01, 0.5), {});
  std::size_t within = 0;
  for (int move = 0; move < 30; ++move) {
    list.refresh(pose);
    within += expect_complete(list, pose, R);
    for (PoseRow& p : pose) p.r += random.vector(0.05);
  }
  RC_ASSERT(list.rebuilds() >= 1);
  RC_CLASSIFY(within > 0u);
}

// The worst that a list must bear: two particles just outside the listed distance come at each other with
// half the skin each.
TEST(NeighbourList, HoldsAPairThatMovesHalfTheSkinFromBothSides) {
  for (const double outside : {-1e-9, 1e-9}) {
    std::vector<PoseRow> pose = poses_at({{0, 0, 0}, {1.2 + outside, 0, 0}});
    NeighbourList list = list_of_equal(2, 1.0, 0.2);
    list.refresh(pose);
    EXPECT_EQ(list.of(Row{0}).size(), outside < 0.0 ? 1u : 0u);
    pose[0].r.x += 0.1 - 1e-12, pose[1].r.x -= 0.1 - 1e-12;
    EXPECT_FALSE(list.refresh(pose));
    EXPECT_EQ(norm(pose[1].r - pose[0].r) < 1.0,
              outside < 0.0);  // a pair within reach is one that was listed
  }
}

TEST(NeighbourList, IsKeptWhileNothingMovesFar) {
  std::vector<PoseRow> pose = poses_at({{0, 0, 0}, {1, 0, 0}});
  NeighbourList list = list_of_equal(2, 1.0, 0.2);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(list.refresh(pose), k == 0);
    pose[1].r.x += 0.009;  // 0.09 in all: less than half the skin
  }
  EXPECT_EQ(list.rebuilds(), 1);
  pose[1].r.x += 0.03;
  EXPECT_TRUE(list.refresh(pose));
  EXPECT_EQ(list.rebuilds(), 2);
  list.invalidate();
  EXPECT_TRUE(list.refresh(pose));
}

// Whichever particle it is: rows are looked at in blocks.
TEST(NeighbourList, SeesEveryParticleThatMoves) {
  std::vector<Vec3d> r;
  for (int k = 0; k < 300; ++k) r.push_back({2.0 * k, 0, 0});
  std::vector<PoseRow> pose = poses_at(r);
  NeighbourList list = list_of_equal(r.size(), 1.0, 0.2);
  list.refresh(pose);
  for (const std::size_t k : {0u, 127u, 128u, 299u}) {
    EXPECT_FALSE(list.refresh(pose));
    pose[k].r.z += 0.11;
    EXPECT_TRUE(list.refresh(pose)) << k;
  }
}

TEST(NeighbourList, CopesWithParticlesVeryFarApart) {
  for (const double far : {1e9, 1e12, 1e15, 1e300}) {
    // At 1e15 the distance between numbers is 1/8.
    const double apart = far < 1e16 ? 0.5 : 0.0;
    const std::vector<PoseRow> pose =
        poses_at({{0, 0, 0}, {0.5, 0, 0}, {far, -far, far}, {far, -far, far + apart}, {-far, 0, 0}});
    NeighbourList list = list_of_equal(5, 1.0, 0.2);
    list.refresh(pose);
    for (const std::size_t p : {0u, 1u, 2u, 3u}) {
      const auto near = list.of(Row{p});
      ASSERT_EQ(near.size(), 1u) << far;
      EXPECT_EQ(near[0].value, p ^ 1u);
    }
    EXPECT_TRUE(list.of(Row{4}).empty());
  }
}

TEST(NeighbourList, IsEmptyAndStaleWhileAParticleIsNowhere) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<PoseRow> pose = poses_at({{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}});
    NeighbourList list = list_of_equal(3, 0.8, 0.1);
    list.refresh(pose);
    EXPECT_EQ(list.count({0, 3}), 4u);
    pose[1].r.y = bad;
    for (int k = 0; k < 2; ++k) {
      EXPECT_TRUE(list.refresh(pose));
      EXPECT_EQ(list.count({0, 3}), 0u);
    }
    pose[1].r.y = 0.0;
    EXPECT_TRUE(list.refresh(pose));
    EXPECT_EQ(list.count({0, 3}), 4u);
  }
}

TEST(NeighbourList, LeavesOutWhatIsNotToBeKept) {
  const std::vector<PoseRow> pose = poses_at({{0, 0, 0}, {0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 0.4}});
  const auto keep_odd_with_even = [](Row i, Row* first, Row* last) {
    return std::remove_if(first, last, [i](Row j) { return (i.value + j.value) % 2 == 0; });
  };
  NeighbourList list(PerRow<double>(4, 0.5), 0.1, keep_odd_with_even);
  list.refresh(pose);
  for (const std::size_t i : {0u, 1u, 2u, 3u}) {
    const auto near = list.of(Row{i});
    ASSERT_EQ(near.size(), 2u);
    EXPECT_EQ(near[0].value, (i + 1) % 2);
    EXPECT_EQ(near[1].value, (i + 1) % 2 + 2);
  }
}

}  // namespace
}  // namespace vbond
