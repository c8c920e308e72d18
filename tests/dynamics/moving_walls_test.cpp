// Walls that are moved, turned or driven: where they are, and the work that they do.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "rods.hpp"
#include "spheres_and_walls.hpp"

namespace vbond::moving_walls_test {
namespace {

using testing::drive;
using testing::floor_at;
using testing::linear;
using testing::Specimen;
using testing::sphere;

constexpr ParticleId first{0};

// A wall that moves onto a sphere at rest: elastic, so the sphere leaves at twice the wall's speed, and the
// wall's work is the sphere's energy.
TEST(Wall, ThatMovesDoesWork) {
  Specimen s = sphere({0, 0, 0.5}, 0.45, 1.0, linear(1e3, 0.0), {floor_at(0)});
  Stage stage = testing::plain_stage(1e-4, 1.0);
  stage.walls = {drive("floor", 0)};
  stage.walls[0].velocity = {0, 0, 0.3};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_NEAR(run.state().v[first].z, 0.6, 1e-4);
  EXPECT_NEAR(run.walls()[0].work, 0.18, 1e-4);
  EXPECT_NEAR(run.walls()[0].displacement.z, 0.3, 1e-12);
  EXPECT_LT(std::abs(run.balance_error()), 1e-5);
}

TEST(Wall, ThatSwingsIsWhereItsSineIs) {
  Specimen s = sphere({0, 0, 5}, 0.1, 1.0, linear(1e3, 0.0), {floor_at(0)});
  Stage stage = testing::plain_stage(1e-2, 10.0);
  stage.walls = {drive("floor", 0)};
  stage.walls[0].amplitude = {0, 0, 0.1}, stage.walls[0].frequency = 30.0;
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < 700; ++k) {
    run.step();
    EXPECT_NEAR(run.walls()[0].displacement.z,
                0.1 * std::sin(2 * std::numbers::pi * 30.0 * run.clock().time()), 1e-12);
  }
}

// About its centre, which is not the origin, or about a pivot.
TEST(Wall, TurnsAboutItsCentreUnlessAPivotIsGiven) {
  Specimen s = sphere({0, 0, 5}, 0.1, 1.0, linear(1e3, 0.0), {floor_at(0)});
  s.model.walls[0].centre = {2, 1, 0};
  const Quatd half = rotation_of({0, 0, std::numbers::pi});
  for (const std::optional<Vec3d> pivot : {std::optional<Vec3d>{}, std::optional<Vec3d>{Vec3d{1, 1, 0}}}) {
    Stage stage = testing::plain_stage(1e-2, 1.0);
    stage.walls = {drive("floor", 0)};
    stage.walls[0].angular_velocity = {0, 0, std::numbers::pi}, stage.walls[0].pivot = pivot;
    Simulation run(s.model, stage, s.state);
    run.run();
    EXPECT_LE(norm(run.walls()[0].displacement - (pivot ? Vec3d{-2, 0, 0} : Vec3d{})), 1e-13);
    EXPECT_LE(norm(rotation_vector(run.walls()[0].q * conjugate(half))), 1e-13);
  }
}

/// Goes on with the next stage.
Simulation next(const Specimen& s, const Stage& stage, Simulation& before) {
  State state = before.state();
  begin_next_stage(state.clock);
  return {s.model, stage, state};
}

// However an earlier stage has moved it: without a pivot a wall turns about its own point and stays where it
// is.
TEST(Wall, ThatHasMovedTurnsAboutItsPointWhereItIs) {
  Specimen s = sphere({0, 0, 50}, 0.1, 1.0, linear(1e3, 0.0), {floor_at(0)});
  s.model.walls[0].centre = {2, 1, 0};
  for (const int by : {0, 1, 2}) {
    Stage moves = testing::plain_stage(1e-2, 1.0), turns = moves;
    moves.walls = turns.walls = {drive("floor", 0)};
    WallDrive& d = moves.walls[0];
    if (by == 0) d.velocity = {5, 0, 0};
    if (by == 1) d.amplitude = {0, 0.3, 0}, d.frequency = 0.25;
    if (by == 2) d.servo = WallDrive::Servo{{1, 0, 0}, 2.0, {}, 1.0, 0.0, 10.0};
    turns.walls[0].angular_velocity = {0, 0, std::numbers::pi};
    Simulation moved(s.model, moves, s.state);
    moved.run();
    const Vec3d at = moved.walls()[0].displacement;
    EXPECT_GT(norm(at), 0.29) << by;
    Simulation turned = next(s, turns, moved);
    turned.run();
    EXPECT_EQ(turned.walls()[0].displacement, at) << by;
    EXPECT_LE(norm(rotate(turned.walls()[0].q, Vec3d{1, 0, 0}) - Vec3d{-1, 0, 0}), 1e-13);
  }
}

// A free servo of mass 2 under a force of 1 goes F t^2/2M, in one stage or in two of other steps. Another
// direction begins from rest.
TEST(Wall, ThatAServoDrivesGoesOnInTheNextStage) {
  Specimen s = sphere({0, 0, 50}, 0.1, 1.0, linear(1e3, 0.0), {floor_at(0)});
  Stage stage = testing::plain_stage(1e-2, 1.0);
  stage.walls = {drive("floor", 0)};
  stage.walls[0].servo = WallDrive::Servo{{0, 0, -1}, 1.0, {}, 2.0, 0.0, 10.0};
  Stage finer = stage, back = stage, across = stage;
  finer.dt = 5e-3;
  back.walls[0].servo->direction = {0, 0, 1};
  across.walls[0].servo->direction = {1, 0, 0};
  const auto ends_at = [&](const Stage& second) {
    Simulation first(s.model, stage, s.state);
    first.run();
    Simulation run = next(s, second, first);
    run.run();
    return run.walls()[0].displacement;
  };
  EXPECT_LE(norm(ends_at(stage) - Vec3d{0, 0, -1.0}), 1e-13);
  EXPECT_LE(norm(ends_at(finer) - Vec3d{0, 0, -1.0}), 1e-13);
  // -1/4 - 1/2 + 1/4; the half step before the change is under the force after it
  EXPECT_LE(norm(ends_at(back) - Vec3d{0, 0, -0.5}), 0.5 * stage.dt + 1e-13);
  EXPECT_LE(norm(ends_at(across) - Vec3d{0.25, 0, -0.25}), 1e-13);
}

// So does one that moves, swings or is driven as it turns: its point goes as without the rotation.
TEST(Wall, ThatTurnsAboutItsPointGoesAsWithout) {
  Specimen s = sphere({0, 0, 50}, 0.1, 1.0, linear(1e3, 0.0), {floor_at(0)});
  s.model.walls[0].centre = {2, 1, 0};
  Stage stage = testing::plain_stage(1e-2, 10.0);
  stage.walls = {drive("floor", 0)};
  WallDrive& d = stage.walls[0];
  d.velocity = {0.5, 0, 0}, d.amplitude = {0, 0.1, 0}, d.frequency = 0.7;
  d.servo = WallDrive::Servo{{0, 0, 1}, 2.0, {}, 100.0, 1.0, 10.0};
  Simulation straight(s.model, stage, s.state);
  d.angular_velocity = {0.3, 0, 1.0};
  Simulation turning(s.model, stage, s.state);
  for (int k = 0; k < 900; ++k) {
    straight.step(), turning.step();
    EXPECT_EQ(turning.walls()[0].displacement, straight.walls()[0].displacement) << k;
    EXPECT_EQ(turning.walls()[0].velocity, straight.walls()[0].velocity) << k;
  }
}

// Its place is the circle about the pivot, which stays in space, plus the swing, from where another stage has
// left it; its velocity is the way of the step over its time. 1e-12: 800 steps of rounding.
TEST(Wall, ThatTurnsAboutAPivotAndSwingsIsWhereBothPutIt) {
  Specimen s = sphere({0, 0, 50}, 0.1, 1.0, linear(1e3, 0.0), {floor_at(0)});
  const Vec3d centre{2, 1, 0}, pivot{1, 1, 3}, A{0, 0.3, 0.1}, rate{0.4, 0, 1.0};
  s.model.walls[0].centre = centre;
  const double dt = 1e-2, f = 0.4;
  Stage first_swing = testing::plain_stage(dt, 1.0), stage = testing::plain_stage(dt, 10.0);
  first_swing.walls = stage.walls = {drive("floor", 0)};
  first_swing.walls[0].amplitude = {0.2, 0, 0}, first_swing.walls[0].frequency = 0.25;
  WallDrive& d = stage.walls[0];
  d.angular_velocity = rate, d.pivot = pivot, d.amplitude = A, d.frequency = f;
  Simulation swung(s.model, first_swing, s.state);
  swung.run();
  Vec3d before = swung.walls()[0].displacement;
  EXPECT_LE(norm(before - Vec3d{0.2, 0, 0}), 1e-14);
  const Vec3d arm = centre + before - pivot;
  Simulation whole = next(s, stage, swung);
  EXPECT_LE(norm(whole.walls()[0].velocity - cross(rate, arm) - 2.0 * std::numbers::pi * f * A), 1e-14);
  for (int k = 1; k <= 800; ++k) {
    Simulation resumed(s.model, stage, whole.state());
    whole.step(), resumed.step();
    EXPECT_EQ(whole.walls(), resumed.walls()) << k;
    const WallState& now = whole.walls()[0];
    const Vec3d place =
        pivot + rotate(rotation_of(k * dt * rate), arm) + std::sin(2.0 * std::numbers::pi * f * k * dt) * A;
    EXPECT_LE(norm(centre + now.displacement - place), 1e-12) << k;
    EXPECT_LE(norm(dt * now.velocity - (now.displacement - before)), 1e-14) << k;
    before = now.displacement;
  }
}

// A slanted plane that turns about a pivot and swings throws a ball. Its motion and work are the same
// whichever point of it is told, one far from the pivot or that at the pivot itself; work to second order in
// the step.
TEST(Wall, ThatTurnsAboutAPivotDoesTheSameWorkWhateverItsPoint) {
  const auto difference_with = [](double dt) {
    const double slant = std::sqrt(0.5);
    const Wall blade{"blade", PlaneWall{{3, 0, 0}, {slant, slant, 0}}, 0, {3, 0, 0}};
    Specimen s = sphere({3.4, 0.4, 0}, 0.5, 1.0, linear(1e3, 0.0), {blade});
    Stage stage = testing::plain_stage(dt, 1.0);
    stage.walls = {drive("blade", 0)};
    WallDrive& d = stage.walls[0];
    d.angular_velocity = {0, 0, 1.0}, d.pivot = Vec3d{0, 0, 0}, d.amplitude = {0.1, 0, 0}, d.frequency = 1.0;
    Simulation far(s.model, stage, s.state);
    far.run();
    Specimen same = s;
    same.model.walls[0].centre = *d.pivot, d.pivot.reset();
    Simulation near(same.model, stage, same.state);
    near.run();
    EXPECT_LE(norm(far.state().r[first] - near.state().r[first]), 1e-11);
    EXPECT_GT(near.walls()[0].work, 5.0);
    EXPECT_LT(std::abs(near.balance_error()), 1e-3);
    EXPECT_LT(std::abs(far.balance_error()), 1e-3);
    return std::abs(far.walls()[0].work - near.walls()[0].work);
  };
  const double coarse = difference_with(2e-3), fine = difference_with(5e-4);
  EXPECT_NEAR(coarse / fine, 16.0, 0.5) << coarse;
}

// A disc that turns under a sphere held in place drags it round: its torque is mu F r, and the work goes into
// slip.
TEST(Wall, ThatTurnsRubs) {
  const double k = 1e4, press = 1e-3, mu = 0.2, arm = 0.3, omega = 2.0;
  Specimen s = sphere({arm, 0, 0.1 - press}, 0.1, 1.0, linear(k, mu), {floor_at(0)});
  Stage stage = testing::plain_stage(1e-4, 1.0);
  stage.supports = {testing::held({first}, testing::clamped)};
  stage.walls = {drive("floor", 0)};
  stage.walls[0].angular_velocity = {0, 0, omega};
  Simulation run(s.model, stage, s.state);
  run.run();
  const double F = mu * k * press;
  EXPECT_NEAR(run.walls()[0].moment.z, -F * arm,
              1e-5 * F * arm);  // the spring turns with the wall, to first order
  EXPECT_NEAR(run.walls()[0].work, F * arm * omega, 2e-2 * F * arm * omega);  // the spring is loaded first
  EXPECT_NEAR(run.books().dissipated, run.walls()[0].work, 2e-2 * F * arm * omega);
  EXPECT_LT(std::abs(run.balance_error()), 1e-4);
}

// A servo presses a sphere against the floor: it comes to rest where the force is the one aimed at.
TEST(Wall, ServoHoldsItsForce) {
  const double k = 1e3, aim = 2.0;
  Specimen s = sphere({0, 0, 0.5}, 0.5, 1.0, linear(k, 0.0, 0.3),
                      {floor_at(0), {"top", PlaneWall{{0, 0, 1.0}, {0, 0, -1}}, 0, {}}});
  Stage stage = testing::plain_stage(2e-4, 6.0);
  stage.walls = {drive("top", 1)};
  stage.walls[0].servo = WallDrive::Servo{{0, 0, -1}, aim, {}, 1.0, 20.0, 10.0};
  stage.b_translation = 2.0;
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_NEAR(run.walls()[1].force.z, aim, 1e-6);
  EXPECT_NEAR(run.walls()[0].force.z, -aim, 1e-6);
  EXPECT_NEAR(run.walls()[1].displacement.z, -2.0 * aim / k, 1e-8);
  EXPECT_LT(std::abs(run.balance_error()), 1e-4);
}

}  // namespace
}  // namespace vbond::moving_walls_test
