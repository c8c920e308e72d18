#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "mesh_bodies.hpp"

namespace vbond::testing {
namespace {

/// A cube of edge 2 whose triangles have corners of their own, moved by up to `amount`.
MeshFile loose_cube(double amount, PoseSource& random, const Vec3d& at = {}) {
  TriangleMesh cube = box_mesh({-1, -1, -1}, {1, 1, 1});
  for (Vec3d& r : cube.corners) r += at;
  return shaken(cube, amount, random);
}

// Wherever borders of cells are: there are none that part two corners.
TEST(JoinedCorners, ThatDifferByRoundingAreOneWhereverTheyAre) {
  PoseSource random(3);
  for (const double amount : {0.0, 1e-16, 1e-12, 1e-9, 3e-7})
    for (int k = 0; k < 200; ++k) {
      MeshFile cube = loose_cube(amount, random, random.vector(3.0));
      clean(cube);
      ASSERT_EQ(cube.mesh.corners.size(), 8u) << amount;
      EXPECT_EQ(cube.open_edges, 0u);
      EXPECT_EQ(cube.unpaired_edges, 0u);
      EXPECT_LE(cube.joined.farthest, 2.0 * std::sqrt(3.0) * amount / std::sqrt(12.0) + 1e-15);
      EXPECT_EQ(cube.joined.count > 0, amount > 1e-16 || cube.joined.farthest > 0.0);
    }
}

TEST(JoinedCorners, AreThoseWithinAMillionthOfTheDiagonal) {
  for (const auto& [gap, corners] : {std::pair{0.9e-6, 4u}, {1.1e-6, 5u}}) {
    MeshFile two;  // triangles of a square with diagonal 1, apart by the gap at one end of its diagonal
    const double a = std::sqrt(0.5);
    two.mesh.corners = {{0, 0, 0}, {a, 0, 0}, {a, a, 0}, {0, 0, gap}, {a, a, 0}, {0, a, 0}};
    two.mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    clean(two);
    EXPECT_EQ(two.mesh.corners.size(), corners) << gap;
    EXPECT_EQ(two.joined.count, 5u - corners);
    EXPECT_NEAR(two.joined.farthest, corners == 4u ? gap : 0.0, 1e-12);
  }
}

// A cube of a millionth of the size of the mesh that it is part of: its corners are nearer to one another
// than corners that are joined elsewhere, and its own rounding is still mended.
TEST(JoinedCorners, LeaveSmallPartsOfALargeMeshAsTheyAre) {
  PoseSource random(5);
  MeshFile file = loose_cube(1e-3, random);
  file.mesh.corners.insert(file.mesh.corners.end(), {{1e7, 0, 0}, {0, 1e7, 0}, {0, 0, 1e7}});
  file.mesh.triangles.push_back({36, 37, 38});
  clean(file);
  EXPECT_EQ(file.mesh.triangles.size(), 13u);
  EXPECT_EQ(file.mesh.corners.size(), 11u);
  EXPECT_EQ(file.open_edges, 3u);
}

// Two corners that are one but for rounding make a needle, which closes a gap of width zero.
TEST(JoinedCorners, MakeNeedlesGoAndAreTold) {
  MeshFile file;
  file.mesh.corners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1e-9, 1, 0}};
  file.mesh.triangles = {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}};
  clean(file);
  EXPECT_EQ(file.mesh.triangles.size(), 2u);
  EXPECT_EQ(file.degenerate, 1u);
  EXPECT_EQ(file.open_edges, 4u);
  EXPECT_EQ(
      file.text(),
      "2 triangles, 4 corners, 1 corners joined with others, at most 7e-10 of its size away, 1 triangles "
      "without an area left out, 4 open edges");
}

// 100,000 corners closer to one another than corners that are joined: a time that grows with the square would
// be minutes.
TEST(JoinedCorners, InCrowdsAreFoundWithoutComparingAllPairs) {
  PoseSource random(7);
  MeshFile file;
  constexpr std::uint32_t n = 100000;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double phi = 2.0 * std::numbers::pi * k / n, next = 2.0 * std::numbers::pi * (k + 1) / n;
    file.mesh.corners.push_back(random.vector(1e-7));
    file.mesh.corners.push_back({std::cos(phi), std::sin(phi), 0});
    file.mesh.corners.push_back({std::cos(next), std::sin(next), 0});
    file.mesh.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  clean(file);
  EXPECT_EQ(file.mesh.triangles.size(), n);
  EXPECT_EQ(file.mesh.corners.size(), n + 1);
  EXPECT_EQ(file.open_edges, n);
}

// A face that is cut where its neighbour is not: what closes the gap of width zero has no area.
TEST(CleanedMeshes, AreClosedWhereATriangleWithoutAnAreaClosesAGap) {
  MeshFile file;
  file.mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  file.mesh.corners.push_back({0.5, 0, 0});  // in the middle of the edge from 0 to 1
  auto& all = file.mesh.triangles;
  const auto cut = std::find(all.begin(), all.end(), std::array<std::uint32_t, 3>{0, 3, 1});
  *cut = {0, 3, 8};
  all.push_back({8, 3, 1});
  MeshFile with_gap = file;
  clean(with_gap);
  EXPECT_EQ(with_gap.unpaired_edges, 3u);
  all.push_back({0, 8, 1});
  clean(file);
  EXPECT_EQ(file.degenerate, 1u);
  EXPECT_EQ(file.unpaired_edges, 0u);
}

}  // namespace
}  // namespace vbond::testing
