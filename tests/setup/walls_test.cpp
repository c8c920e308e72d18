#include <fstream>

#include "cases.hpp"
#include "temporary_folder.hpp"
#include "vbond/case/read.hpp"

namespace vbond::test {
namespace {

/// What is given, three spheres with radius 0.4 along x at height 1, contacts, and lines of the one stage.
Case walls_case(const std::string& text, const std::string& stage_lines = "") {
  return parse_case(
      text +
          "\n[[specimen]]\nkind = \"rod\"\nparticles = 3\nmass = 1\nradius = 0.4\norigin = [0, 0, 1]\n"
          "[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.3\n[time]\nstep = 0.01\n"
          "[[stage]]\nduration = 1\n" +
          stage_lines,
      "case.toml");
}

Stage first_stage_with_walls(const Case& c) {
  Built b = build(c);
  return build_stage(c, b.model, 0, b.state);
}

void expect_refused(const Case& c, const std::string& place, const std::vector<std::string>& parts) {
  const std::string text = text_of_error(c);
  EXPECT_TRUE(contains(text, place)) << text;
  for (const std::string& part : parts) EXPECT_TRUE(contains(text, part)) << part << " is not in:\n" << text;
}

TEST(Walls, HaveTheShapesOfTheCase) {
  const Model m = build(walls_case(R"(
wall = [
  { name = "floor", shape = "plane", point = [0, 0, 0.5], normal = [0, 0, 2] },
  { name = "lid", shape = "disc", centre = [0, 3, 3], normal = [0, -3, 0], radius = 2 },
  { name = "drum", shape = "cylinder", centre = [1, 1, 1], axis = [5, 0, 0], radius = 4, side = "inside" },
  { name = "bar", shape = "cylinder", centre = [0, 9, 0], axis = [0, 0, 1], radius = 1, length = 2.5 },
  { name = "ball", shape = "sphere", centre = [0, 0, -4], radius = 3, side = "outside", moments_about = [1, 2, 3] },
  { shape = "box", min = [-2, -1, -3], max = [4, 5, 6] },
]
)"))
                      .model;
  ASSERT_EQ(m.walls.size(), 6u);
  EXPECT_EQ(m.walls[0].name, "floor");
  const auto& plane = std::get<PlaneWall>(m.walls[0].shape);
  EXPECT_EQ(plane.normal, (Vec3d{0, 0, 1}));
  EXPECT_EQ(m.walls[0].centre, (Vec3d{0, 0, 0.5}));
  EXPECT_EQ(std::get<DiscWall>(m.walls[1].shape).normal, (Vec3d{0, -1, 0}));
  EXPECT_EQ(std::get<DiscWall>(m.walls[1].shape).radius, 2.0);
  const auto& drum = std::get<CylinderWall>(m.walls[2].shape);
  EXPECT_TRUE(std::isinf(drum.length) && drum.axis == (Vec3d{1, 0, 0}) && drum.side == WallSide::inside);
  EXPECT_EQ(std::get<CylinderWall>(m.walls[3].shape).length, 2.5);
  EXPECT_EQ(std::get<SphereWall>(m.walls[4].shape).side, WallSide::outside);
  EXPECT_EQ(m.walls[4].centre, (Vec3d{1, 2, 3}));
  EXPECT_EQ(m.walls[5].name, "wall-6");
  EXPECT_EQ(std::get<MeshWall>(m.walls[5].shape).mesh.triangles.size(), 12u);
  EXPECT_EQ(m.walls[5].centre, (Vec3d{1, 2, 1.5}));
}

TEST(Materials, AreThoseThatSpecimensAndWallsName) {
  const char* const two =
      "material = [{ name = \"a\", E = 1, nu = 0.2 }, { name = \"b\", E = 2, nu = 0.5 }]\n";
  const std::string floor = "[[wall]]\nname = \"floor\"\nshape = \"plane\"\nnormal = [0, 0, 1]\n";
  std::string text = to_toml(walls_case(floor + "material = \"b\"\n"));
  for (const char* key : {"E = 100.0\n", "nu = 0.3\n"}) text.erase(text.find(key), std::string(key).size());
  Case c = parse_case(two + text, "case.toml");
  c.specimens.push_back(specimen(ListedSpecimen{{{0, 0, 5}}}, "other"));
  c.specimens[1].material = Placed<std::string>{"b", {"case.toml", 5, 1}};
  const Model m = build(c).model;
  ASSERT_EQ(m.materials.size(), 2u);
  EXPECT_EQ(m.materials[1].E, 2.0);
  EXPECT_EQ(m.materials[1].nu, 0.5);
  EXPECT_EQ(m.walls[0].material, 1u);
  EXPECT_EQ(m.material_of(ParticleId{2}), 0u);
  EXPECT_EQ(m.material_of(ParticleId{3}), 1u);
  c.specimens[1].material->value = "c";
  expect_refused(c, "case.toml:5:1", {"there is no material \"c\"", "a, b"});
}

TEST(Walls, NeedContacts) {
  Case c = walls_case("[[wall]]\nshape = \"plane\"\nnormal = [0, 0, 1]\n");
  c.contact.law = ContactLaw::none;
  expect_refused(c, "case.toml:1:1", {"wall \"wall-1\" without contacts", "add [contact]"});
}

TEST(Walls, ThatStandInsideASpecimenAreRefusedWithTheWorstParticle) {
  const auto floor_at = [](double z) {
    return walls_case("[[wall]]\nname = \"floor\"\nshape = \"plane\"\nnormal = [0.2, 0, 1]\npoint = [0, 0, " +
                      std::to_string(z) + "]\n");
  };
  EXPECT_EQ(text_of_error(floor_at(0.75)), "");  // by less than half a radius at the first particle
  expect_refused(floor_at(0.85), "case.toml:1:1", {"wall \"floor\" stands inside a specimen", "particle 0 "});
  expect_refused(floor_at(9), "case.toml:1:1", {"particle 0 ", "wrong way"});
  expect_refused(walls_case("[[wall]]\nshape = \"box\"\nmin = [-1, -1, -1]\nmax = [2.1, 3, 3]\n"),
                 "case.toml:1:1", {"particle 2 at (2, 0, 1) by 0.75 of its radius"});
  expect_refused(
      walls_case("[[wall]]\nshape = \"sphere\"\ncentre = [0, 0, 1]\nradius = 0.3\nside = \"inside\"\n"),
      "case.toml:1:1", {"does not fit", "larger radius"});
}

TEST(WallDrives, AreResolved) {
  const Stage s = first_stage_with_walls(walls_case(R"(
wall = [
  { name = "floor", shape = "plane", normal = [0, 0, 1] },
  { name = "lid", shape = "disc", centre = [0, 0, 3], normal = [0, 0, 1], radius = 2 },
]
)",
                                                    R"(
walls = [
  { wall = "lid", velocity = [1, 0, 0], servo = { direction = [0, 0, -2], force = 3, ramp = 0.5, mass = 4, damping = 5, fastest = 6 } },
  { wall = "floor", angular_velocity = [0, 0, 1], pivot = [1, 0, 0], table = [[0, 0], [0.3, 2]], oscillation = { amplitude = [0, 1, 0], frequency = 7 } },
]
)"));
  ASSERT_EQ(s.walls.size(), 2u);
  const WallDrive &lid = s.walls[0], &floor = s.walls[1];
  EXPECT_EQ(lid.index, 1u);
  EXPECT_EQ(lid.velocity, (Vec3d{1, 0, 0}));
  EXPECT_FALSE(lid.pivot);  // its centre
  ASSERT_TRUE(lid.servo);
  EXPECT_EQ(lid.servo->direction, (Vec3d{0, 0, -1}));
  EXPECT_EQ(lid.servo->factor(0.25), 0.5);
  EXPECT_EQ(lid.servo->force + 10 * lid.servo->mass + 100 * lid.servo->damping + 1000 * lid.servo->fastest,
            6543.0);
  EXPECT_EQ(floor.index, 0u);
  EXPECT_EQ(floor.pivot, (Vec3d{1, 0, 0}));
  EXPECT_EQ(floor.factor(0.3), 2.0);
  EXPECT_EQ(floor.amplitude, (Vec3d{0, 1, 0}));
  EXPECT_EQ(floor.frequency, 7.0);
  EXPECT_FALSE(floor.servo);
}

TEST(WallDrives, OfWallsThatAreNotThereOrMovedTwiceAreRefused) {
  const std::string floor = "[[wall]]\nname = \"floor\"\nshape = \"plane\"\nnormal = [0, 0, 1]\n";
  expect_refused(walls_case(floor, "walls = [{ wall = \"flor\", velocity = [1, 0, 0] }]\n"),
                 "case.toml:20:12", {"there is no wall \"flor\"", "did you mean \"floor\"?"});
  expect_refused(walls_case("", "walls = [{ wall = \"floor\", velocity = [1, 0, 0] }]\n"),
                 "case.toml:", {"the case has no [[wall]]"});
  expect_refused(walls_case(floor,
                            "walls = [{ wall = \"floor\", velocity = [1, 0, 0] },\n"
                            "{ wall = \"floor\", angular_velocity = [1, 0, 0] }]\n"),
                 "case.toml:21:", {"moved twice", "one entry"});
}

TEST(WallDrives, MayNotTurnAWallAlongItsServo) {
  const std::string lid =
      "[[wall]]\nname = \"lid\"\nshape = \"plane\"\npoint = [0, 0, 3]\nnormal = [0, 0, -1]\n";
  const auto drive = [&](const std::string& pivot, const std::string& axis) {
    return walls_case(lid, "walls = [{ wall = \"lid\", angular_velocity = " + axis + pivot +
                               ", servo = { direction = [0, 0, -1], force = 1, mass = 1 } }]\n");
  };
  for (const char* pivot : {", pivot = [1, 0, 3]", ", pivot = [0, 0, 3]"}) {
    expect_refused(drive(pivot, "[0, 1, 0]"), "case.toml:", {"turns about a pivot that is fixed in space"});
    EXPECT_EQ(text_of_error(drive(pivot, "[0, 0, 1]")), "");
  }
  EXPECT_EQ(text_of_error(drive("", "[0, 1, 0]")), "");
}

TEST(Contacts, HaveANumberForEachForm) {
  const auto with = [](void (*change)(Case&)) {
    Case c = walls_case("");
    change(c);
    return c;
  };
  expect_refused(with([](Case& c) { c.contact.tangential = TangentialForm::mindlin; }), "case.toml",
                 {"contact.tangential does nothing", "no friction", "remove tangential"});
  expect_refused(with([](Case& c) { c.contact.rolling = RollingForm::constant; }), "case.toml",
                 {"contact.rolling does nothing", "rolling_friction or twisting_friction"});
  expect_refused(with([](Case& c) { c.contact.adhesion = AdhesionForm::jkr; }), "case.toml",
                 {"contact.adhesion does nothing", "work_of_adhesion"});
  EXPECT_EQ(text_of_error(with([](Case& c) {
              c.contact.tangential = TangentialForm::mindlin;
              c.contact.surface.friction = 0.0;  // on purpose
            })),
            "");
}

TEST(Contacts, ThatOverlapByHalfAtTheStartAreRefused) {
  const auto pair = [](double x) {
    return parse_case("[[specimen]]\nkind = \"list\"\npositions = [[0, 0, 0], [" + std::to_string(x) +
                          ", 0, 0]]\nmass = 1\nradius = 0.5\n[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.3\n"
                          "[[stage]]\nduration = 1\n",
                      "case.toml");
  };
  expect_refused(
      pair(0.7), "case.toml:1:1",
      {"particles 0 and 1, which are not bonded, overlap by 0.6", "1 such pairs", "smaller radii"});
  EXPECT_EQ(text_of_error(pair(0.76)), "");
}

TEST(Contacts, OfAPairOfMaterialsAreSaidOnce) {
  std::string text = to_toml(walls_case(""));
  for (const char* key : {"E = 100.0\n", "nu = 0.3\n"}) text.erase(text.find(key), std::string(key).size());
  const std::string materials =
      "material = [{ name = \"a\", E = 1, nu = 0.2 }, { name = \"b\", E = 2, nu = 0.5 }]\n";
  const std::string once = "[[contact.between]]\nmaterial = \"a\"\nwith = \"b\"\nrestitution = 0.5\n";
  const std::string again = "[[contact.between]]\nmaterial = \"b\"\nwith = \"a\"\nrestitution = 0.6\n";
  EXPECT_EQ(text_of_error(parse_case(materials + text + once, "case.toml")), "");
  expect_refused(parse_case(materials + text + once + again, "case.toml"),
                 "case.toml:", {"a pair of contact.between twice", "put what both say into one"});
}

TEST(Walls, OfAMeshAThousandTimesTooSmallAreRefused) {
  const TemporaryFolder folder("vbond_small_mesh");
  std::ofstream(folder.path() / "plate.stl") << "solid p\nfacet normal 0 0 1\nouter loop\nvertex 0 0 "
                                                "0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
                                                "endsolid p\n";
  const auto plate = [&](const std::string& scale) {
    return walls_case("[[wall]]\nshape = \"mesh\"\nfile = \"" + (folder.path() / "plate.stl").string() +
                      "\"\nscale = " + scale + "\nshift = [0, 0, -3]\n");
  };
  expect_refused(plate("1e-30"), "case.toml:3:", {"the mesh is 1.41e-30 long", "give scale"});
  EXPECT_EQ(text_of_error(plate("1")), "");
}

const char* const floor_and_lid =
    "[[wall]]\nname = \"floor\"\nshape = \"plane\"\nnormal = [0, 0, 1]\n"
    "[[wall]]\nname = \"lid\"\nshape = \"disc\"\ncentre = [1, 0, 3]\nnormal = [0, 0, 1]\nradius = 5\n";

Case static_case(const std::string& stage,
                 const std::string& contact = "law = \"hertz\"\nE = 100\nnu = 0.3") {
  return parse_case(
      std::string(floor_and_lid) +
          "[[specimen]]\nkind = \"rod\"\nparticles = 3\nmass = 1\nradius = 0.4\norigin = [0, 0, 1]\n"
          "[contact]\n" +
          contact + "\n[[stage]]\n" + stage,
      "case.toml");
}

TEST(Walls, MoveInStaticStagesByTheLoadFactor) {
  const Case c = static_case(
      "kind = \"equilibrium\"\nwalls = [{ wall = \"lid\", displacement = [0, 0, -1], rotation = [0, 0.5, 0], "
      "pivot = [1, 2, 3] }]\n");
  Built b = build(c);
  const StaticStage stage = build_static_stage(c, b.model, 0, b.state);
  ASSERT_EQ(stage.walls.size(), 1u);
  EXPECT_EQ(stage.walls[0].wall, "lid");
  EXPECT_EQ(stage.walls[0].index, 1u);
  EXPECT_EQ(stage.walls[0].velocity, (Vec3d{0, 0, -1}));
  EXPECT_EQ(stage.walls[0].angular_velocity, (Vec3d{0, 0.5, 0}));
  EXPECT_EQ(stage.walls[0].pivot, (Vec3d{1, 2, 3}));
}

TEST(Walls, OfStaticStagesAreToldWhatTheyMayDo) {
  const auto text = [](const std::string& stage) -> std::string {
    try {
      const Case c = static_case(stage);
      Built b = build(c);
      build_static_stage(c, b.model, 0, b.state);
    } catch (const CaseError& e) {
      return e.what();
    }
    return "";
  };
  const std::string servo =
      "walls = [{ wall = \"lid\", servo = { direction = [0, 0, -1], force = 1, mass = 1 } }]";
  const std::string pushed = "walls = [{ wall = \"lid\", displacement = [0, 0, -1] }]";
  for (const auto& [stage, parts] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"kind = \"equilibrium\"\n" + servo,
            {"case.toml:23:", "no displacement or rotation",
             "a force moves it (servo) in stages of kind = "
             "\"dynamics\" only",
             "servo"}},
           {"kind = \"path\"\n" + pushed, {"case.toml:23:", "\"equilibrium\" or \"fracture\""}},
           {"kind = \"equilibrium\"\nwalls = [{ wall = \"lid\", displacement = [0, 0, -1], pivot = [1, 0, 0] "
            "}]",
            {"case.toml:23:", "nothing turns about the pivot"}},
           {"kind = \"equilibrium\"\nwalls = [{ wall = \"lud\", displacement = [0, 0, -1] }]",
            {"case.toml:23:", "there is no wall \"lud\""}}})
    for (const std::string& part : parts)
      EXPECT_TRUE(contains(text(stage), part)) << part << " is not in:\n" << text(stage);
}

TEST(Contacts, ThatDoMoreThanRepelAreRefusedInStaticStages) {
  const std::string hertz = "law = \"hertz\"\nE = 100\nnu = 0.3\n";
  for (const auto& [lines, key] : std::vector<std::pair<std::string, std::string>>{
           {"adhesion = \"dmt\"\nwork_of_adhesion = 1\n", "contact.adhesion"},
           {"overlap_at_break = \"kept\"\n", "contact.overlap_at_break"}}) {
    const Case c = static_case("kind = \"equilibrium\"\n", hertz + lines);
    expect_refused(c, "case.toml:", {"contacts do more than repel: " + key, "kind = \"dynamics\""});
  }
  EXPECT_EQ(text_of_error(static_case("kind = \"equilibrium\"\n", "law = \"linear\"\nk = 3\n")), "");
  // what only rubs or damps is at rest
  for (const char* lines : {"tangential = \"mindlin\"\nfriction = 0.3\n", "restitution = 0.5\n"})
    EXPECT_EQ(text_of_error(static_case("kind = \"equilibrium\"\n", hertz + lines)), "");
}

}  // namespace
}  // namespace vbond::test
