// Whether a body fills the box around it.
#include "vbond/model/filled_box.hpp"

#include <gtest/gtest.h>

#include "dynamics/rods.hpp"

namespace vbond::filled_box_test {
namespace {

using namespace testing;

std::optional<std::string> why(const std::vector<Vec3d>& r) {
  const Specimen s = particles_at(r, 0.5);
  BoundingBox box;
  std::vector<ParticleId> all;
  for (const ParticleId p : s.state.r.ids()) box.add(s.state.r[p], s.model.radius[p]), all.push_back(p);
  return why_box_not_filled(s.model, s.state, box, all);
}

/// n x n x n particles one apart.
std::vector<Vec3d> cube(int n) {
  std::vector<Vec3d> r;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) r.push_back({double(i), double(j), double(k)});
  return r;
}

TEST(FilledBox, IsThatOfACubeButNotOfABall) {
  EXPECT_FALSE(why(cube(8)).has_value());
  std::vector<Vec3d> ball;
  for (const Vec3d& x : cube(13))
    if (norm(x - Vec3d{6, 6, 6}) < 6.2) ball.push_back(x);
  const auto told = why(ball);
  ASSERT_TRUE(told.has_value());
  EXPECT_NE(told->find("its corner (-0.5, -0.5, -0.5)"), std::string::npos) << *told;
}

// One particle above a cube of 8: the layer that the box ends with has it alone, where some 50 would fill it.
TEST(FilledBox, IsNotOneThatEndsAtAParticleThatSticksOut) {
  std::vector<Vec3d> r = cube(8);
  r.push_back({3, 3, 8});
  const auto told = why(r);
  ASSERT_TRUE(told.has_value());
  EXPECT_NE(told->find("its face on the side of +z has 1 particles"), std::string::npos) << *told;
  EXPECT_NE(told->find("particle 512 among them"), std::string::npos) << *told;
}

}  // namespace
}  // namespace vbond::filled_box_test
