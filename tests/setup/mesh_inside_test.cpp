#include <gtest/gtest.h>

#include <functional>

#include "mesh_bodies.hpp"
#include "vbond/setup/mesh_inside.hpp"

namespace vbond::testing {
namespace {

struct Box {
  Vec3d low, high;
  bool holds(const Vec3d& r) const {
    return low.x < r.x && r.x < high.x && low.y < r.y && r.y < high.y && low.z < r.z && r.z < high.z;
  }
  bool is_near_surface(const Vec3d& r, double distance) const {
    const Box larger{low - Vec3d{distance, distance, distance}, high + Vec3d{distance, distance, distance}};
    const Box smaller{low + Vec3d{distance, distance, distance}, high - Vec3d{distance, distance, distance}};
    return larger.holds(r) && !smaller.holds(r);
  }
};

MeshFile file_of(const std::vector<Box>& boxes, std::uint32_t n = 1) {
  MeshFile file;
  for (const Box& box : boxes) {
    const TriangleMesh one = subdivided_box(box.low, box.high, n);
    const auto first = static_cast<std::uint32_t>(file.mesh.corners.size());
    file.mesh.corners.insert(file.mesh.corners.end(), one.corners.begin(), one.corners.end());
    for (const auto& t : one.triangles)
      file.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  clean(file);
  return file;
}

/// Points at random, and those of a lattice on which the boxes stand.
void expect_inside(const MeshInside& inside, const std::vector<Box>& boxes,
                   const std::function<bool(const Vec3d&)>& expected, const char* what) {
  PoseSource random(1);
  int wrong = 0;
  for (int k = 0; k < 3000; ++k) {
    Vec3d r = random.vector(2.5);
    if (k % 2 == 0) r = {0.125 * std::round(8 * r.x), 0.125 * std::round(8 * r.y), r.z};
    bool on_surface = false;
    for (const Box& box : boxes) on_surface = on_surface || box.is_near_surface(r, 1e-9);
    if (!on_surface) wrong += inside(r) != expected(r);
  }
  EXPECT_EQ(wrong, 0) << what;
}

void expect_union(const std::vector<Box>& boxes, std::size_t crossing, const char* what) {
  for (const std::uint32_t n : {1u, 2u, 3u}) {
    const MeshFile file = file_of(boxes, n);
    ASSERT_EQ(file.unpaired_edges, 0u) << what;
    const MeshInside inside(file.surface());
    EXPECT_FALSE(inside.is_ambiguous()) << what;
    EXPECT_EQ(inside.within_others(), 0u) << what;
    EXPECT_TRUE(n > 1 || inside.crossing() == crossing)
        << what;  // others may hang together along common edges
    expect_inside(
        inside, boxes,
        [&](const Vec3d& r) {
          return std::any_of(boxes.begin(), boxes.end(), [&](const Box& b) { return b.holds(r); });
        },
        what);
  }
}

TEST(InsideOfAMesh, IsTheUnionOfSurfacesThatCross) {
  expect_union({{{-1, -1, -1}, {0.5, 0.5, 0.5}}, {{-0.5, -0.5, -0.5}, {1, 1, 1}}}, 2,
               "corners in each other");
  expect_union({{{-2, -0.5, -0.5}, {2, 0.5, 0.5}}, {{-0.4, -2, -0.4}, {0.4, 2, 0.4}}}, 2,
               "a cross of two bars");
  expect_union({{{-2, -0.5, 0}, {2, 0.5, 1}}, {{-0.5, -2, 0}, {0.5, 2, 1}}}, 2,
               "a flat cross, flush above and below");
  expect_union({{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0.5}, {1, 1, 1.5}}}, 2, "in each other, flush at four sides");
  expect_union({{{0, 0, 0}, {2, 2, 2}}, {{1, 0.25, 0.5}, {3, 0.75, 3}}}, 2,
               "a bar through faces cut along lattice lines");
  expect_union({{{-2, -1, -1}, {0, 1, 1}}, {{-1, -0.5, -0.5}, {1, 0.5, 0.5}}, {{0.5, -1, -1}, {2, 1, 1}}}, 3,
               "a chain");
}

// Two solids that share a face: it is there twice, facing opposite ways.
TEST(InsideOfAMesh, IsThatOfBothSolidsWhereTheyTouch) {
  expect_union({{{-1, -1, -1}, {0, 1, 1}}, {{0, -1, -1}, {1, 1, 1}}}, 0, "a common face");
  expect_union({{{-1, -1, -1}, {1, 1, 0}}, {{-1, -1, 0}, {1, 1, 1}}}, 0, "a common face across z");
  expect_union({{{-1, -1, -1}, {0, 0, 0}}, {{0, 0, -1}, {1, 1, 0}}}, 0, "a common edge");
  expect_union({{{-2, -2, -2}, {-1, -1, -1}}, {{1, 1, 1}, {2, 2, 2}}}, 0, "apart");
}

// As some programs write surfaces that are to be seen from both sides.
TEST(InsideOfAMesh, IsThatOfSurfacesWhoseTrianglesAreThereInBothSenses) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  MeshFile file;
  file.mesh = subdivided_box(box.low, box.high, 2);
  for (std::size_t k = 0; k < 48; ++k) {
    const auto [a, b, c] = file.mesh.triangles[k];
    file.mesh.triangles.push_back({b, a, c});
  }
  clean(file);
  EXPECT_EQ(file.doubled, 48u);
  ASSERT_EQ(file.unpaired_edges, 0u);
  expect_inside(
      MeshInside(file.surface()), {box}, [&](const Vec3d& r) { return box.holds(r); }, "both senses");
}

TEST(InsideOfAMesh, HasTheHollowsOfSurfacesWithinOthers) {
  const std::vector<Box> boxes{
      {{-2, -2, -2}, {2, 2, 2}}, {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}, {{-1, -1, -1}, {1, 1, 1}}};
  MeshFile file = file_of(boxes);
  for (const bool turned : {false, true}) {
    if (turned)
      for (std::size_t k = 0; k < 24; k += 2) std::swap(file.solid[k][0], file.solid[k][1]);
    const MeshInside inside(file.surface());
    EXPECT_EQ(inside.surfaces(), 3u);
    EXPECT_EQ(inside.crossing(), 0u);
    EXPECT_EQ(inside.within_others(), 2u);
    expect_inside(
        inside, boxes,
        [&](const Vec3d& r) { return boxes[0].holds(r) != boxes[1].holds(r) || boxes[2].holds(r); },
        "three shells");
  }
}

// The hollow is within two solids that cross, which are one body.
TEST(InsideOfAMesh, HasHollowsInBodiesOfSeveralSurfaces) {
  const std::vector<Box> boxes{{{-2, -1, -1}, {0.5, 1, 1}},
                               {{-0.5, -1.5, -1.5}, {2, 1.5, 1.5}},
                               {{-0.25, -0.5, -0.5}, {0.25, 0.5, 0.5}}};
  const MeshInside inside(file_of(boxes).surface());
  EXPECT_EQ(inside.crossing(), 2u);
  EXPECT_EQ(inside.within_others(), 1u);
  expect_inside(
      inside, boxes,
      [&](const Vec3d& r) { return (boxes[0].holds(r) || boxes[1].holds(r)) && !boxes[2].holds(r); },
      "a hollow in two boxes");
}

TEST(InsideOfAMesh, IsNotGuessedWhereSurfacesMeetInEdgesAndFaceBothWays) {
  MeshFile file = file_of({{{-1, -1, -1}, {0.5, 0.5, 0.5}}, {{-0.5, -0.5, -0.5}, {1, 1, 1}}}, 3);
  EXPECT_FALSE(MeshInside(file.surface()).is_ambiguous());
  std::swap(file.solid[0][0], file.solid[0][1]);
  EXPECT_TRUE(MeshInside(file.surface()).is_ambiguous());
}

// One surface that crosses itself: a bar bent into a closed ring that overlaps itself where its ends would
// meet.
TEST(InsideOfAMesh, HasNoHollowWhereASurfaceOfOneSenseCrossesItself) {
  // a coil of rectangles around the z axis, one and a half turns: the last half turn lies over the first
  TriangleMesh coil;
  constexpr std::uint32_t n = 24;
  for (std::uint32_t k = 0; k <= n; ++k) {
    const double phi = 3.0 * std::numbers::pi * k / n, rise = 0.02 * k;  // 3 pi: one and a half turns
    for (const auto& [r, z] : {std::pair{1.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 1.0}})
      coil.corners.push_back({r * std::cos(phi), r * std::sin(phi), z + rise});
  }
  for (std::uint32_t k = 0; k < n; ++k)
    for (std::uint32_t s = 0; s < 4; ++s) {
      const std::uint32_t a = 4 * k + s, b = 4 * k + (s + 1) % 4;
      coil.triangles.insert(coil.triangles.end(), {{a, b, b + 4}, {a, b + 4, a + 4}});
    }
  coil.triangles.insert(coil.triangles.end(),
                        {{0, 2, 1}, {0, 3, 2}, {4 * n, 4 * n + 1, 4 * n + 2}, {4 * n, 4 * n + 2, 4 * n + 3}});
  const MeshInside inside(coil);
  EXPECT_EQ(inside.surfaces(), 1u);
  EXPECT_TRUE(inside({0, 1.5, 0.3}));   // in the first turn alone, below the second
  EXPECT_TRUE(inside({0, 1.5, 0.7}));   // in both
  EXPECT_TRUE(inside({0, 1.5, 1.25}));  // in the second alone
  EXPECT_TRUE(inside({0, -1.5, 0.9}));
  EXPECT_FALSE(inside({0, 0.5, 0.7}));
  EXPECT_FALSE(inside({0, 1.5, 1.6}));
}

}  // namespace
}  // namespace vbond::testing
