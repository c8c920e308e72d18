// Walls at rest: what they do to a body, and how it comes to balance between them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bodies.hpp"
#include "dynamics/spheres_and_walls.hpp"
#include "meshes.hpp"
#include "vbond/core/error.hpp"
#include "vbond/physics/laws.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/statics.hpp"
#include "vbond/terms/walls/detail/rest_walls.hpp"

namespace vbond::walls_test {
namespace {

using testing::Specimen;

constexpr double endless = std::numeric_limits<double>::infinity();

ContactModel contact_of(ContactLaw law) {
  ContactModel c{.law = law, .pairs = ContactPairs::all, .c_H = 2.0, .length = 1.5, .E = 3.0, .nu = 0.3};
  c.k = 1.7;
  return c;
}

Wall wall(const WallShape& shape, const Vec3d& centre = {}) {
  return {"w", shape, 0, centre};
}
Wall plane(const Vec3d& point, const Vec3d& normal) {
  return {"plane", PlaneWall{point, normalised(normal)}, 0, point};
}

struct KindOfWall {
  std::string name;
  WallShape shape;
  Vec3d r;  // a sphere of radius 0.5 touches it here
};

MeshWall box() {
  MeshWall w;
  for (int k = 0; k < 8; ++k)
    w.mesh.corners.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
  w.mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return w;
}

std::vector<KindOfWall> kinds_of_walls() {
  const Vec3d n = normalised(Vec3d{1, 2, 3}), z{0, 0, 1};
  return {{"plane", PlaneWall{{}, n}, 0.4 * n},
          {"face of a disc", DiscWall{{}, z, 2.0}, {0.3, 0.2, 0.4}},
          {"axis of a disc", DiscWall{{}, z, 2.0}, {0, 0, 0.4}},
          {"back of a disc", DiscWall{{}, z, 2.0}, {0.3, 0.2, -0.4}},
          {"rim of a disc", DiscWall{{}, z, 2.0}, {2.3, 0.2, 0.2}},
          {"inside an endless cylinder", CylinderWall{{}, z, 2.0, endless, WallSide::inside}, {1.6, 0.2, 1}},
          {"outside an endless cylinder", CylinderWall{{}, n, 2.0, endless, WallSide::outside},
           2.3 * normalised(cross(n, z)) + 0.7 * n},
          {"inside a tube", CylinderWall{{}, z, 2.0, 3.0}, {1.6, 0.2, 1}},
          {"outside a tube", CylinderWall{{}, z, 2.0, 3.0}, {2.3, 0.2, 1}},
          {"rim of a tube", CylinderWall{{}, z, 2.0, 3.0}, {1.9, 0.2, 1.8}},
          {"inside a sphere", SphereWall{{}, 2.0, WallSide::inside}, {1, 1, 0.8}},
          {"outside a sphere", SphereWall{{}, 1.0, WallSide::outside}, {0.8, 0.8, 0.7}},
          {"face of a box", box(), {0.2, 0.3, 1.4}},
          {"edge of a box", box(), {1.25, 0.2, 1.3}},
          {"corner of a box", box(), {1.2, 1.25, 1.2}},
          {"corner of a box from inside", box(), {0.6, 0.65, 0.62}},
          {"mesh", MeshWall{testing::plate(7, 2.0)}, {0.31, 0.23, 0.4}}};
}

// h = 1e-5: rounding makes 1e-16 / h = 1e-11; truncation h^2 / 6 times third derivatives, which of d^(3/2) at
// d = 0.06 and more are below 30: 1e-9.
constexpr double h = 1e-5, tolerance = 3e-9;

class WallKinds : public ::testing::TestWithParam<ContactLaw> {};
INSTANTIATE_TEST_SUITE_P(Laws, WallKinds,
                         ::testing::Values(ContactLaw::hertz, ContactLaw::paper_hertz, ContactLaw::linear));

// The wall has moved and turned when it is looked at, by little enough that it is still touched.
TEST_P(WallKinds, HaveTheGradientOfTheirEnergyAndItsDerivatives) {
  for (const KindOfWall& kind : kinds_of_walls()) {
    const Specimen s = testing::sphere(kind.r, 0.5, 1.0, contact_of(GetParam()), {wall(kind.shape)});
    StaticStage stage = testing::static_stage(StageKind::equilibrium, {});
    stage.walls = {{"w", 0, {0.03, -0.02, 0.04}, {0.05, 0.03, -0.04}, Vec3d{0.1, 0.2, -0.1}}};
    StaticBody body(s.model, stage, s.state);
    const int n = body.unknowns().size();
    const double f = 0.7;
    body.move(Vector::Zero(n), f);
    const Placement here = body.placement();
    const Vector g = body.unbalanced();
    const DenseMatrix K = body.tangent();
    const Vector direction = body.load_direction();
    const double energy = body.energies().contact, power = body.terms().of<RestWalls>().power()[0];
    EXPECT_GT(energy, 1e-4) << kind.name;
    EXPECT_GT(norm(Vec3d{g[0], g[1], g[2]}), 0.01) << kind.name;
    const auto at = [&](int k, double x) {
      body.restore(here);
      body.move(x * Vector::Unit(n, k), f);
    };
    for (int k = 0; k < n; ++k) {
      at(k, h);
      const Vector up = body.unbalanced();
      const double U_up = body.energies().contact;
      at(k, -h);
      EXPECT_NEAR((U_up - body.energies().contact) / (2 * h), -g[k], tolerance) << kind.name << ' ' << k;
      const Vector slope = (body.unbalanced() - up) / (2 * h);
      EXPECT_LE((slope - K.col(k)).cwiseAbs().maxCoeff(), tolerance) << kind.name << ' ' << k;
    }
    body.restore(here);
    body.move(Vector::Zero(n), f + h);
    const Vector later = body.unbalanced();
    const double U_later = body.energies().contact;
    body.move(Vector::Zero(n), f - h);
    EXPECT_LE(((later - body.unbalanced()) / (2 * h) - direction).cwiseAbs().maxCoeff(), tolerance)
        << kind.name;
    EXPECT_NEAR((U_later - body.energies().contact) / (2 * h), power, tolerance) << kind.name;
  }
}

// Supports that move carry their particles along walls: what that does to the free unknowns.
TEST_P(WallKinds, KnowWhatHeldParticlesDoThatMove) {
  const KindOfWall kind = kinds_of_walls().at(10);  // inside a sphere
  const Specimen s = testing::sphere(kind.r, 0.5, 1.0, contact_of(GetParam()), {wall(kind.shape)});
  const StaticStage stage = testing::static_stage(
      StageKind::equilibrium,
      {testing::fixed({ParticleId{0}}, {true, false, false, false, false, false}, {0.1, 0, 0})});
  StaticBody body(s.model, stage, s.state);
  const Vector direction = body.load_direction();
  const auto at = [&](double f) {
    body.move(Vector::Zero(body.unknowns().size()), f);
    return Vector(body.unbalanced());
  };
  const Vector slope = (at(h) - at(-h)) / (2 * h);
  EXPECT_LE((slope - direction).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_GT(slope.cwiseAbs().maxCoeff(), 0.01);
}

// ---- exact answers ----------------------------------------------------------------------------------

constexpr HeldDofs only_x_free{false, true, true, true, true, true};
constexpr HeldDofs no_spin{false, false, false, true, true, true};

/// What a hook is told: walls and energies, point by point.
struct Seen {
  std::vector<std::vector<WallState>> walls;
  std::vector<double> potential;
  StaticHooks hooks() {
    StaticHooks h;
    h.point = [this](const StaticPoint& p) {
      walls.push_back(p.state.walls);
      potential.push_back(p.energies.potential());
    };
    return h;
  }
  const WallState& last(std::size_t wall) const { return walls.back().at(wall); }
};

StaticStage pressed(const Specimen& s, HeldDofs held, std::vector<WallDrive> drives) {
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed(s.model.groups[0].particles, held)});
  stage.walls = std::move(drives);
  stage.newton.tolerance = 1e-13;
  return stage;
}

// Each plane takes half of the way: F = k d/2, or 4/3 E* sqrt(R) (d/2)^(3/2) with E* of two equal bodies.
TEST_P(WallKinds, OnASphereBetweenTwoPlanesGiveTheExactForce) {
  const double R = 0.5, way = 0.1;
  const Specimen s = testing::sphere({R, 0, 0}, R, 1.0, contact_of(GetParam()),
                                     {plane({0, 0, 0}, {1, 0, 0}), plane({2 * R, 0, 0}, {-1, 0, 0})});
  StaticStage stage = pressed(s, only_x_free, {{"plane", 1, {-way, 0, 0}, {}}});
  stage.steps = 3;
  Seen seen;
  const StaticOutcome out = run_static_stage(s.model, stage, s.state, seen.hooks());
  const double d = way / 2, E = 3.0 / (2 * (1 - 0.09));
  const double F = GetParam() == ContactLaw::linear        ? 1.7 * d
                   : GetParam() == ContactLaw::paper_hertz ? 2.0 / std::sqrt(1.5) * std::pow(d, 1.5)
                                                           : 4.0 / 3.0 * E * std::sqrt(R) * std::pow(d, 1.5);
  EXPECT_NEAR(out.state.r[ParticleId{0}].x, R - d, 1e-14);
  EXPECT_NEAR(seen.last(1).force.x, F, 1e-12);
  EXPECT_NEAR(seen.last(0).force.x, -F, 1e-12);
  EXPECT_NEAR(seen.last(1).displacement.x, -way, 1e-16);
  EXPECT_EQ(out.result.unstable, 0);
  const double U = 2 * F * d / (GetParam() == ContactLaw::linear ? 2.0 : 2.5);
  EXPECT_NEAR(seen.potential.back(), U, 1e-12);
  EXPECT_NEAR(seen.last(1).work, U, 1e-9 * U);
  EXPECT_EQ(seen.last(0).work, 0.0);
}

// Bonds of stiffness c_A = 1 and two contacts in series.
TEST(WallsAtRest, PressABondedRodAsSpringsInSeries) {
  const std::size_t N = 6;
  Specimen s = testing::straight_rod(N);
  s.model.contact = testing::linear(1.7, 0.0);
  s.model.contact.tangential = TangentialForm::none;
  s.model.walls = {plane({-0.4, 0, 0}, {1, 0, 0}), plane({5.4, 0, 0}, {-1, 0, 0})};
  const double way = 0.01;
  StaticStage stage = pressed(s, only_x_free, {{"plane", 1, {-way, 0, 0}, {}}});
  Seen seen;
  const StaticOutcome out = run_static_stage(s.model, stage, s.state, seen.hooks());
  const double F = way / (2 / 1.7 + 5.0);
  for (const ParticleId p : s.state.r.ids())
    EXPECT_NEAR(out.state.r[p].x, static_cast<double>(p.value) - F / 1.7 - F * static_cast<double>(p.value),
                1e-14);
  EXPECT_NEAR(seen.last(1).force.x, F, 1e-14);
  EXPECT_NEAR(seen.last(0).force.x, -F, 1e-14);
  EXPECT_NEAR(seen.last(1).work, 0.5 * F * way, 1e-9 * F * way);
  EXPECT_NEAR(seen.potential.back(), 0.5 * F * way, 1e-14);
}

// A ball is pushed anywhere into a hollow wall: it comes to lie where the wall stands across the force, and
// feels the effective radius of the two.
TEST(WallsAtRest, HoldABallInACavityWhereItIsPushed) {
  const double R = 0.5, R_w = 2.0, P = 0.05, E = 3.0 / (2 * (1 - 0.09));
  for (const Vec3d& along : {Vec3d{0, 0, -1}, Vec3d{0.6, 0, -0.8}, Vec3d{0.8, 0.6, 0}}) {
    const Specimen s = testing::sphere({0, 0, -(R_w - R)}, R, 1.0, contact_of(ContactLaw::hertz),
                                       {wall(SphereWall{{}, R_w, WallSide::inside})});
    StaticStage stage = pressed(s, no_spin, {});
    stage.loads = {testing::pushed(0, P * along)};
    Seen seen;
    const StaticOutcome out = run_static_stage(s.model, stage, s.state, seen.hooks());
    const double R_e = 1 / (1 / R - 1 / R_w), d = std::pow(P / (4.0 / 3.0 * E * std::sqrt(R_e)), 2.0 / 3.0);
    EXPECT_LE(norm(out.state.r[ParticleId{0}] - (R_w - R + d) * along), 1e-11) << along.x;
    EXPECT_LE(norm(seen.last(0).force - P * along), 1e-13);
    EXPECT_EQ(out.result.unstable, 0);
  }
}

// The same in a cylinder, held along its axis: only one direction is hollow.
TEST(WallsAtRest, HoldASphereInACylinder) {
  const double R = 0.5, R_w = 2.0, P = 0.05, E = 3.0 / (2 * (1 - 0.09));
  for (const double length : {endless, 4.0}) {
    const Specimen s = testing::sphere({0, 0.3, -(R_w - R)}, R, 1.0, contact_of(ContactLaw::hertz),
                                       {wall(CylinderWall{{}, {0, 1, 0}, R_w, length, WallSide::inside})});
    StaticStage stage = pressed(s, {false, true, false, true, true, true}, {});
    const Vec3d along{0.6, 0, -0.8};
    stage.loads = {testing::pushed(0, P * along)};
    Seen seen;
    const StaticOutcome out = run_static_stage(s.model, stage, s.state, seen.hooks());
    const double R_e = 1 / std::sqrt((1 / R - 1 / R_w) / R);
    const double d = std::pow(P / (4.0 / 3.0 * E * std::sqrt(R_e)), 2.0 / 3.0);
    EXPECT_LE(norm(out.state.r[ParticleId{0}] - (R_w - R + d) * along - Vec3d{0, 0.3, 0}), 1e-11);
    // of the force at the place of contact, about the centre
    EXPECT_LE(norm(seen.last(0).moment - cross(R_w * along + Vec3d{0, 0.3, 0}, P * along)), 1e-11);
  }
}

/// A bent row of spheres on a plate that is tilted, lifted and pressed against them.
StaticOutcome on_a_plate(const WallShape& shape, Seen& seen) {
  Specimen s = testing::straight_rod(5);
  for (const ParticleId p : s.state.r.ids()) s.state.r[p].x -= 2.0;
  s.model.contact = contact_of(ContactLaw::hertz);
  s.model.contact.pairs = ContactPairs::none;
  s.model.walls = {{"plate", shape, 0, {0, 0, -0.41}}};
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)});
  stage.walls = {{"plate", 0, {0, 0, 0.1}, {0.02, -0.05, 0.01}}};
  stage.steps = 2;
  stage.newton.tolerance = 1e-13;
  return run_static_stage(s.model, stage, s.state, seen.hooks());
}

TEST(WallsAtRest, AMeshOfAPlateIsAPlane) {
  Seen on_plane, on_mesh;
  MeshWall mesh{testing::plate(9, 8.0)};
  for (Vec3d& c : mesh.mesh.corners) c.z -= 0.41;
  const State a = on_a_plate(PlaneWall{{0, 0, -0.41}, {0, 0, 1}}, on_plane).state;
  const State b = on_a_plate(mesh, on_mesh).state;
  for (const ParticleId p : a.r.ids()) EXPECT_LE(norm(a.r[p] - b.r[p]), 1e-12) << p.value;
  EXPECT_GT(a.r[ParticleId{4}].z, 0.05);
  EXPECT_LE(norm(on_plane.last(0).force - on_mesh.last(0).force), 1e-12);
  EXPECT_LE(norm(on_plane.last(0).moment - on_mesh.last(0).moment), 1e-11);
  EXPECT_NEAR(on_plane.last(0).work, on_plane.potential.back(), 1e-9 * on_plane.potential.back());
  EXPECT_NEAR(on_mesh.last(0).work, on_mesh.potential.back(), 1e-9 * on_mesh.potential.back());
}

// In and out again: elastic, so that nothing is left.
TEST_P(WallKinds, GiveEverythingBackWhenTheyGo) {
  Specimen s = testing::straight_rod(5);
  s.model.contact = contact_of(GetParam());
  s.model.contact.pairs = ContactPairs::none;
  s.model.walls = {plane({4.45, 0, 0}, {-1, 0, 0}), plane({4, 0, -0.42}, {-0.1, 0, 1})};
  const auto move = [&](State from, const Vec3d& way, Seen& seen) {
    StaticStage stage =
        testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)});
    stage.walls = {{"plane", 0, {way.x, 0, 0}, {}}, {"plane", 1, {0, 0, way.z}, {}}};
    stage.steps = 4;
    return run_static_stage(s.model, stage, std::move(from), seen.hooks()).state;
  };
  Seen in, out;
  const Vec3d way{-0.2, 0, 0.3};
  const State bent = move(s.state, way, in);
  EXPECT_LT(bent.r[ParticleId{4}].x, 3.95);
  EXPECT_GT(bent.r[ParticleId{4}].z, 0.1);
  EXPECT_GT(norm(in.last(0).force), 1e-4);
  const double U = in.potential.back();
  EXPECT_NEAR(in.last(0).work + in.last(1).work, U, 1e-9 * U);
  const State back = move(bent, -way, out);
  for (const ParticleId p : s.state.r.ids()) {
    EXPECT_LE(norm(back.r[p] - s.state.r[p]), 1e-11) << p.value;
    EXPECT_LE(norm(rotation_vector(back.q[p])), 1e-11) << p.value;
  }
  for (const std::size_t w : {0u, 1u}) {
    EXPECT_EQ(out.last(w).force, Vec3d{});
    EXPECT_LE(norm(out.last(w).displacement), 1e-15);
  }
  EXPECT_NEAR(out.last(0).work + out.last(1).work, 0.0, 2e-9 * U);
}

TEST(WallsAtRest, LeaveABodyWhereSlowDampedMotionDoes) {
  Specimen s = testing::straight_rod(4);
  s.model.contact = contact_of(ContactLaw::hertz);
  s.model.contact.pairs = ContactPairs::none;
  s.model.walls = {plane({3, 0, -0.4}, {-0.3, 0, 1})};
  const Vec3d way{0, 0, 0.2};
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)});
  stage.walls = {{"plane", 0, way, {}}};
  stage.newton.tolerance = 1e-13;
  Seen seen;
  const State rest = run_static_stage(s.model, stage, s.state, seen.hooks()).state;
  Stage motion = testing::plain_stage(0.05, 6000.0);
  motion.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  motion.b_translation = 0.05, motion.b_rotation = 0.05 * 0.064;
  motion.walls = {testing::drive("plane", 0)};
  motion.walls[0].velocity = way / 1000.0;
  motion.walls[0].factor.points = {{0, 1}, {999.999, 1}, {1000.001, 0}};
  Simulation run(s.model, motion, s.state);
  run.run();
  const double missing = norm(run.walls()[0].displacement - way);
  EXPECT_LE(missing, 1e-8);
  for (const ParticleId p : rest.r.ids()) EXPECT_LE(norm(run.state().r[p] - rest.r[p]), 1e-7) << p.value;
  EXPECT_LE(norm(run.walls()[0].force - seen.last(0).force), 1e-7);
  EXPECT_GT(norm(seen.last(0).force), 1e-5);
}

// ---- what holds a body --------------------------------------------------------------------------------

std::string refused(const Specimen& s, const StaticStage& stage) {
  try {
    run_static_stage(s.model, stage, s.state, {});
  } catch (const NoEquilibrium& e) {
    return e.what();
  }
  return "";
}
bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(WallsAtRest, AloneDoNotHoldABody) {
  Specimen s = testing::straight_rod(4);
  s.model.contact = contact_of(ContactLaw::hertz);
  s.model.walls = {plane({-0.4, 0, 0}, {1, 0, 0}), plane({3.4, 0, 0}, {-1, 0, 0})};
  StaticStage stage = testing::static_stage(StageKind::equilibrium, {});
  stage.walls = {{"plane", 1, {-0.01, 0, 0}, {}}};
  const std::string text = refused(s, stage);
  EXPECT_TRUE(contains(text, "translation along y of particles 0 to 3")) << text;
  EXPECT_TRUE(contains(text, "rotation about x of particles 0 to 3")) << text;
  EXPECT_FALSE(contains(text, "translation along x")) << text;
  EXPECT_TRUE(contains(text, "hold only what they touch, along the normal")) << text;
}

// Nothing that walls do in the stage reaches it.
TEST(WallsAtRest, FarFromABodyDoNotHoldIt) {
  const Specimen s =
      testing::sphere({0, 0, 2}, 0.5, 1.0, contact_of(ContactLaw::hertz), {testing::floor_at(0)});
  StaticStage stage = pressed(s, {true, true, false, true, true, true}, {});
  stage.gravity = {0, 0, -0.01};
  const std::string text = refused(s, stage);
  EXPECT_TRUE(contains(text, "translation along z of particle 0")) << text;
}

TEST(WallsAtRest, AreNotPassed) {
  for (const WallShape& shape :
       {WallShape{PlaneWall{{}, {0, 0, 1}}}, WallShape{DiscWall{{}, {0, 0, 1}, 3.0}}}) {
    Specimen s = testing::sphere({0, 0, 0.5}, 0.5, 1.0, contact_of(ContactLaw::linear), {wall(shape)});
    StaticStage stage = pressed(s, {true, true, false, true, true, true}, {});
    stage.loads = {testing::pushed(0, {0, 0, -2.0})};  // k R = 0.85
    stage.steps = 4;
    const std::string text = refused(s, stage);
    EXPECT_TRUE(contains(text, "particle 0: its centre has come through wall \"w\"")) << text;
  }
}

TEST(WallsAtRest, AreNotTouchedByWhatDoesNotFitIntoThem) {
  Specimen s = testing::sphere({0, 0, 0.1}, 0.5, 1.0, contact_of(ContactLaw::linear),
                               {wall(SphereWall{{}, 0.4, WallSide::inside})});
  const std::string text = refused(s, pressed(s, no_spin, {}));
  EXPECT_TRUE(contains(text, "particle 0: it is not smaller than the hollow wall \"w\"")) << text;
}

// ---- other kinds of stages ------------------------------------------------------------------------------

// Between two planes a sphere with linear contacts swings with the frequency of both springs.
TEST(WallsAtRest, GiveModesTheirStiffness) {
  const double R = 0.5, k = 1.7, m = 2.0;
  ContactModel contact = contact_of(ContactLaw::linear);
  const Specimen s = testing::sphere({0, 0, 0}, R, m, contact,
                                     {plane({-0.45, 0, 0}, {1, 0, 0}), plane({0.45, 0, 0}, {-1, 0, 0})});
  StaticStage stage = testing::static_stage(StageKind::modes, {testing::fixed({ParticleId{0}}, only_x_free)});
  stage.count = 1;
  const StaticOutcome out = run_static_stage(s.model, stage, s.state, {});
  ASSERT_EQ(out.result.modes.size(), 1u);
  EXPECT_NEAR(out.result.modes[0].omega2, 2 * k / m, 1e-12);
}

// Where a sphere just touches a wall its stiffness jumps: there are no modes.
TEST(WallsAtRest, ThatJustTouchLeaveNoModes) {
  for (const double at : {-0.5, -0.5 * (1 + 1e-15), -0.5 * (1 - 1e-15)}) {
    const Specimen s = testing::sphere({0, 0, 0}, 0.5, 2.0, contact_of(ContactLaw::linear),
                                       {plane({at, 0, 0}, {1, 0, 0}), plane({0.6, 0, 0}, {-1, 0, 0})});
    const auto modes =
        testing::static_stage(StageKind::modes, {testing::fixed({ParticleId{0}}, only_x_free)});
    EXPECT_TRUE(contains(refused(s, modes), "just touch, to rounding")) << at;
  }
}

// A rod is pushed against a wall that stands still, by a force that a path and a stage of fracture know.
TEST(WallsAtRest, AreTheSameForEveryKindOfStage) {
  const auto end_of = [](StageKind kind, Seen& seen) {
    Specimen s = testing::straight_rod(5);
    s.model.contact = contact_of(ContactLaw::hertz);
    s.model.contact.pairs = ContactPairs::none;
    s.model.walls = {plane({4, 0, -0.5}, {0, 0, 1})};  // a gap of 0.1
    StaticStage stage = testing::static_stage(kind, {testing::fixed({ParticleId{0}}, testing::clamped)},
                                              {testing::pushed(4, {0, 0, -0.002})});
    stage.newton.tolerance = 1e-12;
    stage.path.above = 1.0;
    return run_static_stage(s.model, stage, s.state, seen.hooks()).state;
  };
  Seen seen;
  const State rest = end_of(StageKind::equilibrium, seen);
  EXPECT_LT(seen.last(0).force.z, -1e-4);
  for (const StageKind kind : {StageKind::path, StageKind::fracture}) {
    Seen of_kind;
    const State same = end_of(kind, of_kind);
    EXPECT_LE(norm(same.r[ParticleId{4}] - rest.r[ParticleId{4}]), 1e-9)
        << static_cast<int>(kind) << " " << same.r[ParticleId{4}].z << " " << rest.r[ParticleId{4}].z << " "
        << of_kind.last(0).force.z << " " << seen.last(0).force.z;
    EXPECT_LE(norm(of_kind.last(0).force - seen.last(0).force), 1e-10);
  }
}

// A rod on two bars is bent by a third until its middle bond breaks: bonds have a tensile strength, and
// bending counts. The books of the stage hold the work of the wall; after the break both halves lie on bars.
TEST(WallsAtRest, BreakARodInThreePointBending) {
  BondRecipe recipe = testing::papers_bond(&bond_law<WithRules<VModel>::Law>);
  recipe.rules.strength = linear_strength(1e30, 1e30, 2e-4, 1e30);
  Specimen s = testing::straight_rod(10, recipe);
  s.model.contact = contact_of(ContactLaw::hertz);
  s.model.contact.pairs = ContactPairs::none;
  const auto bar = [](double x, double z) {
    return wall(CylinderWall{{x, 0, z}, {0, 1, 0}, 0.6, endless, WallSide::outside}, {x, 0, z});
  };
  s.model.walls = {bar(0, -1.0), bar(9, -1.0), bar(4.5, std::sqrt(1.0 - 0.25) + 0.02)};
  StaticStage stage = testing::static_stage(
      StageKind::fracture,
      {testing::fixed(s.model.groups[0].particles, {false, true, false, true, false, true}),
       testing::fixed({ParticleId{0}}, {true, false, false, false, false, false})});
  StaticStage press = stage;  // what just touches has no stiffness yet
  press.kind = StageKind::equilibrium;
  press.walls = {{"w", 2, {0, 0, -0.05}, {}}};
  s.state = run_static_stage(s.model, press, s.state, {}).state;
  stage.walls = {{"w", 2, {0, 0, -1.0}, {}}};
  stage.steps = 10;
  Seen seen;
  const StaticOutcome out = run_static_stage(s.model, stage, s.state, seen.hooks());
  const FractureResult& f = out.result.fracture;
  ASSERT_GE(f.breaks.size(), 1u) << out.result.ended << ' ' << f.reason;
  EXPECT_EQ(f.breaks[0].use.bond.value, 4u);
  EXPECT_NEAR(f.breaks[0].load, f.peak_load, 1e-12);
  EXPECT_GT(f.peak_load, 1e-6);
  EXPECT_GT(f.books.work, 0.0);
  EXPECT_LT(std::abs(f.books.error()), 1e-9) << out.result.ended << ' ' << f.reason;
  // two particles under the bar, each with P/2: P/2 times 4 is the moment at which the bond breaks. The load
  // is somewhat more, since the normals of the bars lean as the rod bends.
  EXPECT_NEAR(f.breaks[0].load, 1e-4, 1e-5);
}

}  // namespace
}  // namespace vbond::walls_test
