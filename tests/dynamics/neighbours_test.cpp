#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <set>
#include <utility>

#include "random_pose.hpp"
#include "teams.hpp"
#include "vbond/dynamics/neighbours.hpp"

namespace vbond {
namespace {

using testing::team_of;

std::vector<PoseRow> poses_at(const std::vector<Vec3d>& r) {
  std::vector<PoseRow> pose(r.size());
  for (std::size_t k = 0; k < r.size(); ++k) pose[k].r = r[k];
  return pose;
}

/// Neighbours of the first rows, all together.
std::size_t count(const NeighbourList& list, std::size_t rows) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < rows; ++k) n += list.of(Row{k}).size();
  return n;
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
    R.push_back(equal ? R_max : std::pow(random.uniform(0.2, 1.0), 2.0) * R_max);
    r.push_back(random.vector(box));
  }
  std::vector<PoseRow> pose = poses_at(r);
  const Team team = team_of(1, r.size());
  NeighbourList list(R, random.uniform(0.01, 0.5), {});
  std::size_t within = 0;
  for (int move = 0; move < 30; ++move) {
    list.refresh(pose, team);
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
    const Team team = team_of(1, 2);
    NeighbourList list = list_of_equal(2, 1.0, 0.2);
    list.refresh(pose, team);
    EXPECT_EQ(list.of(Row{0}).size(), outside < 0.0 ? 1u : 0u);
    pose[0].r.x += 0.1 - 1e-12, pose[1].r.x -= 0.1 - 1e-12;
    EXPECT_FALSE(list.refresh(pose, team));
    EXPECT_EQ(norm(pose[1].r - pose[0].r) < 1.0,
              outside < 0.0);  // a pair within reach is one that was listed
  }
}

TEST(NeighbourList, IsKeptWhileNothingMovesFar) {
  std::vector<PoseRow> pose = poses_at({{0, 0, 0}, {1, 0, 0}});
  const Team team = team_of(1, 2);
  NeighbourList list = list_of_equal(2, 1.0, 0.2);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(list.refresh(pose, team), k == 0);
    pose[1].r.x += 0.009;  // 0.09 in all: less than half the skin
  }
  EXPECT_EQ(list.rebuilds(), 1);
  pose[1].r.x += 0.03;
  EXPECT_TRUE(list.refresh(pose, team));
  EXPECT_EQ(list.rebuilds(), 2);
  list.invalidate();
  EXPECT_TRUE(list.refresh(pose, team));
}

// Whichever particle it is: rows are looked at in blocks.
TEST(NeighbourList, SeesEveryParticleThatMoves) {
  std::vector<Vec3d> r;
  for (int k = 0; k < 300; ++k) r.push_back({2.0 * k, 0, 0});
  std::vector<PoseRow> pose = poses_at(r);
  const Team team = team_of(1, r.size());
  NeighbourList list = list_of_equal(r.size(), 1.0, 0.2);
  list.refresh(pose, team);
  for (const std::size_t k : {0u, 127u, 128u, 299u}) {
    EXPECT_FALSE(list.refresh(pose, team));
    pose[k].r.z += 0.11;
    EXPECT_TRUE(list.refresh(pose, team)) << k;
  }
}

TEST(NeighbourList, CopesWithParticlesVeryFarApart) {
  for (const double far : {1e9, 1e12, 1e15, 1e300}) {
    // At 1e15 the distance between numbers is 1/8.
    const double apart = far < 1e16 ? 0.5 : 0.0;
    const std::vector<PoseRow> pose =
        poses_at({{0, 0, 0}, {0.5, 0, 0}, {far, -far, far}, {far, -far, far + apart}, {-far, 0, 0}});
    const Team team = team_of(1, 5);
    NeighbourList list = list_of_equal(5, 1.0, 0.2);
    list.refresh(pose, team);
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
    const Team team = team_of(1, 3);
    NeighbourList list = list_of_equal(3, 0.8, 0.1);
    list.refresh(pose, team);
    EXPECT_EQ(count(list, 3), 4u);
    pose[1].r.y = bad;
    for (int k = 0; k < 2; ++k) {
      EXPECT_TRUE(list.refresh(pose, team));
      EXPECT_EQ(count(list, 3), 0u);
    }
    pose[1].r.y = 0.0;
    EXPECT_TRUE(list.refresh(pose, team));
    EXPECT_EQ(count(list, 3), 4u);
  }
}

TEST(NeighbourList, LeavesOutWhatIsNotToBeKept) {
  const std::vector<PoseRow> pose = poses_at({{0, 0, 0}, {0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 0.4}});
  const auto keep_odd_with_even = [](Row i, Row* first, Row* last) {
    return std::remove_if(first, last, [i](Row j) { return (i.value + j.value) % 2 == 0; });
  };
  const Team team = team_of(1, 4);
  NeighbourList list(PerRow<double>(4, 0.5), 0.1, keep_odd_with_even);
  list.refresh(pose, team);
  for (const std::size_t i : {0u, 1u, 2u, 3u}) {
    const auto near = list.of(Row{i});
    ASSERT_EQ(near.size(), 2u);
    EXPECT_EQ(near[0].value, (i + 1) % 2);
    EXPECT_EQ(near[1].value, (i + 1) % 2 + 2);
  }
}

// ---- by several threads -----------------------------------------------------------------------------

/// Clouds, clusters of very many neighbours, and lines in which only the next rows are near.
std::vector<Vec3d> random_body(testing::PoseSource& random, std::size_t n) {
  const double kind = random.uniform(0.0, 3.0),
               box = std::cbrt(static_cast<double>(n)) * random.uniform(0.2, 2.0);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) {
    if (kind < 1.0)
      r.push_back(random.vector(box));
    else if (kind < 2.0)
      r.push_back(random.vector(k % 3 == 0 ? 1.0 : box));
    else
      r.push_back(Vec3d{0.3 * static_cast<double>(k), 0, 0} + random.vector(0.2));
  }
  return r;
}

/// Every list of neighbours as it must be after a rebuild at these positions.
std::vector<std::vector<Row>> lists_by_brute_force(const std::vector<PoseRow>& pose, const PerRow<double>& R,
                                                   double skin, unsigned left_out) {
  std::vector<std::vector<Row>> lists(pose.size());
  if (!std::all_of(pose.begin(), pose.end(), [](const PoseRow& p) { return is_finite(p.r); })) return lists;
  for (std::size_t i = 0; i < pose.size(); ++i)
    for (std::size_t j = 0; j < pose.size(); ++j)
      if (i != j && norm2(pose[j].r - pose[i].r) < sq(R[Row{i}] + R[Row{j}] + skin) &&
          (left_out == 0 || (i + j) % left_out != 0))
        lists[i].push_back(Row{j});
  return lists;
}

// Gases, clusters and lines, of equal and unequal radii, some pairs left out, a particle at infinity now and
// then; so few particles at times that parts are empty. Each list, whoever made it, is the one of brute
// force.
RC_GTEST_PROP(NeighbourList, IsTheSameForAnyNumberOfThreads, (unsigned seed, bool equal, bool leave_out)) {
  testing::PoseSource random(seed);
  const auto n = static_cast<std::size_t>(std::pow(10.0, random.uniform(0.0, 2.7)));
  const unsigned left_out = leave_out ? 3 : 0;
  NeighbourList::Keep keep;
  if (leave_out)
    keep = [](Row i, Row* first, Row* last) {
      return std::remove_if(first, last, [i](Row j) { return (i.value + j.value) % 3 == 0; });
    };
  PerRow<double> R;
  for (std::size_t k = 0; k < n; ++k) R.push_back(equal ? 0.4 : random.uniform(0.1, 0.5));
  std::vector<PoseRow> pose = poses_at(random_body(random, n));
  const double skin = 0.2;
  struct Crowd {
    Team team;
    NeighbourList list;
  };
  std::vector<std::unique_ptr<Crowd>> crowds;
  for (const int threads : {1, 2, 3, 7})
    crowds.emplace_back(new Crowd{team_of(threads, n), NeighbourList(R, skin, keep)});
  for (int move = 0; move < 6; ++move) {
    const auto p = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(n)));
    const Vec3d from = std::exchange(pose[p].r, move == 3 ? Vec3d{NAN, 0, 0} : pose[p].r);
    const auto lists = lists_by_brute_force(pose, R, skin, left_out);
    for (const auto& c : crowds) {
      RC_ASSERT(c->list.refresh(pose, c->team));
      for (std::size_t k = 0; k < n; ++k) {
        const auto near = c->list.of(Row{k});
        RC_ASSERT(std::vector<Row>(near.begin(), near.end()) == lists[k]);
      }
    }
    pose[p].r = from;
    for (PoseRow& q : pose) q.r += random.vector(1.0);
    pose[0].r.x += 2.0;  // by one at least: every list is stale
  }
}

// A bound of the ways spares looks at the particles and changes nothing: lists are made anew at the same
// time.
RC_GTEST_PROP(NeighbourList, IsRebuiltInTheSameStepWhetherWaysAreKnownOrNot, (unsigned seed)) {
  testing::PoseSource random(seed);
  const std::size_t n = 50;
  const double far = std::pow(10.0, random.uniform(0.0, 15.0));  // where positions round
  std::vector<PoseRow> pose = poses_at(random_body(random, n));
  std::vector<Vec3d> v;
  for (PoseRow& p : pose) p.r += Vec3d{far, 0, 0}, v.push_back(random.vector(random.uniform(0.0, 0.02)));
  const Team team = team_of(1, n);
  NeighbourList known = list_of_equal(n, 1.0, 0.2), unknown = list_of_equal(n, 1.0, 0.2);
  for (int step = 0; step < 300; ++step) {
    double way2 = 0.0;
    for (const Vec3d& u : v) way2 = std::max(way2, norm2(u));
    RC_ASSERT(known.refresh(pose, team, std::sqrt(way2)) == unknown.refresh(pose, team));
    for (std::size_t k = 0; k < n; ++k) pose[k].r += v[k] += random.vector(1e-3);
  }
  RC_CLASSIFY(known.rebuilds() > 1);
}

// Memory may run out in any thread: the caller hears of it, and the next list is whole.
TEST(NeighbourList, IsMadeAnewIfItsMakingFailed) {
  const std::size_t n = 500;
  testing::PoseSource random(1);
  const std::vector<PoseRow> pose = poses_at(random_body(random, n));
  for (const std::size_t bad : {0u, 250u, 499u}) {
    bool failing = false;
    const auto keep = [&](Row i, Row*, Row* last) {
      if (failing && i.value == bad) throw std::bad_alloc();
      return last;
    };
    const Team team = team_of(3, n);
    NeighbourList list(PerRow<double>(n, 0.5), 0.2, keep);
    EXPECT_TRUE(list.refresh(pose, team));
    const std::size_t all = count(list, n);
    EXPECT_GT(all, 0u);
    list.invalidate();
    failing = true;
    EXPECT_THROW(list.refresh(pose, team), std::bad_alloc);
    failing = false;
    EXPECT_TRUE(list.refresh(pose, team));
    EXPECT_EQ(count(list, n), all);
  }
}

}  // namespace
}  // namespace vbond
