// Grips that are free in some degrees of freedom: loads on their particles move them as one rigid body.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "clouds.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond::free_grips_test {
namespace {

using testing::cloud;
using testing::Dice;
using testing::grip;
using testing::mass_of;
using testing::Specimen;

constexpr HeldDofs nothing{}, all_but_z{true, true, false, true, true, true};

PointLoad load_on(const Specimen& s, const Vec3d& total_force) {
  PointLoad l{"load", s.model.groups[0].particles, {}, {}, {}};
  double mass = 0.0;
  for (const double m : s.model.mass) mass += m;
  l.force_by_mass = total_force / mass;
  return l;
}
// A force on a plate that may move along z only: F/M, whatever pushes where. Its other components go into the
// support, which does no work.
TEST(FreeGrip, ForceAcceleratesItAlongWhatIsFree) {
  Specimen s = cloud(300);
  Stage stage = testing::plain_stage(0.05, 4.0);
  stage.supports = {grip(s.model.groups[0].particles, all_but_z)};
  stage.loads = {load_on(s, {3, -2, 5}), {"one", {ParticleId{17}}, {0, 0, 1}, {0.5, 0, 0}, {}}};
  Simulation run(s.model, stage, s.state);
  run.run();
  const double M = mass_of(s), v = 6.0 / M * 4.0;
  for (const ParticleId p : s.state.r.ids()) {
    ASSERT_LE(norm(run.state().v[p] - Vec3d{0, 0, v}), 1e-13);
    ASSERT_LE(norm(run.state().r[p] - s.state.r[p] - Vec3d{0, 0, 0.5 * v * 4.0}), 1e-13);
    ASSERT_LE(norm(rotation_vector(run.state().q[p] * conjugate(s.state.q[p]))), 1e-15);
  }
  EXPECT_NEAR(run.books().work_loads, 0.5 * M * v * v, 1e-12);
  EXPECT_NEAR(run.books().work_supports, 0.0, 1e-12);
  const GripView view = run.grips().at(0);
  EXPECT_LE(norm(view.force - Vec3d{-3, 2, 0}), 1e-12);
  EXPECT_LE(norm(run.reaction(s.model.groups[0].particles).force - Vec3d{-3, 2, 0}), 1e-12);
  EXPECT_NEAR(view.work.value(), 0.0, 1e-12);
}

// Free altogether it is a rigid body: it turns as a single particle of its mass and its tensor of inertia
// does.
TEST(FreeGrip, TurnsAsATopOfItsInertia) {
  Specimen s = cloud(40);
  const double M = mass_of(s);
  Vec3d centre;
  for (const ParticleId p : s.model.mass.ids()) centre += s.model.mass[p] / M * s.state.r[p];
  const Vec3d w{0.5, -0.3, 0.8}, V{0.1, 0, 0};
  InertiaTensor I{};
  for (const ParticleId p : s.model.mass.ids()) {
    const Vec3d a = s.state.r[p] - centre;
    const double m = s.model.mass[p], own = s.model.inertia[p];
    I.xx += m * (a.y * a.y + a.z * a.z) + own, I.yy += m * (a.x * a.x + a.z * a.z) + own;
    I.zz += m * (a.x * a.x + a.y * a.y) + own;
    I.xy -= m * a.x * a.y, I.xz -= m * a.x * a.z, I.yz -= m * a.y * a.z;
    s.state.v[p] = V + cross(w, a), s.state.omega[p] = w;
  }
  Specimen top = testing::particles_at({centre});
  top.model.mass[ParticleId{0}] = M;
  make_top(top.model, ParticleId{0}, *principal_inertia(I));
  top.state.v[ParticleId{0}] = V, top.state.omega[ParticleId{0}] = w;
  Stage stage = testing::plain_stage(0.05, 20.0), alone = stage;
  stage.supports = {grip(s.model.groups[0].particles, nothing)};
  const Vec3d F{0.3, 0.2, -0.4};
  stage.loads = {load_on(s, F)};
  alone.loads = {load_on(top, F)};
  Simulation run(s.model, stage, s.state), reference(top.model, alone, top.state);
  run.run(), reference.run();
  const Quatd turn = reference.state().q[ParticleId{0}];
  const Vec3d now = reference.state().r[ParticleId{0}];
  EXPECT_GT(norm(rotation_vector(turn)), 0.5);
  for (const ParticleId p : s.state.r.ids()) {
    ASSERT_LE(norm(run.state().r[p] - now - rotate(turn, s.state.r[p] - centre)), 1e-11);
    ASSERT_LE(norm(rotation_vector(run.state().q[p] * conjugate(turn * s.state.q[p]))), 1e-11);
    const Vec3d w_now = reference.state().omega[ParticleId{0}];
    ASSERT_LE(
        norm(run.state().v[p] - reference.state().v[ParticleId{0}] - cross(w_now, run.state().r[p] - now)),
        1e-11);
  }
  EXPECT_NEAR(run.books().work_loads, reference.books().work_loads, 1e-11);
  EXPECT_NEAR(run.books().work_supports, 0.0, 1e-11);
  EXPECT_LT(std::abs(run.balance_error()), 1e-3);  // of the integrator of free tops
}

/// theta'' = -(M g l / I) sin theta by Runge and Kutta's rule in steps of 1e-4.
double pendulum(double theta, double k, double T) {
  double w = 0.0;
  const double h = 1e-4;
  for (int n = 0; n < static_cast<int>(std::round(T / h)); ++n) {
    const auto f = [k](double x) { return -k * std::sin(x); };
    const double a1 = w, b1 = f(theta), a2 = w + 0.5 * h * b1, b2 = f(theta + 0.5 * h * a1);
    const double a3 = w + 0.5 * h * b2, b3 = f(theta + 0.5 * h * a2), a4 = w + h * b3, b4 = f(theta + h * a3);
    theta += h / 6.0 * (a1 + 2 * a2 + 2 * a3 + a4), w += h / 6.0 * (b1 + 2 * b2 + 2 * b3 + b4);
  }
  return theta;
}

// About a hinge through a pivot: a physical pendulum, to second order in the step.
TEST(FreeGrip, SwingsAboutAHinge) {
  const std::size_t n = 5;
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) r.push_back({0, 0, -1.0 - static_cast<double>(k)});
  const double theta = 1.2, T = 6.0;
  double moment = 0.0, inertia = 0.0;
  for (const Vec3d& x : r) moment += -x.z, inertia += x.z * x.z + 0.064;
  const double exact = pendulum(theta, moment / inertia, T);
  double error[2];
  for (const int k : {0, 1}) {
    Specimen s = testing::particles_at(r);
    for (const ParticleId p : s.state.r.ids()) s.state.r[p] = rotate(rotation_of({0, -theta, 0}), r[p.value]);
    Stage stage = testing::plain_stage(k == 0 ? 0.04 : 0.02, T);
    stage.gravity = {0, 0, -1};
    stage.supports = {grip(s.model.groups[0].particles, {true, true, true, true, false, true})};
    stage.supports[0].pivot = Vec3d{};
    Simulation run(s.model, stage, s.state);
    run.run();
    const Vec3d end = run.state().r[ParticleId{n - 1}];
    error[k] = std::abs(std::atan2(end.x, -end.z) - exact);
    EXPECT_NEAR(norm(end), norm(r[n - 1]), 1e-12);
    EXPECT_NEAR(run.grips().at(0).angle, theta - exact, 2e-2);
    EXPECT_NEAR(run.books().work_supports, 0.0, 1e-11);
    EXPECT_LT(std::abs(run.balance_error()), k == 0 ? 1e-3 : 2.5e-4);
    // the pin carries the weight and the centripetal force; no moment about its axis
    EXPECT_NEAR(run.grips().at(0).moment.y, 0.0, 1e-12);
    const Reaction reaction = run.reaction(s.model.groups[0].particles);
    EXPECT_NEAR(reaction.moment.y, 0.0, 1e-12);
    EXPECT_NEAR(norm(reaction.force - run.grips().at(0).force), 0.0, 1e-12);
    EXPECT_GT(std::abs(run.reaction({ParticleId{4}}).moment.y), 0.1);  // what the others do to one of them
  }
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.3);
  EXPECT_LT(error[1], 2e-3);
}

// A state that is a rounding off where its grip stands belongs to it; one that somebody has moved does not.
TEST(FreeGrip, GoesOnFromPlacesThatAreRoundedOtherwise) {
  Specimen s = testing::particles_at({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  Stage stage = testing::plain_stage(0.02, 10.0);
  stage.supports = {grip(s.model.groups[0].particles, {true, true, true, true, true, false})};
  stage.supports[0].velocity = {0.1, 0.2, 0};
  for (const ParticleId p : s.state.r.ids()) s.state.omega[p] = {0, 0, 0.1};
  Simulation run(s.model, stage, s.state);
  while (run.clock().step < 250) run.step();
  const double half = run.grips().at(0).angle;
  EXPECT_GT(half, 0.04);
  for (const double off : {0.0, 1e-15, 1e-6}) {
    State now = run.state();
    for (Vec3d& r : now.r) r.x += off;
    Simulation then(s.model, stage, now);
    then.run();
    EXPECT_NEAR(then.grips().at(0).angle, off < 1e-12 ? 2.0 * half : half, 1e-12) << off;
  }
}

// A grip of one particle that holds its rotation moves as a support that does: also at the face of a cell,
// where loads come from images.
TEST(FreeGrip, OfOneParticleMovesAsASupportThroughFaces) {
  constexpr std::size_t n = 5;
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) r.push_back({static_cast<double>(k), 0, 0});
  Specimen s = testing::particles_at(r);
  s.model.cell.edges = {Vec3d{n, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  s.model.cell.periodic = {true, false, false};
  s.state = at_rest(s.model);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.1};
  for (std::size_t k = 0; k < n; ++k) {
    const Image image{k + 1 == n ? 1 : 0, 0, 0};
    s.state.bonds.push_back(*make_bond(recipe, bond_site(s.model, s.state, ParticleId{k}),
                                       bond_site(s.model, s.state, ParticleId{(k + 1) % n}, image)));
  }
  Dice dice(11);
  for (const ParticleId p : s.state.v.ids()) s.state.v[p] = dice.vector(0.05);
  Stage stage = testing::plain_stage(0.05, 20.0), held = stage;
  const HeldDofs turns{false, false, false, true, true, true};
  stage.supports = {grip({ParticleId{0}}, turns)};
  held.supports = stage.supports;
  held.supports[0].rigid = false;
  Simulation run(s.model, stage, s.state), reference(s.model, held, s.state);
  run.run(), reference.run();
  for (const ParticleId p : s.state.r.ids()) {
    ASSERT_LE(norm(run.state().r[p] - reference.state().r[p]), 1e-12);  // 400 steps of rounding
    ASSERT_LE(norm(run.state().v[p] - reference.state().v[p]), 1e-12);
  }
  EXPECT_GT(norm(reference.state().v[ParticleId{0}] - s.state.v[ParticleId{0}]), 0.01);
}

// A bundle of bonds between a plate that stands and one that a force pulls: it comes to rest where they carry
// the force, whatever their stiffnesses; the plate does not tilt.
TEST(FreeGrip, PulledPlateComesToRestUnderItsLoad) {
  std::vector<Vec3d> r;
  for (const double z : {0.0, 1.0})
    for (int k = 0; k < 4; ++k) r.push_back({static_cast<double>(k), 0.2 * k, z});
  Specimen s = testing::particles_at(r);
  double stiffness = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    BondRecipe recipe;
    const double c = 0.5 + 0.3 * static_cast<double>(k);
    recipe.parameters = BondStiffness<double>{c, 0.1, 0.05, 0.05};
    testing::bond(s, k, k + 4, recipe);
    stiffness += c;
  }
  Stage stage = testing::plain_stage(0.1, 400.0);
  stage.b_translation = 0.3;
  std::vector<ParticleId> upper, lower;
  for (std::size_t k = 0; k < 4; ++k) lower.push_back(ParticleId{k}), upper.push_back(ParticleId{k + 4});
  stage.supports = {grip(lower, all_held), grip(upper, all_but_z)};
  PointLoad pull{"load", upper, {0, 0, 0.05}, {}, {}};
  stage.loads = {pull};
  Simulation run(s.model, stage, s.state);
  run.run();
  for (const ParticleId p : upper)
    EXPECT_LE(norm(run.state().r[p] - s.state.r[p] - Vec3d{0, 0, 0.2 / stiffness}), 1e-12);
  EXPECT_NEAR(run.grips().at(0).force.z, -0.2, 1e-12);
  EXPECT_NEAR(run.grips().at(1).force.z, 0.0, 1e-12);
  // Kick, drift, kick keeps p^2/2M + (1 - (omega dt)^2/4) k x^2/2, and drag takes from p^2/2M: all of it, in
  // the end. What the load did and no energy is found for is the other part. To rounding.
  const double stored = 0.5 * sq(0.2) / stiffness, lost = 0.25 * stiffness / 4.0 * sq(stage.dt) * stored;
  EXPECT_NEAR(run.books().dissipated, stored - lost, 1e-14);
  EXPECT_NEAR(run.balance_error() * run.books().largest, -lost, 1e-14);
  EXPECT_NEAR(run.books().work_supports, 0.0, 1e-13);
}

// Drag slows a grip as one body: exactly along a line, and what it takes is in the books.
TEST(FreeGrip, DragSlowsItAsOneBody) {
  Specimen s = cloud(20);
  for (Vec3d& v : s.state.v) v = {0.4, 0, -0.2};
  Stage stage = testing::plain_stage(0.1, 10.0);
  stage.b_translation = 0.05, stage.b_rotation = 0.01;
  stage.supports = {grip(s.model.groups[0].particles, {false, true, true, true, true, true})};
  Simulation run(s.model, stage, s.state);
  const double M = mass_of(s);
  run.run();
  const double v = 0.4 * std::exp(-20 * 0.05 / M * 10.0);
  EXPECT_NEAR(run.state().v[ParticleId{3}].x, v, 1e-14);
  EXPECT_NEAR(run.state().v[ParticleId{3}].z, 0.0, 1e-16);
  EXPECT_NEAR(run.books().dissipated, 0.5 * M * (0.16 - v * v), 1e-12);
  EXPECT_NEAR(run.books().work_supports, -0.5 * M * 0.04, 1e-12);  // as it took hold: z is held
}

// Random bodies with a grip that is free in part: balance of energy to second order, as both runs are looked
// at after the same times, the same bits with any number of threads, and from a state in the middle of the
// run. Of 300 bodies the largest error is 2.4e-4 of the energy, and the ratio within 1e-3 of a quarter.
TEST(FreeGrip, BooksCloseAndRunsGoOn) {
  testing::campaign("grips free in part", 10, [](unsigned seed) {
    Dice dice(seed);
    Specimen s = testing::random_body(dice);
    for (Vec3d& v : s.state.v) v = dice.vector(0.05);
    for (Vec3d& w : s.state.omega) w = dice.vector(0.05);
    const std::size_t n = s.model.particles();
    HeldDofs held = testing::some_dofs(dice, 0.5);
    const double turns = dice(0, 3);
    for (std::size_t k = 3; k < 6; ++k) held[k] = turns < 1 ? false : turns < 2 ? k != 4 : true;
    Stage stage = testing::plain_stage(0.04, 8.0);
    stage.supports = {testing::held({ParticleId{0}}, testing::clamped),
                      grip({ParticleId{n - 3}, ParticleId{n - 2}, ParticleId{n - 1}}, held)};
    for (int k = 0; k < 3; ++k)
      if (held[static_cast<std::size_t>(k)]) component(stage.supports[1].velocity, k) = dice(-0.03, 0.03);
    stage.supports[1].factor.points = {{0, 0}, {3, 1}, {8, -1}};
    if (dice(0, 1) < 0.5) stage.b_translation = 0.05, stage.b_rotation = 0.005;
    stage.loads = {{"load", {ParticleId{n - 1}}, dice.vector(0.02), dice.vector(0.01), {}}};
    double error[2];
    for (const int k : {0, 1}) {
      stage.dt = k == 0 ? 0.04 : 0.02;
      Simulation run(s.model, stage, s.state);
      error[k] = 0.0;
      for (int look = 0; look < 20; ++look) {
        for (int step = 0; step < (k == 0 ? 10 : 20); ++step) run.step();
        error[k] = std::max(error[k], std::abs(run.balance_error()));
      }
    }
    EXPECT_LT(error[1], 6e-4);
    EXPECT_NEAR(error[1] / error[0], 0.25, 0.01);

    Simulation whole(s.model, stage, s.state, 1), threads(s.model, stage, s.state, 3);
    whole.run(), threads.run();
    EXPECT_EQ(whole.state(), threads.state());
    Simulation first(s.model, stage, s.state);
    for (int step = 0; step < 151; ++step) first.step();
    Simulation rest(s.model, stage, first.state());
    rest.run();
    EXPECT_EQ(rest.state(), whole.state());
  });
}

// What no motion is known for is refused.
TEST(FreeGrip, MistakesAreNamed) {
  Specimen s = cloud(3);
  const auto refusal = [&s](const Support& support) {
    Stage stage = testing::plain_stage(0.1, 1.0);
    stage.supports = {support};
    try {
      Simulation run(s.model, stage, s.state);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  Support g = grip(s.model.groups[0].particles, all_but_z);
  EXPECT_EQ(refusal(g), "");
  g.velocity = {0, 0, 1};
  EXPECT_NE(refusal(g).find("moves along or about what it leaves free"), std::string::npos);
  g.velocity = {1, 0, 0};
  EXPECT_EQ(refusal(g), "");
  g.pivot = Vec3d{};
  EXPECT_NE(refusal(g).find("pivot"), std::string::npos);
  g = grip(s.model.groups[0].particles, {true, true, true, true, false, false});
  EXPECT_NE(refusal(g).find("holds one turn"), std::string::npos);
}

// What a face of the cell cuts has arms as long as the cell: it may go along, and not turn.
TEST(FreeGrip, DoesNotTurnWhatBondsJoinThroughAFace) {
  const auto refusal = [](double x, const Support& support, std::int64_t stage_step) -> std::string {
    Specimen s = testing::particles_at({{1, 0, 0}, {x, 0, 0}});
    s.model.cell.edges = {Vec3d{6, 0, 0}, {0, 6, 0}, {0, 0, 6}};
    s.model.cell.periodic = {true, true, true};
    s.state = at_rest(s.model);
    const Image image{x > 3.0 ? -1 : 0, 0, 0};
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.1};
    s.state.bonds.push_back(*make_bond(recipe, bond_site(s.model, s.state, ParticleId{0}),
                                       bond_site(s.model, s.state, ParticleId{1}, image)));
    s.state.clock.stage_step = stage_step;
    Stage stage = testing::plain_stage(0.05, 1.0);
    stage.supports = {support};
    try {
      Simulation(s.model, stage, s.state);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  const std::vector<ParticleId> both = {ParticleId{0}, ParticleId{1}};
  Support turning = grip(both, all_held);
  turning.angular_velocity = {0, 0, 1};
  for (const Support& s : {grip(both, nothing), turning}) {
    EXPECT_EQ(refusal(2.0, s, 0), "");
    EXPECT_NE(refusal(6.0, s, 0).find("joins its particles 0 and 1 through a face of the cell"),
              std::string::npos);
    EXPECT_EQ(refusal(6.0, s, 1), "");  // goes on: the stage had such a body, or has bonded it since
  }
  for (const Support& s : {grip(both, all_but_z), grip(both, all_held)}) EXPECT_EQ(refusal(6.0, s, 0), "");
}

}  // namespace
}  // namespace vbond::free_grips_test
