// Validation case P2: linear stiffness of a sphere pinched at its poles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "cases.hpp"
#include "static_bodies.hpp"

namespace vbond {
namespace {

using testing::number;
using testing::validation_case;

struct Mesh {
  std::vector<Vec3d> points;
  std::set<std::pair<std::size_t, std::size_t>> edges;
};

/// The icosahedron with every face cut into f^2 triangles, blown up to a sphere of radius R.
Mesh icosphere(int f, double R) {
  const double g = std::numbers::phi;
  std::vector<Vec3d> corners;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-g, g}) {
      corners.push_back({0, s, t});
      corners.push_back({s, t, 0});
      corners.push_back({t, 0, s});
    }
  const auto adjacent = [&](const Vec3d& p, const Vec3d& q) { return std::abs(norm(p - q) - 2.0) < 1e-9; };

  Mesh mesh;
  std::map<std::array<long, 3>, std::size_t> known;
  const auto point = [&](const Vec3d& flat) {
    const Vec3d p = R * normalised(flat);
    const std::array<long, 3> key{std::lround(p.x * 1e6), std::lround(p.y * 1e6), std::lround(p.z * 1e6)};
    const auto [at, is_new] = known.try_emplace(key, mesh.points.size());
    if (is_new) mesh.points.push_back(p);
    return at->second;
  };
  const auto edge = [&](std::size_t p, std::size_t q) { mesh.edges.insert(std::minmax(p, q)); };
  for (const Vec3d& A : corners)
    for (const Vec3d& B : corners)
      for (const Vec3d& C : corners) {
        if (!adjacent(A, B) || !adjacent(B, C) || !adjacent(C, A)) continue;
        if (dot(A, cross(B, C)) < 0)
          continue;  // each face three times is harmless: points and edges are sets
        const auto grid = [&](int i, int j) {
          return point(A + (static_cast<double>(i) / f) * (B - A) + (static_cast<double>(j) / f) * (C - A));
        };
        for (int i = 0; i < f; ++i)
          for (int j = 0; i + j < f; ++j) {
            edge(grid(i, j), grid(i + 1, j));
            edge(grid(i, j), grid(i, j + 1));
            edge(grid(i + 1, j), grid(i, j + 1));
          }
      }
  return mesh;
}

std::size_t nearest(const Mesh& mesh, const Vec3d& to) {
  std::size_t best = 0;
  for (std::size_t k = 0; k < mesh.points.size(); ++k)
    if (norm(mesh.points[k] - to) < norm(mesh.points[best] - to)) best = k;
  return best;
}

/// The same points, with `pole` turned to the z axis.
void turn_upright(Mesh& mesh, const Vec3d& pole) {
  const Vec3d z = normalised(pole), x{1, 0, 0}, y = cross(z, x);  // the poles here are normal to x
  for (Vec3d& p : mesh.points) p = {dot(p, x), dot(p, y), dot(p, z)};
}

/// Force per indentation of one pole, at an indentation of some 5e-8 of the spacing: nonlinear terms are of
/// that size, and positions are rounded to 3.6e-15, 7e-8 of it.
double stiffness_per_pole(const nlohmann::json& row) {
  const double R = row.at("R"), c_A = row.at("c")[0], c_D = row.at("c")[1];
  Mesh mesh = icosphere(row.at("f"), R);
  turn_upright(mesh, row.at("pole") == "vertex5" ? Vec3d{0, 1, std::numbers::phi} : Vec3d{0, 0, 1});
  EXPECT_EQ(mesh.points.size(), row.at("N").get<std::size_t>());
  EXPECT_EQ(mesh.edges.size(), 3 * mesh.points.size() - 6);
  testing::Specimen s = testing::particles_at(mesh.points, 0.3, 0.3);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{c_A, c_D, row.at("c")[2], row.at("c")[3]};
  double length = 0.0;
  for (const auto& [p, q] : mesh.edges) {
    testing::bond(s, p, q, recipe);
    length += norm(mesh.points[q] - mesh.points[p]);
  }
  // the same mesh as the reference's: its mean edge, to the twelve digits of a sum of thousands
  EXPECT_NEAR(length / static_cast<double>(mesh.edges.size()) / row.at("mean_a").get<double>(), 1.0, 1e-12);

  const std::size_t north = nearest(mesh, {0, 0, R}), south = nearest(mesh, {0, 0, -R});
  EXPECT_LE(norm(mesh.points[north] - Vec3d{0, 0, R}), 1e-9) << "a particle stands at the pole";
  const double F = 1e-8;
  // what is held besides the north pole's z carries nothing in balance
  const StaticStage stage =
      testing::static_stage(StageKind::equilibrium,
                            {testing::fixed({ParticleId{north}}, {true, true, true, false, false, true}),
                             testing::fixed({ParticleId{south}}, {true, true, false, false, false, false})},
                            {testing::pushed(south, {0, 0, F})});
  const State rest = run_static_stage(s.model, stage, s.state, {}).state;
  return 2 * F / (rest.r[ParticleId{south}].z - s.state.r[ParticleId{south}].z);
}

// The coarse spheres are far from the continuum, and so is the reference: both are the same discrete body.
TEST(PinchedSphere, HasTheExactDiscreteStiffness) {
  double ratio_at_best = 0.0;
  for (const auto& row : validation_case("P2").at("expected").at("discrete")) {
    const double k = stiffness_per_pole(row);
    EXPECT_NEAR(k / row.at("k_per_pole").get<double>(), 1.0, 1.2e-7)
        << "f = " << row.at("f") << ", " << row.at("pole") << ", c = " << row.at("c");
    ratio_at_best = std::max(ratio_at_best, k / row.at("Reissner").get<double>());
  }
  // Reissner's thin shell, 8 sqrt(D Y) / R: the stiffest shear comes within 3 %
  EXPECT_GT(ratio_at_best, 0.97);
  EXPECT_LT(ratio_at_best, 1.0);
}

}  // namespace
}  // namespace vbond
