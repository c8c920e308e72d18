// Many spheres with friction come to rest in a box.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dynamics/rods.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

using testing::Dice;
using testing::Specimen;

/// 22 x 22 x 21 spheres of radius 0.4 to 0.5 and one density, above the floor of a box.
Specimen spheres_in_a_box() {
  Specimen s;
  std::vector<Vec3d> r;
  for (int z = 0; z < 21; ++z)
    for (int y = 0; y < 22; ++y)
      for (int x = 0; x < 22; ++x) r.push_back({0.55 + x, 0.55 + y, 0.6 + z});
  s.model = equal_particles(r, 1.0, 0.1, 0.5);
  Dice dice(3);
  for (const ParticleId p : s.model.radius.ids()) {
    const double R = dice(0.4, 0.5), m = 8.0 * R * R * R;
    s.model.radius[p] = R, s.model.mass[p] = m, s.model.inertia[p] = 0.4 * m * R * R;
  }
  ContactModel& c =
      s.model.contact = {.law = ContactLaw::hertz, .pairs = ContactPairs::all, .E = 2000, .nu = 0.3};
  c.tangential = TangentialForm::mindlin, c.rolling = RollingForm::spring;
  c.surface = {.friction = 0.5, .restitution = 0.3, .rolling_friction = 0.05};
  const double L = 22.1;
  s.model.walls = {{"floor", PlaneWall{{0, 0, 0}, {0, 0, 1}}, 0, {}},
                   {"left", PlaneWall{{0, 0, 0}, {1, 0, 0}}, 0, {}},
                   {"right", PlaneWall{{L, 0, 0}, {-1, 0, 0}}, 0, {}},
                   {"front", PlaneWall{{0, 0, 0}, {0, 1, 0}}, 0, {}},
                   {"back", PlaneWall{{0, L, 0}, {0, -1, 0}}, 0, {}}};
  s.state = at_rest(s.model);
  for (Vec3d& v : s.state.v) v = {dice(-0.3, 0.3), dice(-0.3, 0.3), dice(-0.3, 0.3)};
  return s;
}

// They have nothing but friction and contacts that damp. The books close, none has left, the body still
// breathes: the floor bears its weight to two percent, and the kinetic energy would lift the spheres by 1e-5
// of their radii.
TEST(Settling, OfTenThousandSpheresInABox) {
  const Specimen s = spheres_in_a_box();
  double weight = 0.0, lift = 0.0;
  for (const ParticleId p : s.model.mass.ids())
    weight += s.model.mass[p], lift += s.model.mass[p] * s.model.radius[p];
  Stage stage = testing::plain_stage(0.2 * step_bound(s.model, s.state).dt, 40.0);
  stage.gravity = {0, 0, -1};
  Simulation run(s.model, stage, s.state, 2);
  double worst = 0.0;
  while (run.clock().time() < 40.0) {
    for (int k = 0; k < 500; ++k) run.step();
    worst = std::max(worst, std::abs(run.balance_error()));
  }
  const State& now = run.state();
  double top = 0.0;
  for (const Vec3d& r : now.r) {
    EXPECT_TRUE(r.x > 0.0 && r.x < 22.1 && r.y > 0.0 && r.y < 22.1 && r.z > 0.0);
    top = std::max(top, r.z);
  }
  const Energies e = run.energies();
  EXPECT_LT(worst, 1e-3);
  EXPECT_LT(e.kinetic(), 1e-5 * lift);
  EXPECT_LT(top, 20.0);
  double borne = 0.0;
  for (const WallState& w : run.walls()) borne -= w.force.z;
  EXPECT_NEAR(borne, weight, 2e-2 * weight);
}

}  // namespace
}  // namespace vbond
