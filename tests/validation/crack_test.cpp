// Validation case F5: the force in the first bond ahead of a crack in a triangular lattice, whose edge far
// away is moved as in the plane problem of elasticity (boundary layer).
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "material_cases.hpp"
#include "static_bodies.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

/// Displacement and turn of the elastic plane at unit stress intensity: Williams' first term, plane stress.
struct CrackField {
  double mu, nu;
  Vec3d displacement(double x, double y) const {
    const double r = std::hypot(x, y), half = 0.5 * std::atan2(y, x), kappa = (3 - nu) / (1 + nu);
    const double size = std::sqrt(r / (2 * std::numbers::pi)) / (2 * mu);
    return {size * std::cos(half) * (kappa - 1 + 2 * sq(std::sin(half))),
            size * std::sin(half) * (kappa + 1 - 2 * sq(std::cos(half))), 0};
  }
  double turn(double x, double y) const {  // (dv/dx - du/dy)/2 by central differences
    const double h = 1e-4;
    const auto along = [&](double dx, double dy) { return displacement(x + dx, y + dy); };
    return ((along(h, 0).y - along(-h, 0).y) - (along(0, h).x - along(0, -h).x)) / (4 * h);
  }
};

/// Axial force of the first bond that crosses the line of the crack ahead of its tip, per unit K_I.
double tip_force(const BondStiffness<double>& c, double radius) {
  const double height = std::sqrt(0.75), bulk = 0.5 * std::sqrt(3.0) * c.c_A,
               mu = 0.25 * std::sqrt(3.0) * (c.c_A + c.c_D);
  const CrackField field{mu, (bulk - mu) / (bulk + mu)};
  // rows half way above and below the crack's line; crossing bonds have their middles at x = 1/4 + k/2
  std::vector<Vec3d> r;
  const int most = static_cast<int>(radius / height) + 3;
  for (int row = -most; row < most; ++row)
    for (int k = -most; k <= most; ++k) {
      const Vec3d at{k + (row % 2 == 0 ? 0.0 : 0.5), (row + 0.5) * height, 0};
      if (std::hypot(at.x, at.y) < radius + 1.5) r.push_back(at);
    }
  testing::Specimen s = testing::particles_at(r);
  BondRecipe recipe;
  recipe.parameters = c;
  recipe.n_2 = Vec3d{0, 0, 1};
  BondId first{0};
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j) {
      if (norm(r[j] - r[i]) > 1.01) continue;
      const bool crosses = r[i].y * r[j].y < 0;
      const double x = 0.5 * (r[i].x + r[j].x);
      if (crosses && x < 0) continue;
      if (crosses && std::abs(x - 0.25) < 0.1) first = BondId{s.state.bonds.size()};
      testing::bond(s, i, j, recipe);
    }
  const double K = 1e-6;  // small: strains of 1e-6, so that the lattice is linear
  StaticStage stage = testing::static_stage(StageKind::equilibrium,
                                            {testing::fixed(testing::everybody(s), testing::in_plane)});
  for (std::size_t k = 0; k < r.size(); ++k)
    if (std::hypot(r[k].x, r[k].y) > radius)
      stage.supports.push_back(testing::fixed({ParticleId{k}}, testing::clamped,
                                              K * field.displacement(r[k].x, r[k].y),
                                              {0, 0, K * field.turn(r[k].x, r[k].y)}));
  const StaticOutcome outcome = run_static_stage(s.model, stage, s.state, {});
  const Bond& b = outcome.state.bonds[first];
  const BondPose<double> pose = bond_pose(b, outcome.state);
  return dot(b.law->loads(b, pose, no_history).F, bond_axis(pose, 0.0, 0.0).d) / K;
}

// The reference's values for radii of 20, 40 and 80 differ by 7e-4; here it is the same radius, and agreement
// to 2e-5 was measured. The reference leaves c_B out: of the values tried, 1e-4 to 1e3, the paper's 0.0025 is
// the one that gives all three numbers; 0.01 is off by 3e-3.
TEST(CrackInATriangularLattice, HasTheForceOfTheReferenceAtItsTip) {
  const nlohmann::json f5 = testing::material_case("F5")["expected"];
  for (const auto& [name, c_D] :
       {std::pair{"cA=1 cD=0.03", 0.03}, {"cA=1 cD=0.35", 0.35}, {"cA=1 cD=1", 1.0}}) {
    const double alpha = f5[name]["alpha_Rb20_40_80"][0];
    EXPECT_NEAR(tip_force({1.0, c_D, 0.0025, 1.0 / 480}, 20.0) / alpha, 1.0, 1e-4) << name;
  }
}

}  // namespace
}  // namespace vbond
