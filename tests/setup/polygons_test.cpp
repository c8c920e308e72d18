#include "vbond/setup/polygons.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "random_pose.hpp"

namespace vbond::testing {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

std::string cut(const std::vector<Vec3d>& polygon, Triangles& triangles) {
  std::vector<std::uint32_t> all(polygon.size());
  std::iota(all.begin(), all.end(), 0u);
  return cut_polygon(polygon, all, triangles);
}

/// Whether a point of the plane is in a polygon, by a ray along +x.
bool holds(const std::vector<Vec3d>& polygon, const Vec3d& r) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((a.y > r.y) != (b.y > r.y) && r.x < a.x + (r.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

double area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 0.5 * cross(b - a, c - a).z;
}

/// Every point is in as many triangles as it should be, and no triangle is turned over.
void expect_cut_well(const std::vector<Vec3d>& polygon, const Triangles& triangles, PoseSource& random) {
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  double whole = 0.0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) whole += area(polygon[0], polygon[k], polygon[k + 1]);
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    EXPECT_GE(area(polygon[a], polygon[b], polygon[c]) * whole, 0.0);
    sum += area(polygon[a], polygon[b], polygon[c]);
  }
  EXPECT_NEAR(sum, whole, 1e-12);
  for (int k = 0; k < 100; ++k) {
    const Vec3d r = across(random.vector(1.2), Vec3d{0, 0, 1});
    int times = 0;
    for (const auto& [a, b, c] : triangles) times += holds({polygon[a], polygon[b], polygon[c]}, r);
    EXPECT_EQ(times, holds(polygon, r) ? 1 : 0);
  }
}

TEST(Polygons, AreCutIntoTrianglesThatCoverThemOnce) {
  PoseSource random(2);
  for (int k = 0; k < 300; ++k) {
    std::vector<Vec3d> polygon;
    const int n = 4 + k % 40;
    for (int i = 0; i < n; ++i) {
      const double phi = 2.0 * std::numbers::pi * (i + random.uniform(0.0, 0.9)) / n,
                   r = random.uniform(0.1, 1.0);
      polygon.push_back({r * std::cos(phi), r * std::sin(phi), 0});
      if (k % 3 == 0 && i % 2 == 1) {  // a corner in the middle of a side
        const Vec3d last = polygon.back();
        polygon.back() = 0.5 * (last + polygon[polygon.size() - 2]);
        polygon.push_back(last);
      }
    }
    if (k % 2 == 0) std::reverse(polygon.begin(), polygon.end());
    Triangles triangles;
    ASSERT_EQ(cut(polygon, triangles), "") << k;
    expect_cut_well(polygon, triangles, random);
    // the same anywhere in space
    const Quatd q = random.rotation(3.0);
    std::vector<Vec3d> turned;
    for (const Vec3d& r : polygon) turned.push_back(rotate(q, r) + Vec3d{5, -3, 2});
    Triangles there;
    ASSERT_EQ(cut(turned, there), "") << k;
    expect_cut_well(polygon, there, random);
  }
}

// A hole hangs on a side that is there twice.
TEST(Polygons, WithAHoleOnADoubleSideAreCut) {
  const std::vector<Vec3d> frame{{-1, -1, 0},    {1, -1, 0},      {1, 1, 0},      {-1, 1, 0},
                                 {-1, -1, 0},    {-0.5, -0.5, 0}, {-0.5, 0.5, 0}, {0.5, 0.5, 0},
                                 {0.5, -0.5, 0}, {-0.5, -0.5, 0}};
  PoseSource random(3);
  Triangles triangles;
  ASSERT_EQ(cut(frame, triangles), "");
  expect_cut_well(frame, triangles, random);
}

TEST(Polygons, ThatAreConvexAreFans) {
  Triangles triangles;
  ASSERT_EQ(cut({{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {2, 2, 0}, {0, 2, 0}}, triangles), "");
  EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(Polygons, ThatCrossThemselvesAreRefused) {
  Triangles triangles;
  EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, triangles),
            "a face of 4 corners crosses itself");
  EXPECT_EQ(cut({{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 1, 0}}, triangles),
            "a face of 4 corners crosses itself");
  std::vector<Vec3d> star;  // turns one way only
  for (int k = 0; k < 5; ++k)
    star.push_back({std::cos(0.8 * std::numbers::pi * k), std::sin(0.8 * std::numbers::pi * k), 0});
  EXPECT_EQ(cut(star, triangles), "a face of 5 corners crosses itself");
}

}  // namespace
}  // namespace vbond::testing
