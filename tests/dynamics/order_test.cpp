#include "vbond/dynamics/order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace vbond {
namespace {

/// 7 x 5 x 3 points at a spacing of 1.3, longest along y and shortest along x: by layers along y, then z,
/// then x. They fill their box at a mean spacing of 1.0, so that no two layers fall into one.
std::vector<Vec3d> layered(const Vec3d& corner) {
  std::vector<Vec3d> r;
  for (int y = 0; y < 7; ++y)
    for (int z = 0; z < 5; ++z)
      for (int x = 0; x < 3; ++x) r.push_back(corner + 1.3 * Vec3d{1.0 * x, 1.0 * y, 1.0 * z});
  return r;
}

TEST(SpatialOrder, IsByLayersWhereverTheBodyLies) {
  std::vector<std::size_t> shuffled(7 * 5 * 3);
  std::iota(shuffled.begin(), shuffled.end(), std::size_t{0});
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(1));
  for (const Vec3d& corner : {Vec3d{0, 0, 0}, Vec3d{-0.5, -0.5, -0.5}, Vec3d{-3.9, 40.0, -200.0}}) {
    const std::vector<Vec3d> r = layered(corner);
    PerParticle<Vec3d> mixed;
    for (const std::size_t k : shuffled) mixed.push_back(r[k]);
    const Order order = spatial_order(mixed);
    ASSERT_EQ(order.particle.size(), r.size());
    for (std::size_t k = 0; k < r.size(); ++k) {
      const ParticleId p = order.particle[Row{k}];
      EXPECT_EQ(mixed[p], r[k]) << "row " << k << ", corner " << corner.x;
      EXPECT_EQ(order.row[p], Row{k});
    }
  }
}

// Of a part: own particles, those among them that are ghosts elsewhere, own ghosts, all others, each in the
// order of the whole.
TEST(Order, OfAPartHasOwnParticlesFirstAndThenItsGhosts) {
  PerParticle<Vec3d> r;
  for (const double x : {4.0, 0.0, 3.0, 1.0, 2.0}) r.push_back({x, 0, 0});
  const Order whole = spatial_order(r);  // 1, 3, 4, 2, 0
  const ParticleId sent{4};
  const Order part = part_of(whole, {{ParticleId{2}, sent}, {sent}, {{ParticleId{3}, {}}}});
  EXPECT_EQ(part.particle.values(),
            (std::vector{ParticleId{2}, sent, ParticleId{3}, ParticleId{1}, ParticleId{0}}));
  for (const ParticleId p : r.ids()) EXPECT_EQ(part.particle[part.row[p]], p);
  EXPECT_TRUE(part.is_early(0));
  EXPECT_EQ(part.own, 2u);
  EXPECT_EQ(part.known, 3u);
  EXPECT_TRUE(part.has(ParticleId{4}) && part.knows(ParticleId{3}));
  EXPECT_FALSE(part.has(ParticleId{3}) || part.knows(ParticleId{1}));
  // the pair of its smaller number, and a ghost's alone
  EXPECT_TRUE(is_worked_out_here(part, part.row[ParticleId{2}], part.row[ParticleId{3}]));
  EXPECT_FALSE(is_worked_out_here(part, part.row[ParticleId{3}], part.row[ParticleId{4}]));
}

// A part has no rows for particles that it does not know: they share one.
TEST(Order, OfAPartMayHaveOneRowForAllOthers) {
  PerParticle<Vec3d> r;
  for (const double x : {4.0, 0.0, 3.0, 1.0, 2.0}) r.push_back({x, 0, 0});
  const Order whole = spatial_order(r);
  const Holding holding{
      .own = {ParticleId{2}}, .early = {}, .ghosts = {{ParticleId{3}, {}}}, .others_in_one_row = true};
  const Order part = part_of(whole, holding);
  EXPECT_EQ(part.known, 2u);
  EXPECT_EQ(part.particle.size(), 3u);
  for (const std::size_t p : {0, 1, 4}) {
    EXPECT_EQ(part.row[ParticleId{p}], Row{2}) << p;
    EXPECT_FALSE(part.knows(ParticleId{p})) << p;
  }
  EXPECT_EQ(part.particle[part.row[ParticleId{2}]], ParticleId{2});
  EXPECT_EQ(part.particle[part.row[ParticleId{3}]], ParticleId{3});
}

}  // namespace
}  // namespace vbond
