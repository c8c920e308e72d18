#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>
#include <utility>

#include "random_pose.hpp"
#include "vbond/core/sized_points.hpp"

namespace vbond {
namespace {

using Pairs = std::multiset<std::pair<std::size_t, std::size_t>>;  // a pair found twice is seen

Pairs by_cells(const std::vector<Vec3d>& r, double distance) {
  Pairs pairs;
  for_near_pairs(r, distance, [&](std::size_t i, std::size_t j, double d2) {
    EXPECT_EQ(d2, norm2(r[j] - r[i]));
    pairs.insert({i, j});
  });
  return pairs;
}

Pairs by_brute_force(const std::vector<Vec3d>& r, double distance) {
  Pairs pairs;
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm2(r[j] - r[i]) <= sq(distance)) pairs.insert({i, j});
  return pairs;
}

// Fibres, sheets, lumps and clouds in boxes from one cell to very many wide, anywhere: the two ways of laying
// cells into the table, and every pair once in both.
RC_GTEST_PROP(NearPairs, AreThoseOfBruteForce, (unsigned seed)) {
  testing::PoseSource random(seed);
  const auto width = [&] { return std::pow(10.0, random.uniform(-1.0, 2.0)); };
  const Vec3d box{width(), width(), width()},
      corner = std::pow(10.0, random.uniform(0.0, 6.0)) * random.vector(1.0);
  const std::size_t n = 1 + static_cast<std::size_t>(random.uniform(0.0, 300.0));
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3d u = random.vector(1.0);
    r.push_back(corner + Vec3d{u.x * box.x, u.y * box.y, u.z * box.z});
  }
  RC_ASSERT(by_cells(r, 1.0) == by_brute_force(r, 1.0));
}

// Sizes from equal to 1 : 1000, of a few classes and of all: in compact bodies and in thin clouds.
RC_GTEST_PROP(SizedPoints, FindThePairsOfBruteForceOnce, (unsigned seed)) {
  testing::PoseSource random(seed);
  const double spread = random.uniform(0.0, 3.0), width = std::pow(10.0, random.uniform(-1.0, 2.0));
  const Vec3d corner = std::pow(10.0, random.uniform(0.0, 4.0)) * random.vector(1.0);
  const std::size_t n = 1 + static_cast<std::size_t>(random.uniform(0.0, 300.0));
  const bool two_sizes = random.uniform(0.0, 1.0) < 0.3;
  std::vector<Vec3d> r;
  std::vector<double> size;
  for (std::size_t k = 0; k < n; ++k) {
    const double u = random.uniform(0.0, 1.0);
    r.push_back(corner + random.vector(width));
    size.push_back(std::pow(10.0, -spread * (two_sizes ? std::round(u) : u)));
    if (random.uniform(0.0, 1.0) < 0.02) size.back() = 0.0;
  }
  Pairs found, expected;
  for_overlapping_pairs(r, size, [&](std::size_t i, std::size_t j, double d2) {
    RC_ASSERT(d2 == norm2(r[j] - r[i]));
    found.insert({i, j});
  });
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (norm2(r[j] - r[i]) < sq(size[i] + size[j])) expected.insert({i, j});
  RC_ASSERT(found == expected);
}

// A lattice is all ties: neighbours at exactly the distance, on the faces of cells.
TEST(NearPairs, IncludeThoseAtTheDistance) {
  for (const Vec3d& corner : {Vec3d{0, 0, 0}, Vec3d{-3, 7, 1e6}}) {
    std::vector<Vec3d> r;
    for (double x = 0; x < 6; ++x)
      for (double y = 0; y < 6; ++y)
        for (double z = 0; z < 6; ++z) r.push_back(corner + Vec3d{x, y, z});
    EXPECT_EQ(by_cells(r, 1.0).size(), 3u * 5u * 6u * 6u);
  }
}

// A debris cloud beside the body: the table stays small and both are resolved.
TEST(NearPairs, AreFoundInABodyOfWhichAPartHasFlownOff) {
  testing::PoseSource random(4);
  std::vector<Vec3d> r;
  for (int k = 0; k < 400; ++k) {
    const double far = k % 4 == 0 ? 1e9 : 0.0;  // numbers are 1e-7 apart there
    r.push_back(Vec3d{far, -far, 3.0 * far} + random.vector(3.0));
  }
  const Pairs pairs = by_brute_force(r, 1.0);
  EXPECT_GT(pairs.size(), 200u);
  EXPECT_EQ(by_cells(r, 1.0), pairs);
}

TEST(NearPairs, NeedNoPointsAndNoDistance) {
  EXPECT_TRUE(by_cells({}, 1.0).empty());
  EXPECT_TRUE(by_cells({{1, 2, 3}}, 1.0).empty());
  EXPECT_EQ(by_cells({{1, 2, 3}, {1, 2, 3}, {1, 2, 4}}, 0.0).size(), 1u);
}

}  // namespace
}  // namespace vbond
