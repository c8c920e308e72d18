#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "rods.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

using testing::Dice;
using testing::Specimen;

Support grip(std::vector<ParticleId> particles, const Vec3d& velocity, const Vec3d& angular_velocity,
             std::optional<Vec3d> pivot = {}) {
  Support s;
  s.group = "grip";
  s.particles = std::move(particles);
  s.held = all_held;
  s.velocity = velocity;
  s.angular_velocity = angular_velocity;
  s.rigid = true;
  s.pivot = pivot;
  return s;
}

/// Unbonded particles of different masses anywhere within 2 of (5, 0, 0), turned anyhow.
Specimen scattered(std::size_t n) {
  Dice dice(7);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) r.push_back({dice(3, 7), dice(-2, 2), dice(-2, 2)});
  Specimen s = testing::particles_at(r);
  for (const ParticleId p : s.state.q.ids()) {
    s.state.q[p] = rotation_of({dice(-3, 3), dice(-3, 3), dice(-3, 3)});
    s.model.mass[p] = dice(0.5, 2.0);
    s.model.inertia[p] = dice(0.05, 0.1);
  }
  return s;
}

double turn_between(const Quatd& a, const Quatd& b) {
  return norm(rotation_vector(a * conjugate(b)));
}

// Ten turns about a pivot beside the particles, which moves: each is on its circle at every step, not on a
// tangent, and nothing adds up. The angle of 63 rad is known to 7e-15, at 5 from the pivot; the factor 3 is
// for the products of quaternions.
TEST(Grips, TurnTenTimesOnTheCircle) {
  Specimen s = scattered(300);  // three blocks
  const Vec3d pivot{1, 2, -0.5}, V{0.01, -0.02, 0.005}, axis = normalised(Vec3d{1, 2, 2});
  const double T = 100.0;
  const Vec3d W = (20.0 * M_PI / T) * axis;
  Stage stage = testing::plain_stage(0.05, T);
  stage.supports = {grip(s.model.groups[0].particles, V, W, pivot)};
  Simulation run(s.model, stage, s.state);
  for (int k = 1; k <= 2000; ++k) {
    run.step();
    if (k % 333 != 0 && k != 2000) continue;
    const double t = k * 0.05;
    const Quatd turn = rotation_of(t * W);
    const State& now = run.state();
    for (const ParticleId p : now.r.ids()) {
      const Vec3d arm = rotate(turn, s.state.r[p] - pivot), centre = pivot + t * V;
      ASSERT_LE(norm(now.r[p] - (centre + arm)), 3 * 7e-15 * 8) << k;
      ASSERT_LE(turn_between(now.q[p], turn * s.state.q[p]), 3 * 7e-15) << k;
      ASSERT_LE(norm(now.v[p] - (V + cross(W, arm))), 1e-13) << k;
      ASSERT_EQ(now.omega[p], W);
    }
  }
  const State& end = run.state();
  for (const ParticleId p : end.r.ids())  // where it began, but for the way of the pivot
    EXPECT_LE(norm(end.r[p] - s.state.r[p] - T * V), 3 * 7e-15 * 8);
  EXPECT_NEAR(run.grips().at(0).angle, 20.0 * M_PI, 1e-13);
}

// A factor that changes: the angle is the integral of the factor, exactly. Without a pivot the group turns
// about its middle, which stays where it is.
TEST(Grips, FollowTheirFactorAboutTheirMiddle) {
  Specimen s = scattered(9);
  Stage stage = testing::plain_stage(0.01, 8.0);
  stage.supports = {grip(s.model.groups[0].particles, {}, {0, 0, 0.5})};
  stage.supports[0].factor.points = {{1, 0}, {2, 2}, {3, 2}, {5, -1}, {6, 0}};
  Simulation run(s.model, stage, s.state);
  run.run();
  const double angle = 0.5 * (1.0 + 2.0 + 1.0 - 0.5);  // by trapezia
  Vec3d middle;
  for (const Vec3d& r : s.state.r) middle += r / 9.0;
  for (const ParticleId p : s.state.r.ids()) {
    const Vec3d arm = rotate(rotation_of({0, 0, angle}), s.state.r[p] - middle);
    EXPECT_LE(norm(run.state().r[p] - middle - arm), 1e-14);
    EXPECT_EQ(run.state().v[p], Vec3d{});
  }
}

double kinetic(const Model& m, const State& s) {
  double T = 0.0;
  for (const ParticleId p : s.r.ids())
    T += 0.5 * m.mass[p] * norm2(s.v[p]) + 0.5 * m.inertia[p] * norm2(s.omega[p]);
  return T;
}

// Brought up to speed and kept there: all that the grip does is in the kinetic energy, also half way round,
// where the velocities of all its particles have changed their direction.
TEST(Grips, WorkIsTheKineticEnergyTheyGive) {
  Specimen s = scattered(200);
  Stage stage = testing::plain_stage(0.02, 10.0);
  stage.supports = {grip(s.model.groups[0].particles, {0.1, 0, 0}, {0, 0.4, 0.3}, Vec3d{5, 1, 0})};
  stage.supports[0].factor.points = {{0, 0}, {4, 1}};
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < 500; ++k) {
    run.step();
    const double T = kinetic(s.model, run.state());
    ASSERT_NEAR(run.grips()[0].work.value(), T, 1e-12 * 60) << k;
    ASSERT_NEAR(run.books().work_supports, T, 1e-12 * 60) << k;
    ASSERT_LE(std::abs(run.balance_error()), 1e-12) << k;
  }
  EXPECT_GT(kinetic(s.model, run.state()), 10.0);
}

/// A bar of 2 x 2 x n particles along x, one apart, bonded along edges and across the faces.
Specimen bar(std::size_t n) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    for (const double y : {0.0, 1.0})
      for (const double z : {0.0, 1.0}) r.push_back({static_cast<double>(k), y, z});
  Specimen s = testing::particles_at(r);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm(r[j] - r[i]) < 1.5) testing::bond(s, i, j, testing::papers_bond());
  return s;
}
const std::vector<ParticleId> first_face{ParticleId{0}, ParticleId{1}, ParticleId{2}, ParticleId{3}};
std::vector<ParticleId> last_face(std::size_t n) {
  const std::size_t k = 4 * (n - 1);
  return {ParticleId{k}, ParticleId{k + 1}, ParticleId{k + 2}, ParticleId{k + 3}};
}

Stage twist(std::size_t n, double dt) {
  Stage stage = testing::plain_stage(dt, 40.0);
  stage.supports = {grip(first_face, {}, {}), grip(last_face(n), {0.002, 0, 0}, {0.05, 0, 0})};
  stage.supports[0].group = "fixed";
  stage.supports[1].factor.points = {{0, 0}, {5, 1}};
  return stage;
}

// The moment of the grip is what the bonds across the cut beside it ask for, about the pivot.
TEST(Grips, BearTheTorqueOfTheBonds) {
  const std::size_t n = 6;
  const Specimen s = bar(n);
  Simulation run(s.model, twist(n, 0.1), s.state);
  run.run();
  State cut = run.state();
  PerBond<Bond> across;
  for (const Bond& b : cut.bonds)
    if ((b.i.value >= 4 * (n - 1)) != (b.j.value >= 4 * (n - 1))) across.push_back(b);
  cut.bonds = across;
  Loads loads{PerParticle<Vec3d>(4 * n), PerParticle<Vec3d>(4 * n)};
  add_bond_loads(cut, loads);
  const double s_end = 37.5;  // integral of the factor
  const Vec3d pivot{5.0 + 0.002 * s_end, 0.5, 0.5};
  Vec3d F, M;
  for (const ParticleId p : last_face(n))
    F -= loads.F[p], M -= loads.M[p] + cross(cut.r[p] - pivot, loads.F[p]);
  const GripView g = run.grips().at(1);
  EXPECT_EQ(g.group, "grip");
  EXPECT_NEAR(g.angle, 0.05 * s_end, 1e-14);
  EXPECT_LE(norm(g.force - F), 1e-13);
  EXPECT_LE(norm(g.moment - M), 1e-13);
  EXPECT_GT(g.moment.x, 0.01);  // it resists
  const Reaction r = run.reaction(last_face(n));
  EXPECT_LE(norm(r.force - g.force), 1e-14);
  EXPECT_LE(norm(r.moment - cross(pivot, g.force) - g.moment), 1e-13);
}

// The books are of second order in the step, as those of other supports.
TEST(Grips, KeepTheBooksToTheOrderOfTheStep) {
  const std::size_t n = 6;
  const Specimen s = bar(n);
  const auto error = [&](double dt) {
    Simulation run(s.model, twist(n, dt), s.state);
    run.run();
    const double work = run.grips()[0].work.value() + run.grips()[1].work.value();
    EXPECT_NEAR(work, run.books().work_supports, 1e-14);
    return std::abs(run.balance_error());
  };
  const double coarse = error(0.1), fine = error(0.05);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);
}

// Interrupted and gone on with at any step, it moves the same to the last bit, grips and their work included.
TEST(Grips, GoOnFromAnyStepBitForBit) {
  const std::size_t n = 6;
  const Specimen s = bar(n);
  Simulation whole(s.model, twist(n, 0.1), s.state);
  whole.run();
  for (const std::int64_t steps : {1, 77, 399}) {
    Simulation first(s.model, twist(n, 0.1), s.state);
    first.run({}, steps);
    Simulation second(s.model, twist(n, 0.1), first.state());
    EXPECT_EQ(second.grips()[1].moment, first.grips()[1].moment);
    second.run();
    EXPECT_TRUE(second.state() == whole.state()) << steps;
  }
}

// A grip that is given another motion on the way goes on from where it is.
TEST(Grips, TakeHoldAnewWhenTheirMotionChanges) {
  Specimen s = scattered(5);
  Stage stage = testing::plain_stage(0.1, 10.0);
  stage.supports = {grip(s.model.groups[0].particles, {0.1, 0, 0}, {0, 0, 0.2}, Vec3d{5, 0, 0})};
  Simulation first(s.model, stage, s.state);
  first.run({}, 50);
  stage.supports[0].angular_velocity = {0.3, 0, 0};
  Simulation second(s.model, stage, first.state());
  second.run();
  const Vec3d pivot{5.5, 0, 0};  // there at t = 5
  for (const ParticleId p : s.state.r.ids()) {
    const Vec3d arm = rotate(rotation_of({1.5, 0, 0}), first.state().r[p] - pivot);
    EXPECT_LE(norm(second.state().r[p] - pivot - Vec3d{0.5, 0, 0} - arm), 1e-13);
  }
}

// Supports that agree: what two hold is one support's, in reaction, work and motion.
TEST(Supports, MayOverlapWhereTheyAgree) {
  const Specimen s = bar(4);
  Stage once = testing::plain_stage(0.1, 20.0);
  once.supports = {testing::held(first_face, testing::clamped),
                   testing::held(last_face(4), testing::translations, {0.01, 0, 0})};
  once.supports[1].factor.points = {{0, 0}, {5, 1}};
  Stage twice = once;
  twice.supports.push_back(once.supports[1]);
  twice.supports[2].held = {true, false, false, true, false, false};
  twice.supports[2].particles.pop_back();
  once.supports.push_back(twice.supports[2]);
  once.supports[2].held[0] = false;
  Simulation a(s.model, once, s.state), b(s.model, twice, s.state);
  a.run(), b.run();
  EXPECT_TRUE(a.state() == b.state());
  EXPECT_EQ(a.reaction(last_face(4)).force, b.reaction(last_face(4)).force);
  EXPECT_GT(std::abs(a.reaction(last_face(4)).force.x), 0.01);
}

// The same of grips: with one that agrees, and with a support at rest on one that rests.
TEST(Grips, MayOverlapWhereTheyAgree) {
  const std::size_t n = 4;
  const Specimen s = bar(n);
  Stage once = twist(n, 0.1), twice = once;
  twice.supports.push_back(once.supports[1]);
  twice.supports.push_back(testing::held({ParticleId{2}}, testing::translations));
  Simulation a(s.model, once, s.state), b(s.model, twice, s.state);
  a.run(), b.run();
  EXPECT_EQ(a.state().r, b.state().r);
  EXPECT_EQ(a.books(), b.books());
  EXPECT_EQ(a.reaction(first_face).moment, b.reaction(first_face).moment);
  EXPECT_EQ(a.reaction(last_face(n)).moment, b.reaction(last_face(n)).moment);
}

// A total force is shared by mass: particles apart from each other go together, as one body would.
TEST(TotalLoads, MoveAGroupAsOne) {
  Specimen s = scattered(8);
  double mass = 0.0;
  for (const double m : s.model.mass) mass += m;
  Stage stage = testing::plain_stage(0.1, 5.0);
  const Vec3d total{3, -1, 2}, torque{0, 0.5, 0.1};
  stage.loads = {{"all", s.model.groups[0].particles, {}, {}, {}, total / mass, torque / mass}};
  Simulation run(s.model, stage, s.state);
  run.run();
  Vec3d spin, applied;
  for (const ParticleId p : s.state.r.ids()) {
    EXPECT_LE(norm(run.state().v[p] - 5.0 * total / mass), 1e-14);
    spin += s.model.inertia[p] * run.state().omega[p];
    applied += run.loads().M[p];
  }
  EXPECT_LE(norm(spin - 5.0 * torque), 1e-13);
  EXPECT_LE(norm(applied - torque), 1e-15);
  EXPECT_LE(std::abs(run.balance_error()), 1e-13);
}

// As moments on its particles a total torque turns a bonded body: its angular momentum is torque times time.
TEST(TotalLoads, TorqueTurnsABondedBody) {
  Specimen s = bar(4);
  Stage stage = testing::plain_stage(0.1, 20.0);
  const Vec3d torque{0.02, 0.05, -0.01};
  stage.loads = {{"end", last_face(4), {}, {}, {}, {}, torque / 4.0}};
  Simulation run(s.model, stage, s.state);
  run.run();
  Vec3d L, P;
  for (const ParticleId p : s.state.r.ids()) {
    P += s.model.mass[p] * run.state().v[p];
    L += s.model.mass[p] * cross(run.state().r[p], run.state().v[p]) +
         s.model.inertia[p] * run.state().omega[p];
  }
  EXPECT_LE(norm(P), 1e-12);
  EXPECT_LE(norm(L - 20.0 * torque), 1e-11);
}

}  // namespace
}  // namespace vbond
