// What ends a run with walls, each with the names of those that are at fault and a way out.
#include <gtest/gtest.h>

#include <string>

#include "spheres_and_walls.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond::wall_faults_test {
namespace {

using testing::drive;
using testing::floor_at;
using testing::linear;
using testing::Specimen;
using testing::sphere;

constexpr ParticleId first{0};

/// What a run ends with; nothing if it comes to its end.
std::string end_of(const Specimen& s, const Stage& stage) {
  try {
    Simulation(s.model, stage, s.state).run();
  } catch (const Diverged& e) {
    return e.what();
  }
  return "";
}

TEST(WallFault, ACentreThatHasComeThrough) {
  Specimen s = sphere({0, 0, 0.5}, 0.1, 1.0, linear(10.0, 0.0), {floor_at(0)});
  s.state.v[first] = {0, 0, -5};
  const std::string end = end_of(s, testing::plain_stage(1e-3, 2.0));
  EXPECT_NE(end.find("particle 0: its centre has passed through wall \"floor\""), std::string::npos) << end;
}

// A disc has no thickness: a sphere that jumps over it in one step would never be seen to touch it. A plane
// is felt behind its surface.
TEST(WallFault, AParticleThatIsTooFastForAThinWall) {
  const Wall disc{"disc", DiscWall{{0, 0, 0}, {0, 0, 1}, 1.0}, 0, {}};
  Specimen s = sphere({0, 0, 1.5}, 0.1, 1.0, linear(10.0, 0.0), {disc});
  s.state.v[first] = {0, 0, -30};
  const std::string end = end_of(s, testing::plain_stage(0.01, 1.0));
  EXPECT_NE(end.find("particle 0: it moves by 3 of its radius in a step near wall \"disc\""),
            std::string::npos)
      << end;
  EXPECT_NE(end.find("time.step below 0.00333"), std::string::npos) << end;
  s.state.r[first] = s.model.r_0[first] = {5, 0, 1.5};  // far from the disc it may fly
  EXPECT_EQ(end_of(s, testing::plain_stage(0.01, 0.1)), "");
}

TEST(WallFault, ASphereThatDoesNotFitIntoATube) {
  const CylinderWall tube{{0, 0, 0}, {0, 0, 1}, 0.4, 1.0, WallSide::inside};
  Specimen s = sphere({0, 0, 2.0}, 0.5, 1.0, linear(100.0, 0.0), {{"tube", tube, 0, {}}});
  s.state.v[first] = {0, 0, -4};
  const std::string end = end_of(s, testing::plain_stage(1e-3, 2.0));
  EXPECT_NE(end.find("not smaller than the hollow wall \"tube\""), std::string::npos) << end;
}

// A lid of little mass on n spheres is a body between n springs: leap-frog needs dt^2 n k <= 4 m of it.
struct UnderALid {
  Specimen s;
  Stage stage;
  UnderALid(std::size_t n, double mass, double dt) : stage(testing::plain_stage(dt, 0.5)) {
    std::vector<Vec3d> r;
    for (std::size_t k = 0; k < n; ++k) r.push_back({static_cast<double>(k), 0, 0.5});
    s = Specimen{equal_particles(r, 1.0, 0.1, 0.5), {}};
    s.model.contact = linear(1e3, 0.0);
    s.model.walls = {floor_at(0), {"lid", PlaneWall{{0, 0, 1.0}, {0, 0, -1}}, 0, {}}};
    s.state = at_rest(s.model);
    stage.walls = {drive("lid", 1)};
    stage.walls[0].servo = WallDrive::Servo{{0, 0, -1}, 1.0, {}, mass, 0.0, 10.0};
  }
};

TEST(WallFault, ALidThatIsTooLight) {
  const double k = 1e3, dt = 0.01, least = 4 * k * dt * dt / 4.0;
  const std::string end = end_of(UnderALid(4, 0.9 * least, dt).s, UnderALid(4, 0.9 * least, dt).stage);
  EXPECT_NE(end.find("wall \"lid\": its servo has the mass 0.09"), std::string::npos) << end;
  EXPECT_NE(end.find("at least 0.1"), std::string::npos) << end;
  EXPECT_EQ(end_of(UnderALid(4, 1.5 * least, dt).s, UnderALid(4, 1.5 * least, dt).stage), "");
}

// The step bound knows of it beforehand: at that step the lid's share of lambda is n k/m at most, and the
// books close; twenty times lighter needs a smaller step.
TEST(WallFault, IsAvoidedByTheStepBound) {
  for (const double mass : {4.0, 0.2, 1e-3}) {
    UnderALid lid(4, mass, 1.0);
    const StepBound bound = step_bound(lid.s.model, lid.s.state, lid.stage);
    EXPECT_LE(bound.dt, 2.0 / std::sqrt(4.0 * 1e3 / mass));
    if (mass < 0.1) {
      EXPECT_NE(bound.source.find("\"lid\", by the mass of its servo"), std::string::npos) << bound.source;
    }
    lid.stage.dt = 0.1 * bound.dt;
    lid.stage.stops.duration = 0.5;
    Simulation run(lid.s.model, lid.stage, lid.s.state);
    run.run();
    EXPECT_LT(std::abs(run.balance_error()), 0.02) << mass;
  }
}

// Told deep in a wall: more than a part of the radius, beyond what it was at the first places of both.
TEST(WallFault, IsForeseenByTheDepthInWalls) {
  Specimen s = sphere({0, 0, 0.5}, 0.5, 1.0, linear(10.0, 0.0), {floor_at(0), floor_at(-1)});
  const auto deep = [&](double z) {
    s.state.r[first].z = z;
    return Simulation(s.model, testing::plain_stage(1e-3, 1.0), s.state).deep().walls.deeper_than(0.1);
  };
  EXPECT_TRUE(deep(0.451).empty());
  const std::vector<DeepInWall> found = deep(0.4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].p, first);
  EXPECT_EQ(found[0].wall, 0u);
  EXPECT_NEAR(found[0].overlap, 0.1, 1e-15);
  s.model.r_0[first].z = 0.4;
  EXPECT_TRUE(deep(0.36).empty());
  EXPECT_EQ(deep(0.34).size(), 1u);
}

// A stiff rolling spring, hollow walls and walls that are touched already make the step smaller.
TEST(StepBoundOfContacts, CountsRollingHollowWallsAndTouchedWalls) {
  ContactModel hertz{.law = ContactLaw::hertz, .E = 1e4, .nu = 0.3};
  const auto dt = [](const ContactModel& c, const std::vector<Wall>& walls) {
    const Specimen s = sphere({0, 0, 0.5}, 0.5, 1.0, c, walls);
    return step_bound(s.model, s.state).dt;
  };
  const double plane = dt(hertz, {floor_at(-1)});
  const double tube = dt(hertz, {{"tube", SphereWall{{0, 0, 0.45}, 0.9, WallSide::inside}, 0, {}}});
  EXPECT_NEAR(tube, plane / std::sqrt(1.5), 1e-12 * plane);  // R* = 2.25 R, and k goes by its root
  const Wall left{"left", PlaneWall{{-0.4, 0, 0}, {1, 0, 0}}, 0, {}};
  const Wall right{"right", PlaneWall{{0.4, 0, 0}, {-1, 0, 0}}, 0, {}};
  EXPECT_NEAR(dt(hertz, {left, right}), plane / std::sqrt(2.0), 1e-12 * plane);
  ContactModel rolling = hertz;
  rolling.rolling = RollingForm::spring, rolling.surface.rolling_friction = 0.1;
  rolling.rolling_stiffness = 1e6;  // k_r 2/Theta = 2e7 is more than all others
  EXPECT_NEAR(dt(rolling, {floor_at(-1)}), 2.0 / std::sqrt(1e6 * 2.0 / 0.1), 1e-12);
}

}  // namespace
}  // namespace vbond::wall_faults_test
