// What a break releases where the body moves on at constant loads: the work of all that acts is in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "periodic.hpp"
#include "validation/fracture_bodies.hpp"

namespace vbond {
namespace {

using testing::breakable;
using testing::fracture;
using testing::Specimen;
using testing::unbreakable;
using testing::walk;
using testing::Walked;

/// The first balance of a kind.
const testing::Seen& first(const Walked& w, PointKind kind) {
  return *std::find_if(w.seen.begin(), w.seen.end(), [kind](const auto& s) { return s.kind == kind; });
}

// Two rows of three particles that repeat along x, joined across, under a stress of 0.02 along x. A volume V
// F under the stress S does V S dF, with V of the start, whatever the strain.
TEST(ReleasedEnergy, HasTheWorkOfTheStressOfACell) {
  std::vector<Vec3d> r;
  for (const double y : {0.0, 1.0})
    for (const double x : {0.0, 1.0, 2.0}) r.push_back({x, y, 0});
  Specimen s = testing::periodic_body({Vec3d{3, 0, 0}, Vec3d{0, 2, 0}, Vec3d{0, 0, 1}}, r, 0.3);
  s.model.cell.periodic = {true, false, false};
  const BondStiffness<double> c{1.0, 0.5, 0.3, 0.3};
  testing::bond(s, 0, 1, breakable(c, 0.01));
  testing::bond(s, 1, 2, breakable(c, unbreakable));
  testing::bond(s, 3, 4, breakable(c, unbreakable));
  testing::bond(s, 4, 5, breakable(c, unbreakable));
  for (const std::size_t row : {0u, 3u})
    testing::bond_image(s, row + 2, row, {1, 0, 0}, breakable(c, unbreakable));
  for (const std::size_t k : {0u, 1u, 2u}) testing::bond(s, k, k + 3, breakable(c, unbreakable));
  StaticStage stage = testing::static_stage(StageKind::fracture, {});
  stage.cell.component[0] = testing::stressed(0.02);
  const Walked w = walk(s, stage);
  ASSERT_EQ(fracture(w).breaks.size(), 1u);
  const BrokenBond& b = fracture(w).breaks[0];
  const testing::Seen &before = first(w, PointKind::critical), &after = first(w, PointKind::broken);
  const double F = testing::cell_strain(s, before.state)[0], on = testing::cell_strain(s, after.state)[0] - F;
  const double work = 6.0 * 0.02 * before.load_factor * on;
  EXPECT_GT(on, 0.005);
  EXPECT_NEAR(b.work, before.energy + work, 1e-9 * b.work);
  EXPECT_NEAR(b.released, before.energy + work - after.energy, 1e-9 * b.work);
  EXPECT_GT(b.released, 0.4 * work);  // half of it, but for what is not linear
}

}  // namespace
}  // namespace vbond
