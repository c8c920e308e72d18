#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "campaigns/dice.hpp"
#include "packing/plain_packing.hpp"
#include "packing/plain_voronoi.hpp"

namespace vbond::packing::voronoi_test {
namespace {

using namespace packing::testing;
using vbond::testing::Dice;

constexpr double pi = std::numbers::pi;

/// Faces of one cell that are not slivers of rounding, in order of their areas.
std::vector<double> areas_of(const VoronoiCells& cells, std::size_t i) {
  std::vector<double> areas;
  for (const VoronoiFace& f : cells.faces_of(i))
    if (f.area > 1e-9) areas.push_back(f.area);
  std::sort(areas.begin(), areas.end());
  return areas;
}

/// Cubic cells of edge 1, three in each direction.
VoronoiCells cells_of_lattice(const std::vector<Vec3d>& basis) {
  std::vector<Vec3d> r;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z)
        for (const Vec3d& b : basis) r.push_back(Vec3d{double(x), double(y), double(z)} + b);
  return voronoi_cells(*space_of(cube(3)), r, std::vector(r.size(), 0.3));
}

TEST(Voronoi, LatticesHaveTheirPolyhedra) {
  const VoronoiCells sc = cells_of_lattice({{0, 0, 0}}), bcc = cells_of_lattice({{0, 0, 0}, {0.5, 0.5, 0.5}}),
                     fcc = cells_of_lattice({{0, 0, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}});
  const double hexagon = 3.0 * std::sqrt(3.0) / 16.0, rhombus = std::sqrt(2.0) / 8.0;
  for (std::size_t i = 0; i < sc.volume.size(); ++i) {
    EXPECT_NEAR(sc.volume[i], 1.0, 1e-14);
    const std::vector<double> areas = areas_of(sc, i);
    ASSERT_EQ(areas.size(), 6u);  // a cube
    for (const double area : areas) EXPECT_NEAR(area, 1.0, 1e-13);
  }
  for (std::size_t i = 0; i < bcc.volume.size(); ++i) {
    EXPECT_NEAR(bcc.volume[i], 0.5, 1e-14);
    const std::vector<double> areas = areas_of(bcc, i);
    ASSERT_EQ(areas.size(), 14u);  // a truncated octahedron
    for (std::size_t k = 0; k < 14; ++k) EXPECT_NEAR(areas[k], k < 6 ? 0.125 : hexagon, 1e-13);
  }
  for (std::size_t i = 0; i < fcc.volume.size(); ++i) {
    EXPECT_NEAR(fcc.volume[i], 0.25, 1e-14);
    const std::vector<double> areas = areas_of(fcc, i);
    ASSERT_EQ(areas.size(), 12u);  // a rhombic dodecahedron
    for (const double area : areas) EXPECT_NEAR(area, rhombus, 1e-13);
  }
}

TEST(Voronoi, TheLargerSphereHasTheLargerCell) {
  // the plane of equal d^2 - R^2 is (R_1^2 - R_2^2)/(2 d) beyond the middle
  const VoronoiCells cells =
      voronoi_cells(*space_of(box({4, 1, 1})), {{1, 0.5, 0.5}, {3, 0.5, 0.5}}, {0.9, 0.3});
  const double plane = 2.0 + (0.81 - 0.09) / 4.0;
  EXPECT_NEAR(cells.volume[0], plane, 1e-14);
  EXPECT_NEAR(cells.volume[1], 4.0 - plane, 1e-14);
  ASSERT_EQ(cells.faces.size(), 2u);
  EXPECT_EQ(cells.faces[0].of, 1u);
  EXPECT_NEAR(cells.faces[0].area, 1.0, 1e-14);
  // one that lies deep enough in another has no place left, and no faces
  const VoronoiCells hidden =
      voronoi_cells(*space_of(box({4, 1, 1})), {{1, 0.5, 0.5}, {1.1, 0.5, 0.5}}, {3.0, 0.3});
  EXPECT_NEAR(hidden.volume[0], 4.0, 1e-14);
  EXPECT_EQ(hidden.volume[1], 0.0);
  EXPECT_TRUE(hidden.faces.empty());
}

TEST(Voronoi, AParticleAloneInACellMeetsItsImages) {
  const Vessel v = periodic_cell({2, 0, 0}, {0.3, 1.5, 0}, {-0.2, 0.4, 1});
  const VoronoiCells cells = voronoi_cells(*space_of(v), {{7.1, -3.2, 0.4}}, {0.2});
  EXPECT_NEAR(cells.volume[0], 3.0, 1e-14);
  ASSERT_EQ(cells.faces.size(), 14u);     // any lattice without symmetry has a parallelohedron of 14 faces
  for (std::size_t k = 0; k < 14; ++k) {  // in order of the images, of which each has its opposite
    EXPECT_EQ(cells.faces[k].image, -cells.faces[13 - k].image);
    EXPECT_NEAR(cells.faces[k].area, cells.faces[13 - k].area, 1e-14);
  }
}

struct Body {
  Vessel vessel;
  double volume;
  std::vector<Vec3d> r;
  std::vector<double> R;
};

/// Random places, 2 % of the frame's edges and more within walls.
Body random_body(Vessel vessel, double volume, std::size_t count, unsigned seed) {
  Dice dice(seed);
  Body b{std::move(vessel), volume, {}, {}};
  while (b.r.size() < count) {
    const Vec3d r = b.vessel.at({dice(0, 1), dice(0, 1), dice(0, 1)});
    if (!(b.vessel.depth(r) > 0.02)) continue;
    b.r.push_back(r), b.R.push_back(0.3 * std::cbrt(volume / double(count)) * dice(0.2, 1.0));
  }
  return b;
}

std::vector<Body> bodies(std::size_t count) {
  std::vector<Body> all;
  all.push_back(random_body(box({1, 2, 3}), 6.0, count, 1));
  all.push_back(
      random_body(periodic_cell({2, 0, 0}, {0.7, 1.5, 0}, {-0.5, 0.4, 1}, {5, 6, 7}), 3.0, count, 2));
  all.push_back(random_body(cylinder(1.3, 4), pi * 1.69 * 4, count, 3));
  all.push_back(random_body(hollow_ball(2), 32.0 / 3.0 * pi, count, 4));
  return all;
}

TEST(Voronoi, VolumesAddUpAndFacesAreSeenAlikeFromBothSides) {
  for (const Body& b : bodies(2000)) {
    const VoronoiCells cells = voronoi_cells(*space_of(b.vessel), b.r, b.R);
    EXPECT_NEAR(std::accumulate(cells.volume.begin(), cells.volume.end(), 0.0) / b.volume, 1.0, 1e-12);
    const double area = std::pow(b.volume / 2000, 2.0 / 3.0);
    for (std::size_t i = 0; i < b.r.size(); ++i)
      for (const VoronoiFace& f : cells.faces_of(i)) {
        double back = 0.0;
        for (const VoronoiFace& g : cells.faces_of(f.of))
          if (g.of == i && g.image == -f.image) back = g.area;
        EXPECT_NEAR(back, f.area, 1e-11 * area);
      }
  }
}

/// A plane then cuts off hundreds of corners that the many planes of the wall have made.
TEST(Voronoi, VolumesOfFewInRoundVesselsAddUp) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const double length = 0.5 + 0.25 * seed;
    const std::size_t count = 2 + seed % 30;
    for (const Body& b : {random_body(cylinder(1, length), pi * length, count, seed),
                          random_body(hollow_ball(1), 4.0 / 3.0 * pi, count, seed)}) {
      const VoronoiCells cells = voronoi_cells(*space_of(b.vessel), b.r, b.R);
      const double sum = std::accumulate(cells.volume.begin(), cells.volume.end(), 0.0);
      EXPECT_NEAR(sum / b.volume, 1.0, 1e-12) << seed;
    }
  }
}

/// The plane between them is the end of a prism with 400 sides, so that it takes all of the outer one's cell:
/// voro++ crashed.
TEST(Voronoi, OfAnOuterOneBehindAFaceWithManyCornersHasNoVolume) {
  constexpr int sides = 400;
  VoronoiSpace space;
  space.corner = {-2, -2, -2}, space.edges = {Vec3d{4, 0, 0}, Vec3d{0, 4, 0}, Vec3d{0, 0, 4}};
  for (int k = 0; k < sides; ++k)
    space.planes.push_back({{std::cos(2 * pi * k / sides), std::sin(2 * pi * k / sides), 0}, 1});
  space.planes.push_back({{0, 0, 1}, 0}), space.planes.push_back({{0, 0, -1}, 1});
  const VoronoiCells cells = voronoi_cells(space, {{0, 0, 0.25}, {0, 0, -0.25}}, {0.1, 0.1});
  EXPECT_EQ(cells.volume[0], 0.0);
  EXPECT_NEAR(cells.volume[1], sides * std::tan(pi / sides), 1e-13);
}

TEST(Voronoi, OneParticleFarFromAllOthersChangesNothing) {
  Dice dice(7);
  std::vector<Vec3d> r;
  for (int k = 0; k < 300; ++k) r.push_back(dice.vector(1.0));
  r.push_back({500, -700, 900});
  std::vector<double> R;
  for (std::size_t k = 0; k < r.size(); ++k) R.push_back(dice(0.01, 0.03));
  for (const bool along_x : {false, true}) {
    const Vec3d low{-2, -1001, -1001}, high{1001, 1001, 1001};
    Vessel v;
    set_frame(v, BoundingBox{low, high});
    add_box(v, low, high);
    if (along_x) {  // through which the far one meets them
      v.cell = {{v.edges[0], {}, {}, {}}, {v.edges[1], {}, {}, {}}, {v.edges[2], {}, {}, {}}};
      v.periodic = {true, false, false};
      v.walls.erase(v.walls.begin(), v.walls.begin() + 2);
    }
    const VoronoiCells cells = voronoi_cells(*space_of(v), r, R);
    double sum = 0.0;
    for (const double volume : cells.volume) sum += volume;
    EXPECT_NEAR(sum / v.frame_volume(), 1.0, 1e-9);
    for (std::size_t i = 0; i < r.size(); i += 10) {
      const double plain = plain_cell(*space_of(v), r, R, i).volume();
      EXPECT_NEAR(cells.volume[i] / plain, 1.0, 1e-6) << i;
    }
  }
}

// A place belongs to the sphere with the least d^2 - R^2. Of n places drawn at random, n v/V (1 +- 1/sqrt(n
// v/V)) belong to a cell of volume v.
TEST(Voronoi, VolumesAreThoseThatCountingFinds) {
  constexpr int places = 100000;
  for (const Body& b : bodies(25)) {
    const VoronoiCells cells = voronoi_cells(*space_of(b.vessel), b.r, b.R);
    Dice dice(7);
    std::vector<double> found(b.r.size(), 0.0);
    const int far = b.vessel.cell.empty() ? 0 : 2;
    for (int n = 0; n < places;) {
      const Vec3d p = b.vessel.at({dice(0, 1), dice(0, 1), dice(0, 1)});
      if (!(b.vessel.depth(p) > 0.0)) continue;
      ++n;
      std::size_t of = 0;
      double least = INFINITY;
      for (std::size_t j = 0; j < b.r.size(); ++j)
        for (int x = -far; x <= far; ++x)
          for (int y = -far; y <= far; ++y)
            for (int z = -far; z <= far; ++z) {
              const Vec3d d = b.r[j] + double(x) * b.vessel.edges[0] + double(y) * b.vessel.edges[1] +
                              double(z) * b.vessel.edges[2] - p;
              const double power = norm2(d) - b.R[j] * b.R[j];
              if (power < least) least = power, of = j;
            }
      found[of] += 1.0;
    }
    for (std::size_t i = 0; i < b.r.size(); ++i) {
      const double expected = places * cells.volume[i] / b.volume;
      EXPECT_NEAR(found[i], expected, 5.0 * std::sqrt(expected) + 1e-3 * expected) << "cell " << i;
    }
  }
}

TEST(Voronoi, BitsDoNotDependOnThreads) {
  const Body b = bodies(500)[1];
  const VoronoiCells one = voronoi_cells(*space_of(b.vessel), b.r, b.R, 1);
  for (const int threads : {2, 3}) {
    const VoronoiCells many = voronoi_cells(*space_of(b.vessel), b.r, b.R, threads);
    EXPECT_EQ(one.volume, many.volume);
    ASSERT_EQ(one.first, many.first);
    for (std::size_t k = 0; k < one.faces.size(); ++k)
      EXPECT_TRUE(one.faces[k].of == many.faces[k].of && one.faces[k].image == many.faces[k].image &&
                  one.faces[k].area == many.faces[k].area);
  }
}

TEST(Voronoi, ObstaclesHaveNoPlanes) {
  Vessel v = hollow_ball(2);
  v.walls.push_back(ball({}, 0.5, false));
  EXPECT_FALSE(space_of(v));
}

}  // namespace
}  // namespace vbond::packing::voronoi_test
