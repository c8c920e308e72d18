#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "packing/plain_packing.hpp"

namespace vbond::packing::vessel_test {
namespace {

using namespace packing::testing;
constexpr double pi = std::numbers::pi;

TEST(Vessel, VolumesAreThoseOfGeometry) {
  // parts of 1/256 of the frame; what they leave is of either sign
  const double near = 1e-4;
  EXPECT_NEAR(volume_deeper_than(box({1, 2, 3}), 0) / 6.0, 1.0, near);
  EXPECT_NEAR(volume_deeper_than(cylinder(1.3, 4), 0) / (pi * 1.69 * 4), 1.0, near);
  EXPECT_NEAR(volume_deeper_than(hollow_ball(2), 0) / (4.0 / 3.0 * pi * 8), 1.0, near);
  EXPECT_NEAR(volume_deeper_than(hollow_ball(2), 0.5) / (4.0 / 3.0 * pi * 3.375), 1.0, near);
  EXPECT_DOUBLE_EQ(volume_deeper_than(periodic_cell({2, 0, 0}, {1, 3, 0}, {0.5, 0.4, 1}), 0), 6.0);
  Vessel holed = box({4, 4, 4});
  holed.walls.push_back(ball({2, 2, 2}, 1, false));
  holed.walls.push_back(around_box({0, 0, 0}, {1, 1, 1}));
  holed.walls.push_back(around_cylinder({3.5, 0, 0.5}, {3.5, 4, 0.5}, 0.3));
  EXPECT_NEAR(volume_deeper_than(holed, 0) / (64 - 4.0 / 3.0 * pi - 1 - pi * 0.09 * 4), 1.0, near);
  EXPECT_NEAR(volume_deeper_than(cylinder(1, 40), 0) / (pi * 40), 1.0, near);
  Vessel slice = hollow_ball(10);  // from -0.487 to 0.513 of its height: the frame stays that of the ball
  slice.walls.push_back(half_space({0, 0, -0.487}, {0, 0, -1}));
  slice.walls.push_back(half_space({0, 0, 0.513}, {0, 0, 1}));
  const double exact = pi * (100.0 - (std::pow(0.487, 3) + std::pow(0.513, 3)) / 3.0);
  EXPECT_NEAR(volume_deeper_than(slice, 0) / exact, 1.0, 5 * near);
}

TEST(Vessel, TheLargestSphereThatFitsIsFound) {
  EXPECT_NEAR(largest_radius(box({1, 2, 3})), 0.5, 0.01);
  EXPECT_NEAR(largest_radius(cylinder(1.3, 4)), 1.3, 0.02);
  EXPECT_NEAR(largest_radius(periodic_cell({2, 0, 0}, {1, 3, 0}, {0.5, 0.4, 1})), 0.5 * std::sqrt(1.41),
              1e-12);
}

TEST(Vessel, WallsPushInwardsByTheGradientOfTheDepth) {
  Vessel v = box({4, 4, 4});
  v.walls = {half_space({1, 2, 3}, normalised(Vec3d{1, 2, 2})),
             ball({2, 2, 2}, 3, true),
             ball({2, 2, 2}, 0.5, false),
             tube({2, 2, 0}, {0, 0, 1}, 2),
             around_cylinder({2, 2, 1}, {2, 2, 3}, 0.7),
             around_box({1, 1, 1}, {3, 2, 2}),
             around_slab({2, 2, 2}, {0, 0.6, 0.8}, 0.2)};
  const double h = 1e-6;
  for (std::size_t w = 0; w < v.walls.size(); ++w)
    for (const Vec3d& r :
         {Vec3d{0.4, 0.7, 0.6}, Vec3d{3.1, 2.3, 3.4}, Vec3d{2.2, 3.3, 1.4}, Vec3d{2.9, 1.1, 2.6}}) {
      std::vector<Feel> feels;
      v.walls[w]->feel(r, 100.0, feels);
      ASSERT_EQ(feels.size(), 1u);
      EXPECT_EQ(feels[0].depth, v.walls[w]->depth(r));
      EXPECT_NEAR(norm(feels[0].inward), 1.0, 1e-12);
      for (int k = 0; k < 3; ++k) {
        Vec3d up = r, down = r;
        component(up, k) += h, component(down, k) -= h;
        EXPECT_NEAR((v.walls[w]->depth(up) - v.walls[w]->depth(down)) / (2 * h),
                    component(feels[0].inward, k), 1e-5)
            << "wall " << w;
      }
    }
}

}  // namespace
}  // namespace vbond::packing::vessel_test
