#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "vbond/case/read.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::random_surfaces_test {
namespace {

Case surface(const std::string& keys) {
  return parse_case(
      "[[specimen]]\nname = \"wall\"\n" + keys +
          "\nthickness = 0.1\ndensity = 3\n[[bonds]]\nfrom_specimen = true\ntheory = \"shell\"\n"
          "E = 1000\nnu = 0.3\nthickness = 0.1\n[[stage]]\nduration = 1\n",
      "case.toml");
}
std::string refusal(const std::string& keys) {
  try {
    build(surface(keys));
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}
std::size_t size_of(const Built& b, const char* group) {
  const Group* g = b.model.find_group(group);
  return g ? g->particles.size() : 0;
}
double area(const Built& b) {
  double mass = 0.0;
  for (const double m : b.model.mass) mass += m;
  return mass / (3 * 0.1);
}
double length(const Built& b, const Bond& bond) {
  return norm(b.model.r_0[bond.j] - b.model.r_0[bond.i]);
}
double mean_edge(const Built& b) {
  double sum = 0.0;
  for (const Bond& bond : b.state.bonds) sum += length(b, bond) / double(b.state.bonds.size());
  return sum;
}
double least_distance(const Built& b) {
  double least = INFINITY;
  for (const Vec3d& p : b.model.r_0)
    for (const Vec3d& q : b.model.r_0)
      if (&p != &q) least = std::min(least, norm(p - q));
  return least;
}

/// Two points with nothing in the ball between them are joined by an edge of Delaunay's triangles.
void expect_gabriel_edges(const Built& b) {
  std::set<std::pair<std::size_t, std::size_t>> edges;
  for (const Bond& bond : b.state.bonds)
    edges.insert(std::minmax({std::size_t{bond.i.value}, std::size_t{bond.j.value}}));
  EXPECT_EQ(edges.size(), b.state.bonds.size());
  const auto& r = b.model.r_0.values();
  std::size_t found = 0;
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j) {
      const Vec3d middle = 0.5 * (r[i] + r[j]);
      const double radius2 = norm2(r[j] - r[i]) / 4;
      const bool empty = std::none_of(r.begin(), r.end(), [&](const Vec3d& p) {
        return &p != &r[i] && &p != &r[j] && norm2(p - middle) < radius2 * (1 + 1e-9);
      });
      if (!empty) continue;
      ++found;
      EXPECT_EQ(edges.count({i, j}), 1u) << i << " " << j;
    }
  EXPECT_GT(found, r.size()) << "a body of this kind has some 2.3 for each point";
}

const std::string sheet =
    "kind = \"sheet\"\nlattice = \"random\"\nsize = [15, 10]\nspacing = 1\norigin = [1, 2, 3]";

// A triangulated disc has 3 inner points + 2 border points - 3 edges. 300 steps of pushing bring the nearest
// pair to some 0.8 of the spacing.
TEST(RandomSheet, IsTriangulatedWithoutHolesOrFolds) {
  const Built b = build(surface(sheet));
  const std::size_t N = b.model.particles(), rim = size_of(b, "rim");
  EXPECT_EQ(rim, 50u);
  EXPECT_EQ(b.state.bonds.size(), 3 * (N - rim) + 2 * rim - 3);
  EXPECT_NEAR(area(b), 150.0, 1e-10) << "triangles add up to the rectangle";
  EXPECT_NEAR(mean_edge(b), 1.0, 0.05);
  EXPECT_GT(least_distance(b), 0.6);
  expect_gabriel_edges(b);
  double cos_2phi = 0.0, sin_2phi = 0.0;
  for (const Bond& bond : b.state.bonds) {
    const Vec3d e = normalised(b.model.r_0[bond.j] - b.model.r_0[bond.i]);
    cos_2phi += (e.x * e.x - e.y * e.y) / double(b.state.bonds.size());
    sin_2phi += 2 * e.x * e.y / double(b.state.bonds.size());
  }
  EXPECT_LT(std::hypot(cos_2phi, sin_2phi), 0.15) << "no direction is preferred, but for the border";
  for (const Vec3d& r : b.model.r_0) {
    EXPECT_EQ(r.z, 3.0);
    EXPECT_GE(std::min(r.x - 1, r.y - 2), 0.0);
    EXPECT_LE(r.x, 16.0);
    EXPECT_LE(r.y, 12.0);
  }
}

TEST(RandomSheet, IsTheSameEveryTimeAndAnotherOneWithAnotherSeed) {
  const Built a = build(surface(sheet)), b = build(surface(sheet)),
              other = build(surface(sheet + "\nseed = 2"));
  EXPECT_EQ(a.model.r_0.values(), b.model.r_0.values());
  EXPECT_NE(a.model.r_0.values(), other.model.r_0.values());
}

// Borders in even steps make rectangles of one row, whose four corners are on a circle.
TEST(RandomSheet, OfOneRowHasOneDiagonalForEachRectangle) {
  const Built b = build(surface("kind = \"sheet\"\nlattice = \"random\"\nsize = [6, 0.8]\nspacing = 1"));
  EXPECT_EQ(b.model.particles(), 14u);
  EXPECT_EQ(b.state.bonds.size(), 2u * 14u - 3u);
  EXPECT_NEAR(area(b), 4.8, 1e-12);
}

TEST(RandomCylinder, IsAStripRolledUp) {
  const Built b = build(
      surface("kind = \"cylinder\"\nlattice = \"random\"\ncylinder_radius = 3\nlength = 9\nspacing = 1"));
  const std::size_t N = b.model.particles(), rim = size_of(b, "ends");
  EXPECT_EQ(rim, 38u);  // twice round(6 pi)
  EXPECT_EQ(size_of(b, "first"), 19u);
  EXPECT_EQ(b.state.bonds.size(), 3 * (N - rim) + 2 * rim);
  for (const Vec3d& r : b.model.r_0) EXPECT_NEAR(std::hypot(r.x, r.y), 3.0, 1e-13);
  // chords are shorter than arcs by (edge/R)^2/24, where an edge goes around
  EXPECT_NEAR(area(b) / (2 * std::numbers::pi * 3 * 9), 1.0, 0.01);
  EXPECT_LT(area(b), 2 * std::numbers::pi * 3 * 9);
  EXPECT_GT(least_distance(b), 0.6);
}

TEST(RandomCylinder, MayBeAPanel) {
  const Built b =
      build(surface("kind = \"cylinder\"\nlattice = \"random\"\ncylinder_radius = 6\nlength = 9\nspacing = "
                    "1\nangle = 1.5\naxis = [1, 0, 0]"));
  const std::size_t N = b.model.particles(), rim = 2 * 10 + 2 * 8;
  EXPECT_EQ(size_of(b, "ends"), 20u);
  EXPECT_EQ(size_of(b, "sides"), 20u);
  EXPECT_EQ(b.state.bonds.size(), 3 * (N - rim) + 2 * rim - 3);
  for (const Vec3d& r : b.model.r_0) EXPECT_NEAR(std::hypot(r.y, r.z), 6.0, 1e-13);
}

TEST(RandomSphere, IsTheHullOfItsPoints) {
  const Built b = build(
      surface("kind = \"sphere\"\nlattice = \"random\"\nsphere_radius = 5\nspacing = 1\ncentre = [1, 0, 0]"));
  const std::size_t N = b.model.particles();
  EXPECT_NEAR(double(N), 4 * std::numbers::pi * 25 / (std::numbers::sqrt3 / 2), 3.0);
  EXPECT_EQ(b.state.bonds.size(), 3 * N - 6);
  for (const Vec3d& r : b.model.r_0) EXPECT_NEAR(norm(r - Vec3d{1, 0, 0}), 5.0, 1e-13);
  EXPECT_NEAR(mean_edge(b), 1.0, 0.05);
  EXPECT_GT(least_distance(b), 0.6);
  EXPECT_NEAR(area(b) / (4 * std::numbers::pi * 25), 1.0, 0.02);
  expect_gabriel_edges(b);
}

TEST(RandomSurfaces, RefuseWhatTheyCannotBe) {
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(contains(
      refusal("kind = \"cylinder\"\nlattice = \"random\"\ncylinder_radius = 1\nlength = 9\nspacing = 1"),
      "8 at least"));
  EXPECT_TRUE(contains(refusal("kind = \"sphere\"\nlattice = \"random\"\nsphere_radius = 1\nspacing = 1"),
                       "1.5 at least"));
  EXPECT_TRUE(contains(
      refusal("kind = \"sphere\"\nlattice = \"random\"\nsphere_radius = 5\nspacing = 1\npolar = [0.5, 1]"),
      "random particles are those of a closed sphere"));
  EXPECT_TRUE(contains(refusal("kind = \"cylinder\"\nlattice = \"random\"\ncylinder_radius = 5\nlength = "
                               "9\nparticles_around = 20"),
                       "a random lattice goes by the spacing"));
  EXPECT_TRUE(contains(
      refusal("kind = \"sheet\"\nlattice = \"random\"\nsize = [5, 5]\nparticles = [2, 2]\nspacing = 1"),
      "particles"));
}

// From some sheets of a few spacings to many, whatever their shape: the counts above hold, or they are
// refused.
TEST(RandomSurfaces, OfAnySizeAndSeedAreTriangulations) {
  int refused = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    const double x = 0.4 + 0.37 * seed, y = 0.5 + 7.0 * (seed % 7) / 7.0;
    const std::string keys = "kind = \"sheet\"\nlattice = \"random\"\nsize = [" + std::to_string(x) + ", " +
                             std::to_string(y) + "]\nspacing = 1\nseed = " + std::to_string(seed);
    try {
      const Built b = build(surface(keys));
      const std::size_t N = b.model.particles(), rim = size_of(b, "rim");
      EXPECT_EQ(b.state.bonds.size() + 3, 3 * (N - rim) + 2 * rim) << keys;
      EXPECT_NEAR(area(b) / (x * y), 1.0, 1e-9) << keys;
    } catch (const CaseError&) {
      ++refused;
    }
  }
  EXPECT_EQ(refused, 0);
}

}  // namespace
}  // namespace vbond::random_surfaces_test
