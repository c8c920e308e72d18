#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "random_pose.hpp"
#include "vbond/terms/walls/wall_touch.hpp"

namespace vbond {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

WallTouch only_touch(const WallShape& shape, const Vec3d& centre) {
  std::vector<WallTouch> found;
  WallSurface(shape).touches(centre, infinity, found);
  EXPECT_EQ(found.size(), 1u);
  return found.empty() ? WallTouch{} : found[0];
}

/// Points of a surface by two parameters in 0..1.
using Points = std::function<Vec3d(double, double)>;

/// The touch leads to a point of the surface, as its nearest parameters say, and no other point is nearer.
void expect_nearest(const WallTouch& t, const Vec3d& centre, const Points& surface, double size) {
  EXPECT_NEAR(norm(t.normal), 1.0, 1e-14);
  double nearest = infinity, to_foot = infinity;
  constexpr int n = 300;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const Vec3d p = surface(i / double{n}, j / double{n});
      nearest = std::min(nearest, norm(p - centre));
      to_foot = std::min(to_foot, norm(p - (centre - t.distance * t.normal)));
    }
  EXPECT_LE(std::abs(t.distance), nearest + 1e-12);
  EXPECT_LT(to_foot, 0.03 * size);  // of the net of points: 2 pi / 300 and its diagonal
}

struct Frame {
  Vec3d centre, x, y, z;
  explicit Frame(testing::PoseSource& random) : centre(random.vector(3.0)) {
    const Axes<double> a = axes(random.rotation(3.0));
    x = a.x, y = a.y, z = a.z;
  }
  Vec3d around(double turn, double radius, double height) const {
    const double angle = 2.0 * std::numbers::pi * turn;
    return centre + radius * std::cos(angle) * x + radius * std::sin(angle) * y + height * z;
  }
};

RC_GTEST_PROP(WallTouches, AreNearestPointsOfDiscs, (unsigned seed)) {
  testing::PoseSource random(seed);
  const Frame f(random);
  const double R = random.uniform(0.5, 2.0);
  const Vec3d centre = f.centre + random.vector(3.0);
  const WallTouch t = only_touch(DiscWall{f.centre, f.z, R}, centre);
  expect_nearest(
      t, centre, [&](double u, double v) { return f.around(u, v * R, 0.0); }, R);
  RC_ASSERT(t.curvature_1 == 0.0 && t.curvature_2 == 0.0 && t.distance >= 0.0);
}

RC_GTEST_PROP(WallTouches, AreNearestPointsOfCylindersWithEnds, (unsigned seed)) {
  testing::PoseSource random(seed);
  const Frame f(random);
  const double R = random.uniform(0.5, 2.0), length = random.uniform(0.5, 2.0);
  const Vec3d centre = f.centre + random.vector(3.0);
  const WallTouch t = only_touch(CylinderWall{f.centre, f.z, R, length, WallSide::outside}, centre);
  expect_nearest(
      t, centre, [&](double u, double v) { return f.around(u, R, (v - 0.5) * length); }, R);
  const bool beside = std::abs(dot(centre - f.centre, f.z)) < 0.5 * length;
  const bool within = norm(across(centre - f.centre, f.z)) < R;
  RC_ASSERT(t.curvature_1 == (beside ? (within ? -1.0 : 1.0) / R : 0.0) && t.curvature_2 == 0.0);
}

RC_GTEST_PROP(WallTouches, AreNearestPointsOfSpheres, (unsigned seed)) {
  testing::PoseSource random(seed);
  const Frame f(random);
  const double R = random.uniform(0.5, 2.0);
  const Vec3d centre = f.centre + random.vector(2.0);
  const bool within = norm(centre - f.centre) < R;
  const WallTouch t = only_touch(SphereWall{f.centre, R, WallSide::outside}, centre);
  expect_nearest(
      t, centre,
      [&](double u, double v) {
        const double turn = std::numbers::pi * v;
        return f.around(u, R * std::sin(turn), R * std::cos(turn));
      },
      R);
  RC_ASSERT((t.distance < 0.0) == within);
  RC_ASSERT(t.curvature_1 == 1.0 / R && t.curvature_2 == 1.0 / R);
  // the same from inside, seen the other way round
  const WallTouch inner = only_touch(SphereWall{f.centre, R, WallSide::inside}, centre);
  RC_ASSERT(inner.normal == -t.normal && inner.distance == -t.distance);
  RC_ASSERT(inner.curvature_1 == -1.0 / R && inner.curvature_2 == -1.0 / R);
}

RC_GTEST_PROP(WallTouches, OfPlanesAndEndlessCylindersAreSigned, (unsigned seed)) {
  testing::PoseSource random(seed);
  const Frame f(random);
  const double R = random.uniform(0.5, 2.0), off = random.uniform(0.01, 4.0), up = random.uniform(-9.0, 9.0);
  const double turn = random.uniform(0.0, 1.0);
  const Vec3d centre = f.around(turn, off, up), outward = f.around(turn, 1.0, 0.0) - f.centre;
  const WallTouch on_plane = only_touch(PlaneWall{f.centre, f.z}, centre);
  RC_ASSERT(std::abs(on_plane.distance - up) < 1e-13 && on_plane.normal == f.z);
  for (const WallSide side : {WallSide::inside, WallSide::outside}) {
    const double sign = side == WallSide::inside ? -1.0 : 1.0;
    const WallTouch t = only_touch(CylinderWall{f.centre, f.z, R, infinity, side}, centre);
    RC_ASSERT(std::abs(t.distance - sign * (off - R)) < 1e-13);
    RC_ASSERT(norm(t.normal - sign * outward) < 1e-12);
    RC_ASSERT(t.curvature_1 == sign / R && t.curvature_2 == 0.0);
  }
}

TEST(WallTouches, AreThoseNearerThanTheReach) {
  const WallSurface wall{PlaneWall{{0, 0, 1}, {0, 0, 1}}};
  EXPECT_TRUE(wall.may_touch({5, 5, 1.4}, 0.5));
  EXPECT_FALSE(wall.may_touch({5, 5, 1.5}, 0.5));
  std::vector<WallTouch> found;
  wall.touches({5, 5, 1.5}, 0.5, found);
  EXPECT_TRUE(found.empty());
  std::vector<std::uint32_t> triangles;
  wall.near({5, 5, 1.0}, 0.5, triangles);
  EXPECT_TRUE(triangles.empty());
}

// On an axis or at a centre every direction is as good; one is chosen, and it is a unit vector.
TEST(WallTouches, HaveANormalWhereAllDirectionsAreAlike) {
  const Vec3d n = normalised(Vec3d{1, 2, -1});
  const WallShape shapes[] = {DiscWall{{}, n, 1.0}, CylinderWall{{}, n, 1.0, 2.0, WallSide::inside},
                              SphereWall{{}, 1.0, WallSide::inside}};
  for (const WallShape& shape : shapes)
    for (const double along : {0.0, 3.0}) EXPECT_NEAR(norm(only_touch(shape, along * n).normal), 1.0, 1e-14);
  const Vec3d on_rim = normalised(across(Vec3d{1, 0, 0}, n));
  EXPECT_NEAR(norm(only_touch(shapes[0], on_rim).normal), 1.0, 1e-14);
}

// K. L. Johnson, Contact Mechanics (1985), 4.1: 1/R' + 1/R'' of a sphere in a hollow sphere, on a cylinder.
TEST(EffectiveRadius, IsTheGeometricMeanOfBothDirections) {
  EXPECT_DOUBLE_EQ(effective_radius(2.0, {{}, 0, 0, 0}), 2.0);
  EXPECT_DOUBLE_EQ(effective_radius(2.0, {{}, 0, -0.25, -0.25}), 4.0);
  EXPECT_DOUBLE_EQ(effective_radius(2.0, {{}, 0, 0.5, 0.5}), 1.0);
  EXPECT_DOUBLE_EQ(effective_radius(2.0, {{}, 0, 0, 1.5}), 1.0);
}

}  // namespace
}  // namespace vbond
