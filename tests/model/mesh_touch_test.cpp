#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "material_cases.hpp"
#include "meshes.hpp"
#include "random_pose.hpp"
#include "vbond/terms/walls/wall_touch.hpp"

namespace vbond {
namespace {

using testing::plate;

std::vector<WallTouch> touches(const WallSurface& wall, const Vec3d& centre, double reach) {
  std::vector<WallTouch> found;
  wall.touches(centre, reach, found);
  return found;
}

TriangleMesh fan_of_six() {
  TriangleMesh mesh;
  mesh.corners.push_back({0, 0, 0});
  for (std::uint32_t k = 0; k < 6; ++k) {
    const double angle = std::numbers::pi / 3.0 * k;
    mesh.corners.push_back({2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0});
    mesh.triangles.push_back({0, k + 1, (k + 1) % 6 + 1});
  }
  return mesh;
}

/// Two slopes of 20 degrees that meet above the y axis, from -2 to 2.
TriangleMesh roof(double sign) {
  const double z = sign * 2.0 * std::tan(std::numbers::pi / 9.0);
  TriangleMesh mesh;
  mesh.corners = {{-2, -2, z}, {0, -2, 0}, {2, -2, z}, {-2, 2, z}, {0, 2, 0}, {2, 2, z}};
  mesh.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  return mesh;
}

// MS1: a sphere with R = 0.5 and the force d^1.5 on a plate in two triangles and in a fan, a ridge and a
// valley.
TEST(MeshTouches, GiveTheForcesOfCaseMS1) {
  const nlohmann::json ms1 = testing::material_case("MS1");
  const auto compare = [](const nlohmann::json& row, const TriangleMesh& mesh) {
    const auto& at = row["centre"];
    const Vec3d centre{at[0], at[1], at[2]};
    const auto found = touches(WallSurface(MeshWall{mesh}), centre, 0.5);
    EXPECT_EQ(found.size(), row["contacts"].get<std::size_t>()) << row;
    Vec3d F;
    for (const WallTouch& t : found) F += std::pow(0.5 - t.distance, 1.5) * t.normal;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(component(F, k), row["F"][k].get<double>(), 1e-12) << row;
  };
  for (const auto& row : ms1["expected"]["flat"])
    compare(row, row.contains("mesh") ? fan_of_six() : plate(1, 2.0));
  for (const auto& row : ms1["expected"]["ridge"]) compare(row, roof(-1.0));
  for (const auto& row : ms1["expected"]["valley"]) compare(row, roof(1.0));
}

// Spheres above, below and beside a plate that lies anywhere, among them those over corners and edges: as one
// plane with an edge, however many triangles there are.
TEST(MeshTouches, AreTheSameForPlatesOfFewAndManyTriangles) {
  testing::PoseSource random(11);
  for (int pose = 0; pose < 3; ++pose) {
    const Quatd q = pose == 0 ? Quatd{} : random.rotation(3.0);
    const Vec3d shift = pose == 0 ? Vec3d{} : random.vector(3.0);
    std::vector<WallSurface> walls;
    for (const std::uint32_t n : {1u, 10u, 100u}) {
      TriangleMesh mesh = plate(n, 2.0);
      for (Vec3d& r : mesh.corners) r = rotate(q, r) + shift;
      walls.emplace_back(MeshWall{std::move(mesh)});
    }
    for (int k = 0; k < 400; ++k) {
      Vec3d r = random.vector(2.4);
      r.z *= 0.25;
      if (k % 4 == 1) r.x = std::round(25.0 * r.x) / 25.0;  // over edges of all but the coarsest
      if (k % 4 == 2) r.x = std::round(25.0 * r.x) / 25.0, r.y = std::round(25.0 * r.y) / 25.0;
      if (k % 4 == 3) r.y = r.x + 1e-9 * random.uniform(-1.0, 1.0);
      const double over_x = std::max(std::abs(r.x) - 2.0, 0.0), over_y = std::max(std::abs(r.y) - 2.0, 0.0);
      const double distance = std::hypot(over_x, over_y, r.z);
      if (std::abs(distance - 0.5) < 1e-9) continue;
      for (const WallSurface& wall : walls) {
        const auto found = touches(wall, rotate(q, r) + shift, 0.5);
        ASSERT_EQ(found.size(), distance < 0.5 ? 1u : 0u) << k;
        if (found.empty()) continue;
        const Vec3d normal =
            rotate(q, Vec3d{std::copysign(over_x, r.x), std::copysign(over_y, r.y), r.z} / distance);
        EXPECT_NEAR(found[0].distance, distance, 1e-12);
        EXPECT_NEAR(norm(found[0].normal - normal), 0.0, 1e-12) << k;
      }
    }
  }
}

/// The closest point of a triangle by another way: the foot on its plane if that is inside, else on its
/// sides.
Vec3d closest_by_sides(const Vec3d& r, const std::array<Vec3d, 3>& p) {
  const Vec3d n = normalised(cross(p[1] - p[0], p[2] - p[0])), foot = r - dot(n, r - p[0]) * n;
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k)
    inside = inside && dot(cross(p[(k + 1) % 3] - p[k], foot - p[k]), n) >= 0.0;
  if (inside) return foot;
  Vec3d best = p[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d side = p[(k + 1) % 3] - p[k];
    const Vec3d on = p[k] + std::clamp(dot(r - p[k], side) / norm2(side), 0.0, 1.0) * side;
    if (norm2(r - on) < norm2(r - best)) best = on;
  }
  return best;
}

/// The rule as it is written, for each pair of triangles: the distances, in increasing order.
std::vector<double> distances_by_the_rule(const TriangleMesh& mesh, const Vec3d& r, double reach) {
  constexpr double same = 1e-12;
  std::vector<Vec3d> points;
  std::vector<std::array<Vec3d, 3>> corners;
  for (const auto& [a, b, c] : mesh.triangles)
    corners.push_back({mesh.corners[a], mesh.corners[b], mesh.corners[c]});
  std::vector<Vec3d> closest;
  for (const auto& c : corners) closest.push_back(closest_by_sides(r, c));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (norm(closest[k] - r) >= reach) continue;
    bool counts = true;
    for (std::size_t other = 0; other < corners.size(); ++other) {
      const bool holds = norm(closest_by_sides(closest[k], corners[other]) - closest[k]) < same;
      if (holds && norm(closest[other] - r) < norm(closest[k] - r) - same) counts = false;
    }
    for (const Vec3d& p : points) counts = counts && norm(p - closest[k]) >= MeshSurface::same_point * reach;
    if (counts) points.push_back(closest[k]);
  }
  std::vector<double> distances;
  for (const Vec3d& p : points) distances.push_back(norm(p - r));
  std::sort(distances.begin(), distances.end());
  return distances;
}

// Crumpled sheets with all kinds of ridges, valleys, tips and pits, and spheres of all sizes on them.
RC_GTEST_PROP(MeshTouches, AreThoseOfTheRuleOnCrumpledSheets, (unsigned seed)) {
  testing::PoseSource random(seed);
  const TriangleMesh mesh =
      testing::sheet(1 + seed % 7, 1.0, [&](double, double) { return random.uniform(-0.4, 0.4); });
  const WallSurface wall{MeshWall{mesh}};
  for (int k = 0; k < 20; ++k) {
    const double reach = random.uniform(0.05, 0.8);
    const Vec3d centre = random.vector(1.2);
    const auto expected = distances_by_the_rule(mesh, centre, reach);
    const auto found = touches(wall, centre, reach);
    std::vector<double> distances;
    for (const WallTouch& t : found) {
      distances.push_back(t.distance);
      RC_ASSERT(std::abs(norm(t.normal) - 1.0) < 1e-14);
    }
    std::sort(distances.begin(), distances.end());
    RC_ASSERT(distances.size() == expected.size());
    for (std::size_t n = 0; n < expected.size(); ++n) RC_ASSERT(std::abs(distances[n] - expected[n]) < 1e-12);
  }
}

// Lists of triangles that are kept while spheres move give the same touches bit for bit.
TEST(MeshTouches, AreTheSameFromAnyListThatHoldsAllNearTriangles) {
  testing::PoseSource random(5);
  const TriangleMesh mesh =
      testing::sheet(12, 1.0, [&](double, double) { return random.uniform(-0.1, 0.1); });
  const WallSurface wall{MeshWall{mesh}};
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  int touching = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec3d centre = random.vector(1.0);
    std::vector<std::uint32_t> near;
    wall.near(centre, 0.4, near);
    EXPECT_TRUE(std::is_sorted(near.begin(), near.end()));
    const Vec3d moved = centre + random.vector(0.05);
    const auto direct = touches(wall, moved, 0.3);
    EXPECT_TRUE(direct.empty() || wall.may_touch(moved, 0.3));
    for (const auto& triangles : {near, all}) {
      std::vector<WallTouch> found;
      wall.touches_of(triangles, moved, 0.3, found);
      ASSERT_EQ(found.size(), direct.size());
      for (std::size_t n = 0; n < found.size(); ++n) {
        EXPECT_EQ(found[n].normal, direct[n].normal);
        EXPECT_EQ(found[n].distance, direct[n].distance);
      }
    }
    touching += !direct.empty();
  }
  EXPECT_GT(touching, 50);
}

// Coordinates rounded to 32 bits, as STL files hold them: the bends this makes are no valleys.
TEST(MeshTouches, OfAPlateWithRoundedCoordinatesAreSingle) {
  testing::PoseSource random(8);
  const Quatd q = random.rotation(2.0);
  TriangleMesh mesh = plate(20, 1.0);
  for (Vec3d& r : mesh.corners) {
    r = rotate(q, r) + Vec3d{3, -2, 1};
    r = {static_cast<float>(r.x), static_cast<float>(r.y), static_cast<float>(r.z)};
  }
  const WallSurface wall{MeshWall{mesh}};
  for (int k = 0; k < 2000; ++k) {
    const double x = 0.1 * std::round(random.uniform(-9.0, 9.0)) + 1e-7 * random.uniform(-1.0, 1.0);
    const auto found = touches(wall, rotate(q, {x, random.uniform(-0.9, 0.9), 0.28}) + Vec3d{3, -2, 1}, 0.3);
    EXPECT_EQ(found.size(), 1u) << k;
  }
}

/// Two halves of a plate, apart by `gap` along x, the second one higher by `step` and shorter along y by
/// `less`.
TriangleMesh plate_in_halves(double gap, double step, double less) {
  TriangleMesh mesh;
  const double y = 2.0 - less;
  mesh.corners = {{-2, -2, 0},     {0, -2, 0},    {0, 2, 0},    {-2, 2, 0},
                  {gap, -y, step}, {2, -y, step}, {2, y, step}, {gap, y, step}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  return mesh;
}

// Two halves whose edges have no common corner: across the seam, in the middle of it, and over laps and
// steps.
TEST(MeshTouches, AreSingleOverASeamThatIsOpenByLessThanTheOverlap) {
  for (const double gap : {0.0, 1e-9, 1e-4, 2e-3, -2e-3})
    for (const double step : {0.0, 1e-9, 1e-3})
      for (const double less : {0.0, 0.3}) {
        const WallSurface wall{MeshWall{plate_in_halves(gap, step, less)}};
        for (const double x : {-0.05, -1e-3, -1e-4, 0.0, 0.5e-4, 1e-3, 0.05}) {
          const auto found = touches(wall, {x, 0.3, 0.95}, 1.0);
          ASSERT_EQ(found.size(), 1u) << gap << ' ' << step << ' ' << less << ' ' << x;
          EXPECT_NEAR(found[0].distance, 0.95, 1.01 * step + 1e-5);
        }
      }
}

// A slot that is wider than the ball is deep has two edges.
TEST(MeshTouches, AreTwoOverASlotThatIsWiderThanTheOverlap) {
  const WallSurface wall{MeshWall{plate_in_halves(0.02, 0.0, 0.0)}};
  EXPECT_EQ(touches(wall, {0.01, 0.3, 0.99}, 1.0).size(), 2u);
  EXPECT_EQ(touches(wall, {0.01, 0.3, 0.97}, 1.0).size(), 1u);
}

TEST(MeshTouches, HaveANormalWhereTheCentreIsOnATriangle) {
  const WallSurface wall{MeshWall{plate(4, 2.0)}};
  for (const Vec3d& r : {Vec3d{0.1, 0.2, 0}, Vec3d{0, 0, 0}, Vec3d{0.5, 0.5, 0}}) {
    const auto found = touches(wall, r, 0.5);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].distance, 0.0);
    EXPECT_EQ(found[0].normal, (Vec3d{0, 0, 1}));
  }
}

TEST(MeshTouches, AreNoneOnAMeshWithoutTriangles) {
  const WallSurface wall{MeshWall{}};
  EXPECT_FALSE(wall.may_touch({}, 1e9));
  EXPECT_TRUE(touches(wall, {}, 1e9).empty());
}

}  // namespace
}  // namespace vbond
