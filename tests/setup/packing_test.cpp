#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "temporary_folder.hpp"
#include "vbond/case/read.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::packing_test {
namespace {

const char* const some_case = R"([[specimen]]
name = "rock"
kind = "packing"
grains = [{name = "coarse", radius = 1.0, density = 3.0}, {name = "fine", radii = [0.5, 0.6], density = 1.5}]
VESSEL
porosity = 0.5
[[stage]]
name = "wait"
duration = 1
)";

Case case_in(const std::string& vessel, const std::string& more = "",
             const std::vector<std::string>& changes = {}) {
  std::string text = some_case;
  text.replace(text.find("VESSEL"), 6, vessel);
  return parse_case(text + more, "case.toml", changes);
}

std::string error_of(const std::string& vessel, const std::string& more,
                     const std::vector<std::string>& changes) {
  try {
    build(case_in(vessel, more, changes));
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

const std::string box = "vessel = [{box = {min = [0, 0, 0], max = [8, 9, 10]}}]";

TEST(PackingSpecimen, FillsARegionWithKindsThatAreGroups) {
  const Built b = build(case_in(box));
  double volume = 0.0, mass = 0.0;
  for (const ParticleId p : b.model.radius.ids()) {
    const double R = b.model.radius[p], V = 4.0 / 3.0 * std::numbers::pi * R * R * R;
    const Vec3d& r = b.model.r_0[p];
    volume += V;
    const double least = std::min({r.x, r.y, r.z, 8.0 - r.x, 9.0 - r.y, 10.0 - r.z});
    EXPECT_GT(least, R * (1.0 - 1e-3));
    EXPECT_DOUBLE_EQ(b.model.mass[p] / V, R > 0.8 ? 3.0 : 1.5);
    mass += b.model.mass[p];
  }
  EXPECT_NEAR(1.0 - volume / 720.0, 0.5, 1e-4);
  const Group *coarse = b.model.find_group("coarse"), *fine = b.model.find_group("rock.fine");
  ASSERT_TRUE(coarse && fine);
  EXPECT_EQ(coarse->particles.size() + fine->particles.size(), b.model.particles());
  ASSERT_EQ(b.packings.size(), 1u);
  EXPECT_NEAR(b.packings[0].second.is.porosity, 0.5, 1e-4);
  EXPECT_NE(b.notes.at(0).find("porosity 0.5"), std::string::npos) << b.notes[0];
}

TEST(PackingSpecimen, FillsTheCellAroundAnObstacleAndBetweenWalls) {
  const std::string cell = "[cell]\na = [9, 0, 0]\nb = [0, 9, 0]\nc = [0, 0, 9]\nopen = [\"c\"]\n";
  const Built b = build(case_in(
      "vessel = [{cylinder = {from = [4, 4, -5], to = [4, 4, 15], radius = 2}, keep = \"outside\"}]", cell));
  for (const ParticleId p : b.model.radius.ids()) {
    const double R = b.model.radius[p] * (1.0 - 1e-3);
    const Vec3d& r = b.model.r_0[p];
    EXPECT_GT(std::min(r.z, 9.0 - r.z), R);
    EXPECT_GT(std::hypot(r.x - 4.0, r.y - 4.0), 2.0 + R);
  }
  EXPECT_NEAR(b.packings[0].second.is.volume / (9.0 * (81.0 - 4.0 * std::numbers::pi)), 1.0, 2e-4);
}

TEST(PackingSpecimen, FillsAClosedMesh) {
  const test::TemporaryFolder folder("vbond_packing");
  const auto file = folder.path() / "l.obj";  // an L, whose inner edge is no wall to go around the corner of
  {
    std::ofstream out(file);
    const double x[] = {0, 10, 10, 5, 5, 0}, y[] = {0, 0, 5, 5, 10, 10};
    for (const int z : {0, 12})
      for (int k = 0; k < 6; ++k) out << "v " << x[k] << ' ' << y[k] << ' ' << z << '\n';
    const int triangles[][3] = {{1, 2, 3}, {1, 3, 4}, {1, 4, 5}, {1, 5, 6}};
    for (const auto& t : triangles)
      out << "f " << t[0] << ' ' << t[2] << ' ' << t[1] << "\nf " << t[0] + 6 << ' ' << t[1] + 6 << ' '
          << t[2] + 6 << '\n';
    for (int k = 1; k <= 6; ++k) {
      const int n = k % 6 + 1;
      out << "f " << k << ' ' << n << ' ' << n + 6 << "\nf " << k << ' ' << n + 6 << ' ' << k + 6 << '\n';
    }
  }
  const Built b = build(case_in("vessel = [{mesh = {file = \"" + file.string() + "\"}}]"));
  for (const ParticleId p : b.model.radius.ids()) {
    const double R = b.model.radius[p] * (1.0 - 1e-3);
    const Vec3d& r = b.model.r_0[p];
    EXPECT_GT(std::min({r.x, r.y, r.z, 10.0 - r.x, 10.0 - r.y, 12.0 - r.z}), R);
    EXPECT_FALSE(r.x > 5.0 && r.y > 5.0);
    EXPECT_TRUE(5.0 - r.x > R || 5.0 - r.y > R ||
                (r.x <= 5.0 && r.y <= 5.0 && std::hypot(5.0 - r.x, 5.0 - r.y) > R))
        << r.x << " " << r.y << " " << R;
  }
  EXPECT_NEAR(b.packings[0].second.is.volume / 900.0, 1.0, 2e-4);
}

TEST(PackingSpecimen, WhatIsWrongIsToldWithItsPlaceAndAWayOut) {
  EXPECT_NE(error_of("", "", {}).find("without a vessel"), std::string::npos);
  EXPECT_NE(error_of("vessel = [{half_space = {point = [0, 0, 0], normal = [0, 0, 1]}}]", "", {})
                .find("without an end"),
            std::string::npos);
  const std::string dense = error_of(box, "", {"specimen[0].porosity=0.2"});
  EXPECT_NE(dense.find("case.toml:"), std::string::npos) << dense;
  EXPECT_NE(dense.find("can be had"), std::string::npos) << dense;
  const std::string cell = "[cell]\na = [9, 0, 0]\nb = [0, 9, 0]\nc = [0, 0, 9]\n";
  EXPECT_NE(
      error_of("vessel = [{sphere = {centre = [4, 4, 8], radius = 4}}]", cell, {}).find("does not go on"),
      std::string::npos);
  EXPECT_NE(error_of(box, "", {"specimen[0].particles=4"}).find("exactly one of"), std::string::npos);
  EXPECT_NE(error_of(box, "", {"specimen[0].density=4"}).find("each kind of grains"), std::string::npos);
  EXPECT_NE(error_of(box, "", {"specimen[0].radius=4"}).find("those of its grains"), std::string::npos);
}

}  // namespace
}  // namespace vbond::packing_test
