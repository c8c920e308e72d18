#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "meshes.hpp"
#include "vbond/model/mistakes.hpp"

namespace vbond {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// One particle, a wall of each kind, and a stage that moves two of them.
struct Body {
  Model model = equal_particles({{0, 0, 9}}, 1.0, 0.1, 0.5);
  Stage stage;

  Body() {
    model.contact = {ContactLaw::hertz, ContactPairs::all, 0, 1, 1.0, 0.3};
    model.materials = {{"a", 1.0, 0.2}, {"b", 2.0, 0.5}};
    model.material.push_back(1);
    const WallShape shapes[] = {PlaneWall{{}, {0, 0, 1}}, DiscWall{{}, {0, 1, 0}, 2.0},
                                CylinderWall{{}, {0, 1, 0}, 2.0, std::numeric_limits<double>::infinity()},
                                SphereWall{{}, 20.0}, MeshWall{testing::plate(2, 1.0)}};
    for (const WallShape& shape : shapes) model.walls.push_back({"w", shape, 1, {}});
    stage.dt = 0.1;
    stage.stops.duration = 1.0;
    stage.walls.resize(2);
    stage.walls[0].index = 3;
    stage.walls[1].servo = WallDrive::Servo{{0, 0, 1}, 1.0, {}, 1.0, 0.0, 1.0};
  }
  template <class Shape>
  Shape& shape(std::size_t k) {
    return std::get<Shape>(model.walls[k].shape);
  }
  std::string mistakes() const {
    std::string all;
    for (const std::string& m : mistakes_in(model)) all += m + "\n";
    for (const std::string& m : mistakes_in(model, stage)) all += m + "\n";
    return all;
  }
};

TEST(MistakesInWalls, AreNoneInWhatIsRight) {
  EXPECT_EQ(Body().mistakes(), "");
}

TEST(MistakesInWalls, AreToldEachByItself) {
  const std::pair<std::function<void(Body&)>, const char*> cases[] = {
      {[](Body& b) {
         b.shape<PlaneWall>(0).normal = {0, 0, 2};
       },
       "wall \"w\": the normal must be a unit vector\n"},
      {[](Body& b) { b.shape<DiscWall>(1).radius = 0; }, "wall \"w\": the radius is 0: it must be > 0\n"},
      {[](Body& b) { b.shape<DiscWall>(1).centre.x = nan; }, "wall \"w\": its place must be finite\n"},
      {[](Body& b) { b.shape<CylinderWall>(2).length = nan; },
       "wall \"w\": the length is nan: it must be > 0, or infinite\n"},
      {[](Body& b) { b.shape<CylinderWall>(2).axis = {}; }, "wall \"w\": the axis must be a unit vector\n"},
      {[](Body& b) { b.shape<SphereWall>(3).radius = nan; },
       "wall \"w\": the radius is nan: it must be > 0\n"},
      {[](Body& b) { b.shape<MeshWall>(4).mesh.triangles.clear(); },
       "wall \"w\": the mesh has no triangles\n"},
      {[](Body& b) { b.shape<MeshWall>(4).mesh.triangles[1][2] = 9; },
       "wall \"w\": triangle 1 has corners 0, 4, 9, and there are 9, counted from 0\n"},
      {[](Body& b) {
         b.shape<MeshWall>(4).mesh.triangles[1] = {0, 1, 2};
       },
       "wall \"w\": triangle 1 has no area\n"},
      {[](Body& b) { b.shape<MeshWall>(4).mesh.corners[8].y = nan; },
       "wall \"w\": the corners of the mesh must be finite\n"},
      {[](Body& b) { b.model.walls[0].material = 2; },
       "wall \"w\": its material is number 2, and there are 2, counted from 0\n"},
      {[](Body& b) { b.model.walls[0].centre.y = nan; }, "wall \"w\": its centre must be finite\n"},
      {[](Body& b) {
         b.model.walls.resize(1), b.stage.walls.clear(), b.model.contact.law = ContactLaw::none;
       },
       "wall \"w\": walls push by contacts, and contact.law is none\n"},
      {[](Body& b) { b.model.material[ParticleId{0}] = 2; },
       "the materials of particles: one is number 2, and there are 2, counted from 0\n"},
      {[](Body& b) { b.model.material.push_back(0); },
       "the materials of particles: 2 for 1 particles: one for each, or none\n"},
      {[](Body& b) { b.model.materials[0].E = 0; }, "material \"a\": E is 0: it must be > 0\n"},
      {[](Body& b) { b.model.materials[1].nu = 0.6; }, "material \"b\": nu is 0.6: -1 < nu <= 0.5\n"},
      {[](Body& b) { b.stage.walls[0].index = 5; },
       "the drive of wall \"\": it is for wall 5, and there are 5, counted from 0\n"},
      {[](Body& b) { b.stage.walls[0].index = 0; },
       "the drive of wall \"\": the wall has another drive in this stage\n"},
      {[](Body& b) { b.stage.walls[0].amplitude.x = nan; },
       "the drive of wall \"\": velocities, pivot and amplitude must be finite\n"},
      {[](Body& b) { b.stage.walls[0].frequency = -1; },
       "the drive of wall \"\": the frequency is -1: it must be >= 0\n"},
      {[](Body& b) { b.stage.walls[1].servo->direction = {}; },
       "the drive of wall \"\": the direction of the servo must be a unit vector\n"},
      {[](Body& b) { b.stage.walls[1].servo->force = nan; },
       "the drive of wall \"\": the force of the servo must be finite\n"},
      {[](Body& b) { b.stage.walls[1].servo->mass = 0; },
       "the drive of wall \"\": the mass of the servo is 0: it must be > 0\n"},
      {[](Body& b) { b.stage.walls[1].servo->damping = -1; },
       "the drive of wall \"\": the damping of the servo is -1: it must be >= 0\n"},
      {[](Body& b) { b.stage.walls[1].servo->fastest = 0; },
       "the drive of wall \"\": the largest speed is 0: it must be > 0\n"},
      {[](Body& b) {
         b.stage.walls[1].servo->factor.points = {{nan, 1}};
       },
       "the factor of the servo of wall \"\" has the point (nan, 1)\n"},
  };
  for (const auto& [change, text] : cases) {
    Body body;
    change(body);
    EXPECT_EQ(body.mistakes(), text);
  }
}

TEST(MistakesInTerms, AreStrainsAtRest) {
  Body body;
  StaticStage stage;
  const auto told = [&] {
    const std::vector<std::string> all = mistakes_in(body.model, stage);
    return std::count(all.begin(), all.end(), "a stage at rest imposes no strain");
  };
  EXPECT_EQ(told(), 0);
  stage.strain.emplace();
  EXPECT_EQ(told(), 1);
}

TEST(MistakesInWalls, AreFoundInStaticStages) {
  Body body;
  StaticStage stage;
  const auto told = [&](const std::string& text) {
    const std::vector<std::string> all = mistakes_in(body.model, stage);
    return std::count(all.begin(), all.end(), "the drive of wall \"w\": " + text);
  };
  stage.walls = {{"w", 0, {0, 0, 1}, {}}};
  const std::vector<std::string> none = mistakes_in(body.model, stage);
  EXPECT_TRUE(std::none_of(none.begin(), none.end(),
                           [](const std::string& m) { return m.find("wall") != std::string::npos; }));
  stage.walls.push_back(stage.walls[0]);
  EXPECT_EQ(told("the wall has another drive in this stage"), 1);
  stage.walls[1].index = 99;
  EXPECT_EQ(told(fmt::format("it is for wall 99, and there are {}, counted from 0", body.model.walls.size())),
            1);
  stage.walls.pop_back();
  for (const auto vector : {&WallDrive::velocity, &WallDrive::angular_velocity}) {
    stage.walls[0] = {"w", 0, {0, 0, 1}, {}};
    (stage.walls[0].*vector).x = std::numeric_limits<double>::infinity();
    EXPECT_EQ(told("velocities, pivot and amplitude must be finite"), 1);
  }
  stage.walls[0] = {"w", 0, {0, 0, 1}, {}};
  stage.walls[0].frequency = 1.0;
  EXPECT_EQ(told("factor, oscillation and servo are for stages of motion"), 1);
  stage.walls[0].frequency = 0.0;
  stage.walls[0].factor = {{{0.0, 1.0}, {1.0, 2.0}}};
  EXPECT_EQ(told("factor, oscillation and servo are for stages of motion"), 1);
  stage.walls[0].factor = {};
  for (const StageKind kind : {StageKind::path, StageKind::buckling, StageKind::modes}) {
    stage.kind = kind;
    EXPECT_EQ(told("walls move in stages of equilibrium and of fracture"), 1);
  }
}

}  // namespace
}  // namespace vbond
