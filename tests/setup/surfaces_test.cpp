#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "vbond/case/read.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond::surfaces_test {
namespace {

constexpr double pi = std::numbers::pi, half_root_3 = 0.5 * std::numbers::sqrt3;

/// A case of this one specimen, whose edges are bonds.
Case surface(const std::string& keys) {
  return parse_case(
      "[[specimen]]\nname = \"wall\"\n" + keys +
          "\nthickness = 0.01\ndensity = 3\n[[bonds]]\nfrom_specimen = true\ntheory = \"shell\"\n"
          "E = 1000\nnu = 0.3\nthickness = 0.01\n[[stage]]\nduration = 1\n",
      "case.toml");
}

Built built(const std::string& keys) {
  const Case c = surface(keys);
  const Built b = build(c);
  if (c.specimens[0].cut.empty()) {
    EXPECT_EQ(count_particles(c), static_cast<double>(b.model.particles()));
  }
  return b;
}

std::vector<int> neighbours(const Built& b) {
  std::vector<int> n(b.model.particles(), 0);
  for (const Bond& bond : b.state.bonds) ++n[bond.i.value], ++n[bond.j.value];
  return n;
}

std::size_t size_of(const Built& b, const std::string& group) {
  const Group* g = b.model.find_group(group);
  return g ? g->particles.size() : 0;
}

double area(const Built& b) {
  double mass = 0.0;
  for (const double m : b.model.mass) mass += m;
  return mass / (3 * 0.01);
}

/// The longest edge over the shortest among the bonds of one particle, at worst.
double unevenness(const Built& b) {
  std::map<ParticleId, std::array<double, 2>> edges;
  for (const Bond& bond : b.state.bonds)
    for (const ParticleId p : {bond.i, bond.j}) {
      auto& [least, most] = edges.try_emplace(p, std::array{bond.a, bond.a}).first->second;
      least = std::min(least, bond.a), most = std::max(most, bond.a);
    }
  double worst = 1.0;
  for (const auto& [p, e] : edges) worst = std::max(worst, e[1] / e[0]);
  return worst;
}

// 24 triangles fit the length exactly. Triangles of chords differ from those of arcs by (spacing/R)^2/24 =
// 3e-4 at most.
TEST(CylinderSpecimen, IsATriangularSheetRolledUp) {
  const double length = 24 * half_root_3 * 2 * pi / 48;
  const Built b = built("kind = \"cylinder\"\ncylinder_radius = 1\nparticles_around = 48\nlength = " +
                        std::to_string(length));
  ASSERT_EQ(b.model.particles(), 48u * 25u);
  EXPECT_EQ(b.state.bonds.size(), 48u * 25u + 2u * 48u * 24u);
  const std::vector<int> n = neighbours(b);
  EXPECT_EQ(std::count(n.begin(), n.end(), 6), 48 * 23);
  EXPECT_EQ(std::count(n.begin(), n.end(), 4), 48 * 2);
  for (const Vec3d& r : b.model.r_0) EXPECT_NEAR(std::hypot(r.x, r.y), 1.0, 1e-14);
  EXPECT_EQ(b.model.r_0[ParticleId{0}], (Vec3d{1, 0, 0}));
  EXPECT_LT(unevenness(b), 1.0 + 1e-3);
  EXPECT_NEAR(area(b) / (2 * pi * length), 1.0, 1e-3);
  EXPECT_EQ(size_of(b, "first"), 48u);
  EXPECT_EQ(size_of(b, "wall.ends"), 96u);
  EXPECT_EQ(b.model.find_group("sides"), nullptr);
  // half the area at the ends; m (h^2/12 + 5/72 l^2)
  const double l = 2 * pi / 48, m = 3 * 0.01 * half_root_3 * l * l;
  EXPECT_NEAR(b.model.mass[ParticleId{48 * 12}] / m, 1.0, 1e-3);
  EXPECT_NEAR(b.model.mass[ParticleId{0}] / m, 0.5, 1e-3);
  EXPECT_NEAR(b.model.inertia[ParticleId{48 * 12}] / (m * (1e-4 / 12 + 5 * l * l / 72)), 1.0, 2e-3);
}

// With a spacing the number around is chosen so that triangles fit the length: of seven numbers around one
// fits to a fourteenth of a row at least, here of some 17 rows: 0.4 %.
TEST(CylinderSpecimen, FitsItsTrianglesIntoItsLength) {
  for (const double length : {1.7, 1.75, 1.8, 1.85, 1.9}) {
    const Built b =
        built("kind = \"cylinder\"\ncylinder_radius = 1\nspacing = 0.06\nlength = " + std::to_string(length));
    EXPECT_LT(unevenness(b), 1.0 + 0.75 * 0.008 + 1e-3) << length;
    const Group* last = b.model.find_group("last");
    ASSERT_NE(last, nullptr);
    EXPECT_NEAR(b.model.r_0[last->particles[0]].z, length, 1e-12);
    EXPECT_NEAR(static_cast<double>(last->particles.size()), 2 * pi / 0.06, 0.03 * 2 * pi / 0.06 + 1);
  }
}

TEST(CylinderSpecimen, OfAnAngleIsAPanelWithStraightSides) {
  const Built b =
      built("kind = \"cylinder\"\ncylinder_radius = 2\nparticles_around = 9\nlength = 1\nangle = " +
            std::to_string(pi / 2) + "\naxis = [0, 3, 0]\norigin = [1, 1, 1]\n");
  EXPECT_EQ(size_of(b, "first"), 9u);
  const Group* sides = b.model.find_group("sides");
  ASSERT_NE(sides, nullptr);
  for (const ParticleId p : sides->particles) {
    const Vec3d r = b.model.r_0[p] - Vec3d{1, 1, 1};
    // z goes to y, and by that z to -... : x stays, y becomes -z
    EXPECT_NEAR(std::min(std::abs(r.x), std::abs(r.z)), 0.0, 1e-5);
  }
  for (const Vec3d& r : b.model.r_0) {
    EXPECT_NEAR(std::hypot(r.x - 1, r.z - 1), 2.0, 1e-12);
    EXPECT_GE(r.y, 1.0 - 1e-12);
    EXPECT_LE(r.y, 2.0 + 1e-12);
    EXPECT_GE(r.x, 1.0 - 1e-5);
    EXPECT_LE(r.z, 1.0 + 1e-5);
  }
}

// The map is conformal: triangles are equilateral up to the change of the radius from row to row.
TEST(ConeSpecimen, HasTrianglesInProportionToItsRadius) {
  const Built b = built("kind = \"cone\"\ncone_radii = [3, 1]\nlength = 2\nparticles_around = 100\n");
  const std::vector<int> n = neighbours(b);
  EXPECT_EQ(std::count(n.begin(), n.end(), 4), 200);
  for (const Bond& bond : b.state.bonds) {
    const Vec3d middle = 0.5 * (b.model.r_0[bond.i] + b.model.r_0[bond.j]);
    EXPECT_NEAR(bond.a / (2 * pi / 100 * std::hypot(middle.x, middle.y)), 1.0, 0.02);
  }
  const double slant = std::hypot(2.0, 2.0);
  EXPECT_NEAR(area(b) / (pi * (3 + 1) * slant), 1.0, 2e-3);
  const Group* last = b.model.find_group("last");
  ASSERT_NE(last, nullptr);
  for (const ParticleId p : last->particles) {
    EXPECT_NEAR(std::hypot(b.model.r_0[p].x, b.model.r_0[p].y), 1.0, 1e-14);
    EXPECT_NEAR(b.model.r_0[p].z, 2.0, 1e-14);
  }
}

TEST(ConeSpecimen, OfEqualRadiiIsACylinder) {
  const Built cone = built("kind = \"cone\"\ncone_radii = [1, 1]\nlength = 2\nspacing = 0.2\n"),
              cylinder = built("kind = \"cylinder\"\ncylinder_radius = 1\nlength = 2\nspacing = 0.2\n");
  EXPECT_EQ(cone.model.r_0, cylinder.model.r_0);
}

TEST(SphereSpecimen, IsClosed) {
  const Built b = built("kind = \"sphere\"\nsphere_radius = 2\nspacing = 0.3\ncentre = [0, 0, 5]\n");
  const std::size_t N = b.model.particles();
  EXPECT_EQ(b.state.bonds.size(), 3 * N - 6);
  const std::vector<int> n = neighbours(b);
  EXPECT_EQ(std::count(n.begin(), n.end(), 5), 12);
  EXPECT_EQ(static_cast<std::size_t>(std::count(n.begin(), n.end(), 6)), N - 12);
  for (const Vec3d& r : b.model.r_0) EXPECT_NEAR(norm(r - Vec3d{0, 0, 5}), 2.0, 1e-14);
  double length = 0.0;
  for (const Bond& bond : b.state.bonds) length += bond.a / static_cast<double>(b.state.bonds.size());
  EXPECT_NEAR(length, 0.3, 0.02);
  EXPECT_NEAR(area(b) / (4 * pi * 4), 1.0, 0.01);  // chords: 1 - (l/R)^2/4 or so
  const Group *first = b.model.find_group("first"), *last = b.model.find_group("last");
  ASSERT_TRUE(first != nullptr && last != nullptr);
  EXPECT_EQ(b.model.r_0[first->particles[0]], (Vec3d{0, 0, 7}));
  EXPECT_EQ(b.model.r_0[last->particles[0]], (Vec3d{0, 0, 3}));
  EXPECT_LT(unevenness(b), 1.19);  // measured 1.175 at the twelve corners, for any number of particles
}

TEST(SphereSpecimen, BetweenTwoAnglesIsAZone) {
  const Built b = built("kind = \"sphere\"\nsphere_radius = 1\nspacing = 0.05\npolar = [0.9, 1.9]\n");
  EXPECT_NEAR(area(b) / (2 * pi * (std::cos(0.9) - std::cos(1.9))), 1.0, 2e-3);
  EXPECT_LT(unevenness(b), 1.05);
  for (const Bond& bond : b.state.bonds) {
    const Vec3d middle = 0.5 * (b.model.r_0[bond.i] + b.model.r_0[bond.j]);
    EXPECT_NEAR(bond.a / 0.05 / std::hypot(middle.x, middle.y), 1.0, 0.05);
  }
  const Built panel =
      built("kind = \"sphere\"\nsphere_radius = 1\nspacing = 0.05\npolar = [0.9, 1.9]\nangle = 1.2\n");
  EXPECT_NEAR(area(panel) / (1.2 * (std::cos(0.9) - std::cos(1.9))), 1.0, 0.03);  // zigzag within the sides
  EXPECT_GT(size_of(panel, "sides"), 10u);
}

TEST(Surfaces, AreCutWithTheirBonds) {
  const Built b = built(
      "kind = \"sphere\"\nsphere_radius = 1\nspacing = 0.2\n"
      "cut = [{ half_space = { point = [0, 0, -1e-9], normal = [0, 0, 1] } }]\n");
  for (const Vec3d& r : b.model.r_0) EXPECT_GE(r.z, -1e-9);
  for (const Bond& bond : b.state.bonds) EXPECT_LT(norm(b.model.r_0[bond.i] - b.model.r_0[bond.j]), 0.3);
  const std::vector<int> n = neighbours(b);
  EXPECT_GE(*std::min_element(n.begin(), n.end()), 3);
  EXPECT_LT(area(b) / (2 * pi), 1.1);
}

TEST(Surfaces, AreTooLargeOnlyIfTheyAre) {
  const Case c = surface("kind = \"cylinder\"\ncylinder_radius = 1\nspacing = 1e-6\nlength = 1\n");
  EXPECT_THROW(build(c), CaseError);
  EXPECT_GT(count_particles(c), 1e8);
}

TEST(SheetSpecimen, OfAThicknessHasTheMassOfItsTriangles) {
  for (const char* lattice : {"triangular", "square"}) {
    const Case c =
        parse_case("[[specimen]]\nkind = \"sheet\"\nparticles = [7, 5]\nspacing = 0.5\nlattice = \"" +
                       std::string(lattice) +
                       "\"\nthickness = 0.1\ndensity = 2\n[[bonds]]\ndistance = 0.51\n"
                       "theory = \"shell\"\nE = 1\nnu = 0\nthickness = 0.1\n[[stage]]\nduration = 1\n",
                   "case.toml");
    const Built b = build(c);
    const double cell = lattice[0] == 's' ? 0.25 : half_root_3 * 0.25;
    double mass = 0.0;
    for (const double m : b.model.mass) mass += m;
    EXPECT_NEAR(mass, 0.2 * 24 * cell, 1e-14);
    EXPECT_NEAR(b.model.mass[ParticleId{2 * 7 + 3}], 0.2 * cell, 1e-15);
  }
}

void expect_refused(const std::string& specimen, const std::string& bonds, const std::string& because) {
  std::string report;
  try {
    build(parse_case("[[specimen]]\n" + specimen + "\n[[bonds]]\n" + bonds + "\n[[stage]]\nduration = 1\n",
                     "case.toml"));
  } catch (const CaseError& e) {
    report = e.what();
  }
  EXPECT_NE(report.find(because), std::string::npos) << specimen << bonds << "\nwas met with: " << report;
}

TEST(Surfaces, AreRefusedWhereTheyMakeNoSense) {
  const std::string bonds = "from_specimen = true\nstiffness = {c_A = 1, c_D = 1, c_B = 1, c_T = 1}",
                    wall = "thickness = 0.1\ndensity = 1\n",
                    cylinder = wall + "kind = \"cylinder\"\ncylinder_radius = 1\nlength = 1\n",
                    sphere = wall + "kind = \"sphere\"\nsphere_radius = 1\n";
  expect_refused(cylinder, bonds, "exactly one of spacing and particles_around");
  expect_refused(cylinder + "spacing = 0.1\nparticles_around = 9", bonds,
                 "exactly one of spacing and particles_around");
  expect_refused(cylinder + "particles_around = 2", bonds, "at least 3 on a closed circle");
  expect_refused(cylinder + "spacing = 0.1\nangle = 7", bonds, "angle");
  expect_refused(sphere + "particles_around = 9", bonds, "belong to a zone or panel");
  expect_refused(sphere + "spacing = 0.1\nangle = 1", bonds, "belong to a zone or panel");
  expect_refused(sphere + "spacing = 0.1\npolar = [1, 0.5]", bonds, "smaller than the second");
  expect_refused(sphere + "spacing = 0.1\npolar = [0, 0.5]", bonds, "polar");
  expect_refused("kind = \"rod\"\nparticles = 3\nmass = 1\ninertia = 1\nthickness = 0.1", bonds, "thickness");
  expect_refused("kind = \"sheet\"\nparticles = [3, 3]\nmass = 1\ninertia = 1\nthickness = 0.1", bonds,
                 "add density, or leave out thickness");
  expect_refused("kind = \"sheet\"\nparticles = [3, 3]\nmass = 1\ninertia = 1", bonds,
                 "no specimen brings bonds");
  expect_refused(cylinder + "spacing = 0.2\nname = \"tube\"", bonds + "\nbond_type = 1",
                 "the bonds that the specimens bring have no types");
  expect_refused(cylinder + "spacing = 0.2\nname = \"tube\"",
                 bonds + "\nbetween = [\"tube.first\", \"tube.last\"]",
                 "none joins the groups \"tube.first\" and \"tube.last\"");
  const std::string shell = "from_specimen = true\ntheory = \"shell\"\nE = 1\n",
                    net = cylinder + "spacing = 0.2";
  expect_refused(net, shell + "thickness = 0.1\nnu = 0.34", "-1 < nu < 1/3");
  expect_refused(net, shell + "nu = 0.3", "thickness");
  expect_refused(net, shell + "thickness = 0.1\nnu = 0.3\nsection = {shape = \"circle\", diameter = 1}",
                 "section");
  expect_refused(
      net, shell + "thickness = 0.1\nnu = 0.3\nstrength = {criterion = \"stress\", tension = 1, shear = 1}",
      "stresses need a section");
}

}  // namespace
}  // namespace vbond::surfaces_test
