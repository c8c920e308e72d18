#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "random_pose.hpp"
#include "vbond/core/quat.hpp"

namespace vbond {
namespace {

double largest_difference(const Quatd& a, const Quatd& b) {
  return std::max({std::abs(a.w - b.w), std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}
double largest_difference(const Vec3d& a, const Vec3d& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}
double length(const Quatd& q) {
  return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}
Vec3d any_direction(testing::PoseSource& random) {
  Vec3d e = random.vector(1.0);
  while (norm(e) < 0.1) e = random.vector(1.0);
  return normalised(e);
}

// The series against the library's functions. Components are below 1, known to half a unit in the last place
// (1.1e-16) in either, after two or three roundings more.
TEST(Rotation, SmallOnesAreThoseOfSineAndCosine) {
  testing::PoseSource random(1);
  for (const double angle : {0.0, 1e-300, 1e-160, 1e-8, 1e-3, 0.1, 0.3, 0.4, 0.5})
    for (int trial = 0; trial < 100; ++trial) {
      const Vec3d e = any_direction(random), phi = angle * e;
      const double s = std::sin(0.5 * norm(phi));
      EXPECT_LE(
          largest_difference(small_rotation(phi), {std::cos(0.5 * norm(phi)), s * e.x, s * e.y, s * e.z}),
          4e-16)
          << angle;
    }
}

// Across the limit between series and library functions a rotation changes by no more than its angle does:
// |dq| = |dphi| / 2 for a turn about the same axis, but for the roundings of the two.
TEST(Rotation, IsContinuousWhereTheSeriesEnds) {
  testing::PoseSource random(2);
  const double limit = std::sqrt(small_rotation_limit2), d = 1e-9;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3d e = any_direction(random);
    const Quatd below = rotation_of((limit - d) * e), above = rotation_of((limit + d) * e);
    const double turned =
        length({above.w - below.w, above.x - below.x, above.y - below.y, above.z - below.z});
    EXPECT_NEAR(turned, d, 8 * 4e-16);
    EXPECT_NEAR(length(below), 1.0, 4e-16);
    EXPECT_NEAR(length(above), 1.0, 4e-16);
  }
}

TEST(Rotation, VectorIsTheInverseOfTheRotation) {
  testing::PoseSource random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3d phi = random.uniform(0.0, 3.14) * any_direction(random);
    EXPECT_LE(largest_difference(rotation_vector(rotation_of(phi)), phi), 4e-15);  // a few roundings of pi
  }
}

// Each component in turn is the largest, which is what chooses among the four ways to it.
TEST(RotationTo, ReproducesItsAxesByAllFourWays) {
  testing::PoseSource random(4);
  std::array<int, 4> ways{};
  for (int trial = 0; trial < 2000; ++trial) {
    const Quatd q = random.rotation(3.14);
    const std::array<double, 4> size{std::abs(q.w), std::abs(q.x), std::abs(q.y), std::abs(q.z)};
    ++ways[static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin())];
    const Axes<double> wanted = axes(q), got = axes(rotation_to(wanted.x, wanted.y));
    // Axes are known to a few 1e-16 and q is taken from sums of them, divided by at least one.
    EXPECT_LE(largest_difference(got.x, wanted.x), 2e-15);
    EXPECT_LE(largest_difference(got.y, wanted.y), 2e-15);
    EXPECT_LE(largest_difference(got.z, wanted.z), 2e-15);
  }
  for (const int n : ways) EXPECT_GT(n, 100);
  for (const Quatd& q : {Quatd{1, 0, 0, 0}, Quatd{0, 1, 0, 0}, Quatd{0, 0, 1, 0}, Quatd{0, 0, 0, 1}})
    EXPECT_EQ(rotation_to(axes(q).x, axes(q).y), q);  // half turns, where the other three would divide by 0
}

TEST(Axes, AreTheTurnedUnitVectors) {
  testing::PoseSource random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Quatd q = random.rotation(3.14);
    EXPECT_LE(largest_difference(axes(q).x, rotate(q, {1, 0, 0})), 1e-15);
    EXPECT_LE(largest_difference(axes(q).y, rotate(q, {0, 1, 0})), 1e-15);
    EXPECT_LE(largest_difference(axes(q).z, rotate(q, {0, 0, 1})), 1e-15);
  }
}

// |q| = 1 + e becomes (1 + e) (3 - (1 + e)^2) / 2 = 1 - 3/2 e^2 - e^3/2.
TEST(Renormalised, SquaresTheErrorOfTheLength) {
  testing::PoseSource random(6);
  for (const double e : {1e-2, -1e-2, 1e-4, -1e-4, 1e-8, 1e-15}) {
    const Quatd q = random.rotation(3.0);
    const Quatd off{(1.0 + e) * q.w, (1.0 + e) * q.x, (1.0 + e) * q.y, (1.0 + e) * q.z};
    EXPECT_NEAR(length(renormalised(off)), 1.0 - 1.5 * sq(e) - 0.5 * e * sq(e), 1e-15) << e;
    EXPECT_LE(largest_difference(normalised(off), q), 4e-16);
  }
}

}  // namespace
}  // namespace vbond
