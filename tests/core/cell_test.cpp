#include "vbond/core/cell.hpp"

#include <gtest/gtest.h>

#include "vbond/core/dual.hpp"
#include "vbond/core/simd.hpp"

namespace vbond::cell_test {
namespace {

TEST(Between, LeadsFromTheFirstToTheSecond) {
  const Vec3d r_i{1.0, -2.0, 0.5}, r_j{4.0, 2.5, -1.0};
  EXPECT_EQ(between(r_i, r_j), (Vec3d{3.0, 4.5, -1.5}));
  const PerParticle<Vec3d> r{r_i, {}, r_j};
  EXPECT_EQ(between(r, ParticleId{0}, ParticleId{2}), (Vec3d{3.0, 4.5, -1.5}));
  EXPECT_EQ(between(r, ParticleId{2}, ParticleId{0}), (Vec3d{-3.0, -4.5, 1.5}));
}

TEST(Between, OfPacksIsThatOfEachLane) {
  using P = Pack<2>;
  P x_i, x_j;
  x_i.v[0] = 1.0, x_i.v[1] = 7.0, x_j.v[0] = 3.0, x_j.v[1] = 2.0;
  const P d = between(x_i, x_j);
  EXPECT_EQ(d.v[0], 2.0);
  EXPECT_EQ(d.v[1], -5.0);
  const Vec3<P> r_ij = between(Vec3<P>{x_i, x_i, x_i}, Vec3<P>{x_i, x_j, x_i});
  EXPECT_EQ(r_ij.y.v[1], -5.0);
  EXPECT_EQ(r_ij.z.v[0], 0.0);
}

TEST(Between, GrowsWithTheSecondPlaceAndFallsWithTheFirst) {
  using D = Dual<2>;
  const D d = between(D::variable(1.0, 0), D::variable(4.0, 1));
  EXPECT_EQ(d.value, 3.0);
  EXPECT_EQ(d.d[0], -1.0);
  EXPECT_EQ(d.d[1], 1.0);
}

}  // namespace
}  // namespace vbond::cell_test
