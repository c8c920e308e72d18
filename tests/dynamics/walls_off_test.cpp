// Walls that a stage takes away, and that are there again in the next one.
#include <gtest/gtest.h>

#include <cmath>

#include "spheres_and_walls.hpp"
#include "vbond/dynamics/simulation.hpp"

namespace vbond::walls_off_test {
namespace {

using testing::drive;
using testing::floor_at;
using testing::Specimen;
using testing::sphere;

constexpr ParticleId first{0};
constexpr double overlap = 0.02, k = 50.0;

/// A ball pressed between the floor and a lid, both by the overlap; weightless.
Specimen pressed(const ContactModel& contact) {
  std::vector<Wall> walls{floor_at(-0.5 + overlap),
                          {"lid", PlaneWall{{0, 0, 0.5 - overlap}, {0, 0, -1}}, 0, {}}};
  return sphere({0, 0, 0}, 0.5, 1.0, contact, walls);
}
Stage stage_of(double dt, bool lid_off) {
  Stage s = testing::plain_stage(dt, 1e9);
  if (lid_off) s.walls = {drive("lid", 1)}, s.walls[0].off = true;
  return s;
}

// The ball leaves the floor with the energy of one contact: that of the other went with the lid, and the
// balance says so.
TEST(WallOff, TakesTheEnergyOfItsTouchesAlong) {
  const double stored = 0.5 * k * overlap * overlap, dt = 1e-3;
  const Specimen body = pressed(testing::linear(k, 0.0));
  Simulation closed(body.model, stage_of(dt, false), body.state);
  for (int n = 0; n < 10; ++n) closed.step();
  EXPECT_NEAR(closed.energies().contact, 2.0 * stored, 1e-15);

  State state = closed.state();
  state.clock.stage = 1, state.clock.stage_step = 0;
  Simulation open(body.model, stage_of(dt, true), state);
  EXPECT_NEAR(open.energies().contact, stored, 1e-15);
  EXPECT_EQ(open.walls()[1].force, (Vec3d{0, 0, 0}));
  for (int n = 0; n < 2000; ++n) open.step();
  EXPECT_NEAR(open.state().v[first].z, std::sqrt(2.0 * stored), 1e-5);  // second order in omega dt = 7e-3
  EXPECT_NEAR(open.state().books.work_supports, -stored, 1e-15);
  EXPECT_NEAR(open.walls()[1].work, -stored, 1e-15);
  EXPECT_LT(std::abs(open.balance_error()), 1e-5);
}

// Where the lid comes back the ball overlaps it: what that stores is work done on the ball.
TEST(WallOff, ComesBackWithWhatItsTouchesStore) {
  const Specimen body = pressed(testing::linear(k, 0.0));
  State state = body.state;
  Simulation open(body.model, stage_of(1e-3, true), state);
  EXPECT_NEAR(open.energies().contact, 0.5 * k * overlap * overlap, 1e-15);
  EXPECT_EQ(open.walls()[1].work, 0.0);  // it has never been there
  for (int n = 0; n < 20; ++n) open.step();
  State after = open.state();
  const double before = after.books.work_supports, deeper = overlap + after.r[first].z;
  after.clock.stage = 1, after.clock.stage_step = 0;
  Simulation closed(body.model, stage_of(1e-3, false), after);
  EXPECT_NEAR(closed.state().books.work_supports - before, 0.5 * k * deeper * deeper, 1e-15);
  for (int n = 0; n < 500; ++n) closed.step();
  EXPECT_LT(std::abs(closed.balance_error()), 1e-5);
}

// Gone on from the middle of the stage, to the same bits.
TEST(WallOff, StaysOffWhereARunGoesOn) {
  const Specimen body = pressed(testing::linear(k, 0.0));
  Simulation whole(body.model, stage_of(1e-3, true), body.state);
  for (int n = 0; n < 50; ++n) whole.step();
  Simulation rest(body.model, stage_of(1e-3, true), whole.state());
  for (int n = 0; n < 50; ++n) whole.step(), rest.step();
  EXPECT_EQ(whole.state().r[first], rest.state().r[first]);
  EXPECT_EQ(whole.state().walls, rest.state().walls);
}

}  // namespace
}  // namespace vbond::walls_off_test
