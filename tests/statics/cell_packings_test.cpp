// Two random packings in periodic cells, against numbers of another program.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "packings.hpp"
#include "periodic.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::cell_packings_test {
namespace {

using namespace testing;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The stiffnesses of bonds: the same for all, or of a rod between the surfaces.
BondRecipe recipe_of(const Packing& p, const PackingBond& b, bool same) {
  BondRecipe recipe;
  if (same) {
    recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
    return recipe;
  }
  const double R = 0.5 * std::min(p.radius[b.i], p.radius[b.j]), A = M_PI * R * R,
               J = M_PI / 4 * R * R * R * R;
  const double nu = 0.2, G = 0.5 / (1 + nu), k = 6 * sq(1 + nu) / (7 + 12 * nu + 4 * nu * nu);
  recipe.attachment = Attachment::given;
  recipe.R_i = 0.7 * p.radius[b.i], recipe.R_j = 0.7 * p.radius[b.j];
  const Vec3d far = double(b.a) * p.edges[0] + double(b.b) * p.edges[1] + double(b.c) * p.edges[2];
  const double a = norm(p.r[b.j] + far - p.r[b.i]) - recipe.R_i - recipe.R_j;
  const double phi = 12 * J / (k * G * A * a * a);  // Timoshenko's
  recipe.parameters = BondStiffness<double>{A / a, 12 * J / (a * a * a * (1 + phi)), J / a, 2 * G * J / a};
  return recipe;
}

Specimen packed(const Packing& p, bool same, bool evm, bool triangular) {
  Specimen s = periodic_body(p.edges, p.r);
  s.model.cell.triangular = triangular;
  for (std::size_t k = 0; k < p.radius.size(); ++k) s.model.radius[ParticleId{k}] = p.radius[k];
  for (const PackingBond& b : p.bonds) {
    BondRecipe recipe = recipe_of(p, b, same);
    if (evm) recipe.law = &bond_law<Evm>;
    bond_image(s, b.i, b.j, {b.a, b.b, b.c}, recipe);
  }
  return s;
}

struct Case {
  const char* name;
  Packing packing;
  bool same;
};
std::vector<Case> cases() {
  return {{"HG1", packing_of_equals(), true}, {"HG2", packing_of_sizes(), false}};
}

// C from the tangent, places and turns condensed out.
TEST(PeriodicPackings, HaveTheirElasticConstants) {
  for (const Case& c : cases())
    for (const bool evm : {false, true})
      for (const bool triangular : {false, true}) {
        const Specimen s = packed(c.packing, c.same, evm, triangular);
        StaticStage stage =
            cell_stage({stressed(0), stressed(0), stressed(0), stressed(0), stressed(0), stressed(0)});
        stage.supports = {fixed({ParticleId{0}}, {true, true, true, false, false, false})};
        const StaticBody body(s.model, stage, s.state);
        const DenseMatrix K = body.tangent();
        const Eigen::Index n = K.rows() - 6;
        const DenseMatrix E_u = K.bottomLeftCorner(6, n);
        Matrix6 C = K.bottomRightCorner<6, 6>() - E_u * K.topLeftCorner(n, n).ldlt().solve(E_u.transpose());
        C *= sq(body.unknowns().cell_length()) / volume(s.state.cell);
        double largest = 0.0, off = 0.0;
        for (int k = 0; k < 6; ++k)
          for (int l = 0; l < 6; ++l) {
            const double twice = triangular ? 1.0 : (k < 3 ? 1.0 : 0.5) * (l < 3 ? 1.0 : 0.5);
            const double exact = c.packing.C[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)];
            largest = std::max(largest, std::abs(exact));
            off = std::max(off, std::abs(twice * C(k, l) - exact));
          }
        EXPECT_LT(off, 1e-11 * largest)
            << c.name << (evm ? " EVM" : " V-model") << (triangular ? ", triangular" : "");
      }
}

/// Which components are strained, and which go to a stress.
std::array<CellComponent, 6> drive_of(const PackingPoint& at) {
  std::array<CellComponent, 6> drive{};
  const double t = at.F_zz - 1.0;
  drive[2] = strained(t);
  if (at.kind == std::string("strain")) {
    drive[5] = strained(t);
    return drive;
  }
  const double lateral = at.kind == std::string("triaxial") ? -0.01 : 0.0;
  drive[0] = drive[1] = stressed(lateral);
  drive[3] = drive[4] = drive[5] = stressed(0.0);
  return drive;
}

TEST(PeriodicPackings, GoToLargeStrainsAndStresses) {
  for (const Case& c : cases())
    for (const PackingPoint& at : c.packing.points) {
      const Specimen s = packed(c.packing, c.same, at.evm, at.triangular);
      const State end = run_static_stage(s.model, cell_stage(drive_of(at), 2), s.state, {}).state;
      const std::string which = std::string(c.name) + (at.evm ? " EVM " : " V-model ") + at.kind + " " +
                                std::to_string(at.F_zz) + (at.triangular ? " triangular" : " symmetric");
      const double energy = energy_of(s, end) - energy_of(s, s.state);
      EXPECT_NEAR(energy, at.energy, 1e-9 * at.energy) << which;
      const std::array<double, 6> F = cell_strain(s, end);
      const SymmetricParts stress = stress_of(s, end);
      double largest_strain = 0.0, largest_stress = 0.0;
      for (std::size_t k = 0; k < 6; ++k) {
        largest_strain = std::max(largest_strain, std::abs(at.F[k] - (k < 3 ? 1.0 : 0.0)));
        largest_stress = std::max(largest_stress, std::abs(at.stress[k]));
      }
      for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(F[k], at.F[k], 1e-9 * largest_strain) << which << ", F " << k;
        EXPECT_NEAR(stress[k], at.stress[k], 1e-9 * largest_stress) << which << ", stress " << k;
      }
    }
}

}  // namespace
}  // namespace vbond::cell_packings_test
