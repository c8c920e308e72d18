#include "vbond/observe/frames.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>

#include "specimen.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/terms/walls/output_wall_triangles.hpp"
#include "vtp_reader.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::VtpReader;

constexpr double pi = std::numbers::pi;

std::vector<double> flat(const PerParticle<Vec3d>& column) {
  std::vector<double> out;
  for (const Vec3d& x : column) out.insert(out.end(), {x.x, x.y, x.z});
  return out;
}

void expect_well_formed(const VtpReader& f) {
  const std::size_t cells = f.verts + f.lines + f.polys;
  for (const auto& [name, array] : f.arrays) {
    const std::map<std::string, std::size_t> sizes{
        {"UInt8", 1}, {"Float32", 4}, {"Int32", 4}, {"Float64", 8}, {"Int64", 8}};
    ASSERT_EQ(sizes.count(array.type), 1u) << array.type;
    const std::size_t item = sizes.at(array.type);
    const std::size_t tuples = array.section == "PointData" || array.section == "Points" ? f.points
                               : name == "connectivity" ? f.verts + 2 * f.lines + 3 * f.polys
                                                        : cells;
    EXPECT_EQ(array.bytes.size(), tuples * array.components * item) << name;
  }
  EXPECT_EQ(f.after_arrays.find("\n  </AppendedData>\n</VTKFile>"), 0u);
}

TEST(ParticleFrame, ReadsBackBitForBit) {
  const Folder folder;
  Chain chain;
  chain.state.r[ParticleId{1}] += Vec3d{1e-17, 0.25, -1.0 / 3.0};
  chain.turn(2, {0, 0, 1}, 0.3);
  chain.model.specimen = {0, 0, 1};
  write_particles_vtp(folder / "p.vtp", chain.model, chain.state);
  const VtpReader f(content_of(folder / "p.vtp"));

  expect_well_formed(f);
  EXPECT_EQ(f.points, 3u);
  EXPECT_EQ(f.verts, 3u);
  EXPECT_EQ(f.lines, 0u);
  EXPECT_EQ(std::stod(f.in_text.at("TimeValue")), chain.state.clock.time());
  EXPECT_EQ(f.in_text.at("Step"), "1200");
  EXPECT_EQ(f.arrays.at("Points").as<double>(), flat(chain.state.r));
  EXPECT_EQ(f.arrays.at("connectivity").integers(), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(f.arrays.at("offsets").integers(), (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(f.arrays.at("radius").as<double>(), chain.model.radius.values());
  EXPECT_EQ(f.arrays.at("velocity").as<double>(), flat(chain.state.v));
  EXPECT_EQ(f.arrays.at("angular_velocity").as<double>(), flat(chain.state.omega));
  EXPECT_EQ(f.arrays.at("id").integers(), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(f.arrays.at("specimen").integers(), (std::vector<std::int64_t>{0, 0, 1}));
  const auto rotation = f.arrays.at("rotation").as<double>();
  EXPECT_EQ(rotation[5], 0.0);
  EXPECT_NEAR(rotation[8], 0.3, 1e-15);  // sine, cosine and arctangent, each good to an ulp of 0.3
  const auto displacement = f.arrays.at("displacement").as<double>();
  EXPECT_EQ(displacement[4], 0.25);
  EXPECT_EQ(displacement[6], 0.0);
}

TEST(BondFrame, ShowsStretchTwistAndBendOfEachBond) {
  const Folder folder;
  Chain chain(4);
  chain.state.r[ParticleId{0}].x -= 0.01;  // bond 0: stretched
  chain.turn(2, {1, 0, 0}, pi / 3);        // bonds 1 and 2: twisted by 60 degrees, there and back
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced, {}, {.breaks = true});
  const VtpReader f(content_of(folder / "b.vtp"));

  expect_well_formed(f);
  EXPECT_EQ(f.points, 4u);
  EXPECT_EQ(f.verts, 0u);
  EXPECT_EQ(f.lines, 3u);
  EXPECT_EQ(f.arrays.at("connectivity").integers(), (std::vector<std::int64_t>{0, 1, 1, 2, 2, 3}));
  EXPECT_EQ(f.arrays.at("offsets").integers(), (std::vector<std::int64_t>{2, 4, 6}));
  EXPECT_EQ(f.arrays.at("set").integers(), (std::vector<std::int64_t>{0, 1, 2}));
  const auto value = [&f](const char* name, std::size_t bond) {
    return f.arrays.at(name).as<double>()[bond];
  };
  // positions near 1 are known to 2e-16, angles are good to some ulp: 1e-14 is far above both
  EXPECT_NEAR(value("elongation", 0), 0.01, 1e-14);
  EXPECT_NEAR(value("axial_force", 0), 0.01, 1e-14);  // B1 = 1: tension is positive
  EXPECT_NEAR(value("U_L", 0), 0.5 * 1e-4, 1e-14);    // B1/2 (D - a)^2
  EXPECT_EQ(value("shear_force", 0), 0.0);
  EXPECT_NEAR(std::abs(value("twist", 1)), 60.0, 1e-12);
  EXPECT_NEAR(value("twist", 1), -value("twist", 2), 1e-12);
  EXPECT_NEAR(value("bend", 1), 0.0, 1e-12);
  // torque of the EVM (bond 1) is B4 sin t, of the V-model (bond 2) B4/2 sin 2t
  EXPECT_NEAR(value("moment_i", 1), 0.00208333 * std::sin(pi / 3), 1e-15);
  EXPECT_NEAR(value("moment_j", 2), 0.00208333 / 2 * std::sin(2 * pi / 3), 1e-15);
  // particle 2 takes 1 along, 3 holds 2 back
  EXPECT_NEAR(value("torque", 1), 0.00208333 * std::sin(pi / 3), 1e-15);
  EXPECT_NEAR(value("torque", 2), -0.00208333 / 2 * std::sin(2 * pi / 3), 1e-15);
  EXPECT_NEAR(value("bending_moment", 1), 0.0, 1e-15);
  EXPECT_NEAR(value("U_T", 1), 0.00208333 * (1 - std::cos(pi / 3)), 1e-15);
  // 60 degrees are past the limit of the V-model (bonds 0 and 2), not of the EVM (bond 1)
  EXPECT_EQ(f.arrays.at("range").as<std::uint8_t>(), (std::vector<std::uint8_t>{0, 0, 1}));
}

TEST(BondFrame, ABondBentEvenlyHasOneMoment) {
  const Folder folder;
  Chain chain(2);
  chain.turn(0, {0, 0, 1}, -0.01);
  chain.turn(1, {0, 0, 1}, 0.01);
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced, {}, {.breaks = true});
  const VtpReader f(content_of(folder / "b.vtp"));
  const double end = f.arrays.at("moment_i").as<double>()[0];
  EXPECT_GT(end, 1e-5);
  EXPECT_NEAR(f.arrays.at("bending_moment").as<double>()[0], end, 1e-12 * end);
  EXPECT_NEAR(f.arrays.at("torque").as<double>()[0], 0.0, 1e-12 * end);
}

TEST(BondFrame, BodyWithoutBondsIsAValidFile) {
  const Folder folder;
  Chain chain(1);
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced);
  const VtpReader f(content_of(folder / "b.vtp"));
  expect_well_formed(f);
  EXPECT_EQ(f.lines, 0u);
  EXPECT_TRUE(f.arrays.at("elongation").bytes.empty());
}

/// A wall of each shape, after those of the chain: its centre is (4, 5, 6) and it has turned a quarter about
/// z.
struct Walled : Chain {
  Walled() {
    const double inf = std::numeric_limits<double>::infinity();
    const Vec3d z{0, 0, 1}, c{4, 5, 6};
    const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}}};
    model.walls = {{"table", PlaneWall{{9, 9, -2}, z}, 0, {}},   {"plate", DiscWall{c, z, 2.0}, 0, c},
                   {"tube", CylinderWall{c, z, 2.0, inf}, 0, c}, {"ring", CylinderWall{c, z, 2.0, 3.0}, 0, c},
                   {"ball", SphereWall{c, 2.0}, 0, c},           {"blade", MeshWall{mesh}, 0, {}}};
  }
  /// Points of the triangles of a wall.
  std::vector<Vec3d> corners_of(std::size_t wall, const VtpReader& f) const {
    const auto r = f.arrays.at("Points").as<double>();
    const auto id = f.arrays.at("id").integers(), at = f.arrays.at("connectivity").integers();
    std::vector<Vec3d> corners;
    for (std::size_t k = 0; k < at.size(); ++k)
      if (id[k / 3] == static_cast<std::int64_t>(wall)) {
        const auto p = static_cast<std::size_t>(3 * at[k]);
        corners.push_back({r[p], r[p + 1], r[p + 2]});
      }
    return corners;
  }
};

// Round shapes have their corners on the surface that particles feel; planes and endless cylinders end.
TEST(WallFrame, ShowsEveryShapeWhereItIs) {
  const Folder folder;
  Walled body;
  write_walls_vtp(folder / "w.vtp", body.model, body.state);
  const VtpReader f(content_of(folder / "w.vtp"));
  expect_well_formed(f);
  EXPECT_EQ(f.verts + f.lines, 0u);
  const Vec3d c{4, 5, 6};
  const auto radius = [&c](const Vec3d& x) { return std::hypot(x.x - c.x, x.y - c.y); };
  const BoundingBox box = body_at_start(body.model), table = box_around(body.corners_of(0, f)),
                    tube = box_around(body.corners_of(2, f)), ring = box_around(body.corners_of(3, f));
  EXPECT_EQ(table.low.z, -2.0);
  EXPECT_EQ(table.high.z, -2.0);
  EXPECT_NEAR(table.high.x - table.low.x, 1.5 * (box.high.x - box.low.x), 1e-14);
  EXPECT_NEAR(table.high.y - table.low.y, 1.5 * (box.high.y - box.low.y),
              1e-14);                                                      // not that of the longest side
  EXPECT_NEAR(table.high.y + table.low.y, box.high.y + box.low.y, 1e-14);  // below the middle of the body
  for (const Vec3d& x : body.corners_of(1, f)) EXPECT_EQ(x.z, 6.0);
  EXPECT_NEAR(box_around(body.corners_of(1, f)).high.x, 6.0, 1e-14);
  for (const std::size_t cylinder : {2, 3})
    for (const Vec3d& x : body.corners_of(cylinder, f)) EXPECT_NEAR(radius(x), 2.0, 1e-14);
  EXPECT_NEAR(tube.high.z - tube.low.z, box.diagonal(), 1e-14);
  EXPECT_NEAR(tube.high.z + tube.low.z, box.high.z + box.low.z, 1e-14);
  EXPECT_EQ(ring.low.z, 4.5);
  EXPECT_EQ(ring.high.z, 7.5);
  double volume = 0.0;  // of a closed surface: every triangle is there once and faces one way
  const auto ball = body.corners_of(4, f);
  for (std::size_t k = 0; k < ball.size(); k += 3) {
    EXPECT_NEAR(norm(ball[k] - c), 2.0, 1e-14);
    volume += std::abs(dot(ball[k] - c, cross(ball[k + 1] - c, ball[k + 2] - c))) / 6.0;
  }
  EXPECT_NEAR(volume / (4.0 / 3.0 * pi * 8.0), 1.0, 0.01);  // corners on it: 0.4 % less
  EXPECT_EQ(body.corners_of(5, f).size(), 6u);
}

TEST(WallFrame, MovesWithTheWallAndTellsItsLoads) {
  const Folder folder;
  Walled body;
  body.state.walls.resize(6);
  WallState& plate = body.state.walls[1];
  plate.displacement = {0, 0, -1}, plate.q = rotation_of({pi / 2, 0, 0});
  plate.force = {1, 2, 3}, plate.moment = {4, 5, 6}, plate.velocity = {0, 0, -0.5};
  write_walls_vtp(folder / "w.vtp", body.model, body.state);
  const VtpReader f(content_of(folder / "w.vtp"));
  const BoundingBox box = box_around(body.corners_of(1, f));
  EXPECT_NEAR(box.low.y, 5.0, 1e-14);  // its normal is along y now
  EXPECT_NEAR(box.high.y, 5.0, 1e-14);
  EXPECT_NEAR(box.low.z, 3.0, 1e-14);
  EXPECT_NEAR(box.high.z, 7.0, 1e-14);
  const auto of_first_triangle = [&f](const char* name) {  // of the plate: after the two of the table
    const auto x = f.arrays.at(name).as<double>();
    return std::vector<double>(x.begin() + 6, x.begin() + 9);
  };
  EXPECT_EQ(of_first_triangle("force"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(of_first_triangle("moment"), (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(of_first_triangle("velocity"), (std::vector<double>{0, 0, -0.5}));
  EXPECT_EQ(of_first_triangle("displacement"), (std::vector<double>{0, 0, -1}));
  EXPECT_NEAR(of_first_triangle("rotation")[0], pi / 2, 1e-15);
}

TEST(WallFrame, TellsWhichWallsTheStageHasTakenAway) {
  const Folder folder;
  Walled body;
  body.state.walls.resize(6);
  body.state.walls[1].off = 1;
  write_walls_vtp(folder / "w.vtp", body.model, body.state);
  const VtpReader f(content_of(folder / "w.vtp"));
  const auto id = f.arrays.at("id").integers(), off = f.arrays.at("off").integers();
  ASSERT_EQ(off.size(), id.size());
  for (std::size_t k = 0; k < id.size(); ++k) EXPECT_EQ(off[k], id[k] == 1 ? 1 : 0) << k;
}

/// A body whose numbers partly compress: positions on a line, random velocities, more than one block of 2^18
/// bytes.
Chain long_chain() {
  Chain chain(40'000);
  for (double& R : chain.model.radius) R = 0.3;
  std::uint64_t x = 1;
  for (const ParticleId p : chain.state.v.ids()) {
    x = x * 6364136223846793005u + 1442695040888963407u;
    chain.state.v[p] = {static_cast<double>(x >> 11) * 0x1p-53, 0.0, -0.0};
  }
  return chain;
}

TEST(FrameFormat, CompressedArraysAreTheSameNumbers) {
  const Folder folder;
  const Chain chain = long_chain();
  const FrameFormat plain{.compressed = false};
  write_particles_vtp(folder / "p.vtp", chain.model, chain.state);
  write_particles_vtp(folder / "p_plain.vtp", chain.model, chain.state, {}, plain);
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced);
  write_bonds_vtp(folder / "b_plain.vtp", chain.state, UnitSystem::reduced, {}, plain);
  for (const std::string name : {"p", "b"}) {
    const VtpReader zlib(content_of(folder / (name + ".vtp"))),
        none(content_of(folder / (name + "_plain.vtp")));
    expect_well_formed(zlib);
    expect_well_formed(none);
    EXPECT_TRUE(zlib.compressed);
    EXPECT_FALSE(none.compressed);
    ASSERT_EQ(zlib.arrays.size(), none.arrays.size());
    for (const auto& [key, array] : none.arrays) {
      EXPECT_EQ(zlib.arrays.at(key).bytes, array.bytes) << key;
      EXPECT_EQ(zlib.arrays.at(key).type, array.type) << key;
      EXPECT_LT(zlib.arrays.at(key).stored, array.stored + 200) << key;  // also of one that does not shrink
    }
    const auto part = [&](const std::string& key) {
      return static_cast<double>(zlib.arrays.at(key).stored) /
             static_cast<double>(none.arrays.at(key).stored);
    };
    // what is the same in each frame: deflate at its fastest needs a match of 3 bytes and a literal for each
    // of these 4-byte numbers, 1.4 bytes
    for (const char* key : {"connectivity", "offsets", "id"}) EXPECT_LT(part(key), 0.5) << key;
    const std::vector<std::string> alike = name == "p" ? std::vector<std::string>{"radius", "specimen"}
                                                       : std::vector<std::string>{"length_at_rest"};
    for (const std::string& key : alike) EXPECT_LT(part(key), 0.02) << key;
  }
}

TEST(FrameFormat, SinglePrecisionHalvesRealNumbersAndSaysSo) {
  const Folder folder;
  Chain chain;
  chain.state.r[ParticleId{1}] += Vec3d{1e-17, 0.25, -1.0 / 3.0};
  const FrameFormat single{.single_precision = true, .compressed = false};
  write_particles_vtp(folder / "p.vtp", chain.model, chain.state, {}, single);
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced, {}, single);
  for (const char* file : {"p.vtp", "b.vtp"}) {
    const VtpReader f(content_of(folder / file));
    expect_well_formed(f);
    for (const auto& [name, array] : f.arrays) EXPECT_NE(array.type, "Float64") << name;
  }
  const VtpReader f(content_of(folder / "p.vtp"));
  EXPECT_EQ(f.arrays.at("Points").as<float>()[5], static_cast<float>(-1.0 / 3.0));
  chain.state.v[ParticleId{0}].x = 1e39;
  try {
    write_particles_vtp(folder / "p.vtp", chain.model, chain.state, {}, single);
    ADD_FAILURE() << "a number became infinite";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("1e+39 of array \"velocity\""), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("precision = \"float64\""), std::string::npos) << e.what();
  }
}

TEST(FrameFormat, EveryArrayOfAQuantityWithAUnitSaysIt) {
  const Folder folder;
  Chain chain;
  for (const UnitSystem units : {UnitSystem::reduced, UnitSystem::si}) {
    chain.model.units = units;
    write_particles_vtp(folder / "p.vtp", chain.model, chain.state, {},
                        {.stress = true, .breaks = true, .cell = true, .wrap = true});
    write_bonds_vtp(folder / "b.vtp", chain.state, units, {},
                    {.breaks = true, .capsules = true, .flow = true, .cell = true});
    const VtpReader p(content_of(folder / "p.vtp")), b(content_of(folder / "b.vtp"));
    for (const ParticleQuantity& q : particle_quantities())
      EXPECT_EQ(p.arrays.at(q.name).unit, q.unit.in(units)) << q.name;
    for (const BondQuantity& q : bond_quantities())
      EXPECT_EQ(b.arrays.at(q.name).unit, q.unit.in(units)) << q.name;
    EXPECT_EQ(p.arrays.at("Points").unit, unit::length.in(units));
    EXPECT_EQ(p.arrays.at("velocity").unit, units == UnitSystem::si ? "m/s" : "a sqrt(c_A/m)");
    EXPECT_EQ(b.arrays.at("axial_force").unit, units == UnitSystem::si ? "N" : "a c_A");
    EXPECT_EQ(b.arrays.at("bend").unit, "deg");
    EXPECT_EQ(p.arrays.at("id").unit, "");
  }
}

// The particle in the middle has two bonds, each of which pulls at it with N at half its length.
TEST(Frames, HaveTheStressOfEachParticleWhereItIsAskedFor) {
  const Folder folder;
  Chain chain;
  for (const ParticleId p : chain.state.r.ids()) chain.state.r[p].x *= 1.01;
  write_particles_vtp(folder / "p.vtp", chain.model, chain.state, {}, {.stress = true});
  const VtpReader p(content_of(folder / "p.vtp"));
  const std::vector<double> normal = p.arrays.at("stress_normal").as<double>();
  ASSERT_EQ(normal.size(), 9u);
  EXPECT_NEAR(normal[3] * sphere_volume(chain.model, ParticleId{1}), 0.01 * 1.01, 1e-15);
  EXPECT_NEAR(normal[0] * sphere_volume(chain.model, ParticleId{0}), 0.5 * 0.01 * 1.01, 1e-15);
  EXPECT_NEAR(normal[4], 0.0, 1e-15);
  for (const double x : p.arrays.at("stress_shear").as<double>()) EXPECT_NEAR(x, 0.0, 1e-15);
  write_particles_vtp(folder / "q.vtp", chain.model, chain.state, {}, {});
  EXPECT_EQ(VtpReader(content_of(folder / "q.vtp")).arrays.count("stress_normal"), 0u);
}

}  // namespace
}  // namespace vbond
