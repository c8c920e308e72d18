// Two random packings in periodic cells, against numbers of another program.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "decompositions.hpp"
#include "packed.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::cell_packings_test {
namespace {

using namespace testing;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

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
        Matrix6 C =
            K.bottomRightCorner<6, 6>() - E_u * testing::solved(K.topLeftCorner(n, n), E_u.transpose());
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
