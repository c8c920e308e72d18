// The skin of what points fill: closed, outwards, and as large as the body.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "vbond/packing/skin.hpp"

namespace vbond::skin_test {
namespace {

using packing::Skin;
using packing::skin_of;
using testing::Dice;

/// Every edge is run along as often one way as the other.
bool is_closed(const Skin& skin) {
  std::map<std::pair<std::size_t, std::size_t>, int> runs;
  for (const auto& t : skin.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t p = t[k], q = t[(k + 1) % 3];
      runs[std::minmax(p, q)] += p < q ? 1 : -1;
    }
  return std::all_of(runs.begin(), runs.end(), [](const auto& r) { return r.second == 0; });
}

double volume_of(const Skin& skin, const std::vector<Vec3d>& r) {
  double six = 0.0;
  for (const auto& [i, j, k] : skin.triangles) six += dot(r[i], cross(r[j], r[k]));
  return six / 6.0;
}
double area_of(const Skin& skin, const std::vector<Vec3d>& r) {
  double two = 0.0;
  for (const auto& [i, j, k] : skin.triangles) two += norm(cross(r[j] - r[i], r[k] - r[i]));
  return two / 2.0;
}

std::vector<Vec3d> cubes(int x, int y, int z) {
  std::vector<Vec3d> r;
  for (int a = 0; a < x; ++a)
    for (int b = 0; b < y; ++b)
      for (int c = 0; c < z; ++c) r.push_back({1.0 * a, 1.0 * b, 1.0 * c});
  return r;
}

// A cube of a lattice has a sphere of radius sqrt(3)/2 around it, and many sets of tetrahedra: the skin is
// the same box whichever is taken.
TEST(Skin, OfALatticeIsTheBox) {
  const std::vector<Vec3d> r = cubes(5, 4, 3);
  const auto skin = skin_of(r, 1.0);
  ASSERT_TRUE(skin);
  EXPECT_TRUE(is_closed(*skin));
  EXPECT_NEAR(volume_of(*skin, r), 4 * 3 * 2, 1e-12);
  EXPECT_NEAR(area_of(*skin, r), 2 * (4 * 3 + 3 * 2 + 2 * 4), 1e-12);
  EXPECT_EQ(skin->triangles, skin_of(r, 1.0)->triangles);
}

TEST(Skin, IsEmptyWhereSpheresAreTooLarge) {
  const auto skin = skin_of(cubes(3, 3, 3), 0.8);
  ASSERT_TRUE(skin);
  EXPECT_TRUE(skin->triangles.empty());
  EXPECT_TRUE(skin_of({{0, 0, 0}, {1, 0, 0}}, 1.0)->triangles.empty());
}

TEST(Skin, TellsOfPointsThatAreNotFilled) {
  std::vector<Vec3d> r = cubes(3, 3, 3);
  EXPECT_TRUE(skin_of(r, 1.0)->outside.empty());  // also of the one in the middle
  r.push_back({1, 1, 3});
  r.push_back({1, 1, 4});
  EXPECT_EQ(skin_of(r, 1.2)->outside, std::vector<std::size_t>{28});
  EXPECT_EQ(skin_of(r, 0.8)->outside.size(), r.size());
  EXPECT_EQ(skin_of({{0, 0, 0}, {1, 0, 0}}, 1.0)->outside, (std::vector<std::size_t>{0, 1}));
}

// What is enclosed is body; a bore that is open at its ends is not, and has a skin that faces into it.
TEST(Skin, LeavesOutHollowsAndTakesInBores) {
  const auto without = [](int x0, int x1, int y0, int y1, int z0, int z1) {
    std::vector<Vec3d> r = cubes(8, 8, 8);
    std::erase_if(r, [&](const Vec3d& p) {
      return p.x > x0 && p.x < x1 && p.y > y0 && p.y < y1 && p.z > z0 && p.z < z1;
    });
    return r;
  };
  const std::vector<Vec3d> hollow = without(1, 6, 1, 6, 1, 6), bored = without(1, 6, 1, 6, -1, 9);
  const auto around = skin_of(hollow, 1.0), through = skin_of(bored, 1.0);
  ASSERT_TRUE(around && through);
  EXPECT_NEAR(volume_of(*around, hollow), 343.0, 1e-9);
  EXPECT_TRUE(is_closed(*through));
  // in the corners of the bore there is room for half a cube, the sphere around which is that of a cube
  const double section = 49 - 25 + 4 * 0.5, wall = 4 * (3 + std::sqrt(2.0));
  EXPECT_NEAR(volume_of(*through, bored), 7 * section, 1e-9);
  EXPECT_NEAR(area_of(*through, bored), 4 * 49 + 2 * section + 7 * wall, 1e-9);
}

// Points in a ball, no two nearer than 0.7 of the spacing: the skin is closed and no larger than the ball;
// with every point within it the volume is that of the ball but for a layer. All points inside have their
// share.
TEST(Skin, OfRandomPointsIsClosed) {
  testing::campaign("skins of random points", 60, [](unsigned seed, testing::Tally& tally) {
    Dice dice(seed);
    const double R = dice(2.0, 4.0);
    std::vector<Vec3d> r;
    for (int tries = 0; tries < 20000; ++tries) {
      const Vec3d p = dice.vector(R);
      if (norm(p) <= R && std::all_of(r.begin(), r.end(), [&](const Vec3d& q) { return norm2(p - q) > 0.5; }))
        r.push_back(p);
    }
    const auto skin = skin_of(r, 1.2);
    ASSERT_TRUE(skin);
    EXPECT_TRUE(is_closed(*skin));
    const double ball = 4.0 / 3.0 * M_PI * R * R * R, inner = 4.0 / 3.0 * M_PI * std::pow(R - 1.0, 3);
    EXPECT_LT(volume_of(*skin, r), ball);
    EXPECT_GT(volume_of(*skin, r), inner);
    std::set<std::size_t> on;
    for (const auto& t : skin->triangles) on.insert(t.begin(), t.end());
    for (const std::size_t p : on) EXPECT_GT(norm(r[p]), R - 1.6);
    tally.add("points", static_cast<double>(r.size()));
    tally.add("triangles", static_cast<double>(skin->triangles.size()));
  });
}

}  // namespace
}  // namespace vbond::skin_test
