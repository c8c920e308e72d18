// Validation case L1: elastic constants of lattices, from the energy of imposed uniform strain and curvature.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "cases.hpp"
#include "dynamics/rods.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

using testing::number;
using testing::validation_case;

/// Where a particle at r goes: displacement and turn.
struct Motion {
  Vec3d u, turn;
};
using Field = std::function<Motion(const Vec3d& r)>;

/// One particle bonded to its neighbours: half of their energy belongs to its cell.
struct Star {
  testing::Specimen specimen;
  double cell;  // area or volume per particle

  Star(const std::vector<Vec3d>& neighbours, double cell_, const BondStiffness<double>& c) : cell(cell_) {
    std::vector<Vec3d> r{{0, 0, 0}};
    r.insert(r.end(), neighbours.begin(), neighbours.end());
    specimen = testing::particles_at(r);
    BondRecipe recipe;
    recipe.parameters = c;
    for (std::size_t k = 1; k < r.size(); ++k) testing::bond(specimen, 0, k, recipe);
  }

  /// Energy per cell at field strength `size`, over size^2. The mean of both signs leaves an error of size^2.
  double W(const Field& field) const {
    const double size = 2e-4;
    double sum = 0.0;
    for (const double sign : {-1.0, 1.0}) {
      State s = specimen.state;
      for (const ParticleId p : s.r.ids()) {
        const Motion m = field(specimen.state.r[p]);
        s.r[p] += sign * size * m.u;
        s.q[p] = rotation_of(sign * size * m.turn);
      }
      sum += 0.5 * bond_energies(s).potential() / cell;
    }
    return 0.5 * sum / (size * size);
  }
};

/// x -> x + e x with symmetric e; particles do not turn.
Field strain(double xx, double yy, double xy) {
  return [=](const Vec3d& r) { return Motion{{xx * r.x + xy * r.y, xy * r.x + yy * r.y, 0}, {}}; };
}
/// Deflection w = (xx x^2 + yy y^2) / 2 + xy x y of a sheet; particles turn with the normal.
Field curvature(double xx, double yy, double xy) {
  return [=](const Vec3d& r) {
    const double w = 0.5 * (xx * r.x * r.x + yy * r.y * r.y) + xy * r.x * r.y;
    return Motion{{0, 0, w}, {xy * r.x + yy * r.y, -(xx * r.x + xy * r.y), 0}};
  };
}
/// Deflection w = x without turning: transverse shear.
Motion transverse_shear(const Vec3d& r) {
  return {{0, 0, r.x}, {}};
}

std::vector<Vec3d> triangular() {
  std::vector<Vec3d> n;
  for (int k = 0; k < 6; ++k) n.push_back({std::cos(k * M_PI / 3), std::sin(k * M_PI / 3), 0});
  return n;
}
std::vector<Vec3d> square() {
  return {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
}
std::vector<Vec3d> simple_cubic() {
  std::vector<Vec3d> n = square();
  n.push_back({0, 0, 1});
  n.push_back({0, 0, -1});
  return n;
}
std::vector<Vec3d> fcc() {
  std::vector<Vec3d> n;
  const double h = std::sqrt(0.5);
  for (const double s : {-h, h})
    for (const double t : {-h, h}) {
      n.push_back({s, t, 0});
      n.push_back({s, 0, t});
      n.push_back({0, s, t});
    }
  return n;
}

// Tolerance: deflection stretches bonds, which adds c_A size^2 / (64 c_B) = 3e-7 to energies of bending;
// those are near c_B size^2 = 1e-10, sums of terms near 1e-2 and 1e-3 that are rounded to 1e-16 of the
// smallest of them and cancel: some 1e-6.
constexpr double tolerance = 2e-6;

void expect_ratio(double found, const nlohmann::json& expected, const char* what) {
  EXPECT_NEAR(found / number(expected), 1.0, tolerance) << what;
}

/// Runs the check for both sets of stiffnesses of the reference.
template <class Check>
void for_both_stiffnesses(const char* lattice, Check check) {
  const auto& all = validation_case("L1").at("expected");
  check(BondStiffness<double>{1, 0.03, 0.0025, 1.0 / 480.0},
        all.at("cA=1,cD=0.03,cB=0.0025,cT=0.00208333,a=1").at(lattice));
  check(BondStiffness<double>{1, 0.35, 0.05, 0.02}, all.at("cA=1,cD=0.35,cB=0.05,cT=0.02,a=1").at(lattice));
}

TEST(TriangularSheet, HasTheExactMembraneAndPlateStiffness) {
  for_both_stiffnesses("triangular sheet", [](const BondStiffness<double>& c,
                                              const nlohmann::json& expected) {
    const Star star(triangular(), std::sqrt(0.75), c);
    const double mu = star.W(strain(0, 0, 1)) / 2, C11 = 2 * star.W(strain(1, 0, 0));
    expect_ratio(mu, expected.at("mu_2D"), "mu");
    expect_ratio(C11 - 2 * mu, expected.at("lambda_2D"), "lambda");
    EXPECT_NEAR(2 * star.W(strain(0, 1, 0)) / C11, 1.0, tolerance) << "isotropy";
    const double C12 = C11 - 2 * mu;
    expect_ratio((C11 * C11 - C12 * C12) / C11, expected.at("Y_2D"), "Y");
    expect_ratio(C12 / C11, expected.at("nu_2D"), "nu");
    const double D = 2 * star.W(curvature(1, 0, 0));
    expect_ratio(D, expected.at("D_bend"), "D");
    EXPECT_NEAR(star.W(curvature(1, 1, 0)) / D - 1.0, number(expected.at("nu_bend")), tolerance);
    EXPECT_NEAR(1.0 - star.W(curvature(0, 0, 1)) / D, number(expected.at("nu_bend")), tolerance);
    expect_ratio(2 * star.W(transverse_shear), expected.at("transverse_shear_stiffness"), "transverse shear");
  });
}

TEST(ShellTheory, GivesTheTriangularSheetTheStiffnessOfTheWall) {
  for (const double nu : {-0.4, 0.0, 0.22, 0.3}) {
    const double E = 1.3, h = 0.2, across = 1 - nu * nu;
    const BondStiffness<double> c = shell({E, nu}, h);
    const Star star(triangular(), std::sqrt(0.75), c);
    // Strains of second order stretch bonds: c_A size^2/(64 c_B) = 12/64 (size/h)^2 = 2e-7. Energies are
    // differences of terms of B2, B3 and B4, each rounded to eps: of six bonds at both signs, at random, eps
    // U0 sqrt(12)/4 per cell. Five times that, and thrice the other, are left.
    const double U0 = 0.5 * (std::abs(c.c_B - 0.25 * c.c_D) + c.c_D + c.c_T), size = 2e-4;
    const double rounding = std::numeric_limits<double>::epsilon() * U0 * std::sqrt(12.0) / (4.0 * star.cell);
    const double C11 = 2 * star.W(strain(1, 0, 0)), D = 2 * star.W(curvature(1, 0, 0));
    const double in_bending = 6e-7 + 5.0 * 2.0 * rounding / (size * size * D);
    EXPECT_NEAR(C11 * across / (E * h), 1.0, tolerance) << nu;
    EXPECT_NEAR(star.W(strain(0, 0, 1)) / (E * h / (1 + nu)), 1.0, tolerance) << nu;  // 2 G h xy^2
    EXPECT_NEAR(star.W(strain(1, 1, 0)) / C11 - 1.0, nu, tolerance);
    EXPECT_NEAR(D * 12 * across / (E * h * h * h), 1.0, in_bending) << nu;
    EXPECT_NEAR(star.W(curvature(1, 1, 0)) / D - 1.0, nu, in_bending);
    EXPECT_NEAR(1.0 - star.W(curvature(0, 0, 1)) / D, nu, in_bending);
  }
}

TEST(SquareSheet, HasTheExactMembraneAndPlateStiffness) {
  for_both_stiffnesses("square sheet", [](const BondStiffness<double>& c, const nlohmann::json& expected) {
    const Star star(square(), 1.0, c);
    const double C11 = 2 * star.W(strain(1, 0, 0)), D11 = 2 * star.W(curvature(1, 0, 0));
    expect_ratio(C11, expected.at("C11"), "C11");
    EXPECT_NEAR(star.W(strain(1, 1, 0)) - C11, number(expected.at("C12")), tolerance) << "C12";
    expect_ratio(star.W(strain(0, 0, 1)) / 2, expected.at("C66"), "C66");
    expect_ratio(D11, expected.at("D11"), "D11");
    EXPECT_NEAR((star.W(curvature(1, 1, 0)) - D11) / D11, number(expected.at("D12")), tolerance) << "D12";
    EXPECT_NEAR(star.W(curvature(0, 0, 1)) / c.c_T, 1.0, tolerance) << "W = c_T k_xy^2";
  });
}

TEST(SimpleCubic, HasTheExactElasticConstants) {
  for_both_stiffnesses("simple cubic", [](const BondStiffness<double>& c, const nlohmann::json& expected) {
    const Star star(simple_cubic(), 1.0, c);
    const double C11 = 2 * star.W(strain(1, 0, 0));
    expect_ratio(C11, expected.at("C11"), "C11");
    EXPECT_NEAR(star.W(strain(1, 1, 0)) - C11, number(expected.at("C12")), tolerance) << "C12";
    expect_ratio(star.W(strain(0, 0, 1)) / 2, expected.at("C44"), "C44");
  });
}

TEST(FaceCentredCubic, HasTheExactElasticConstants) {
  for_both_stiffnesses("fcc", [](const BondStiffness<double>& c, const nlohmann::json& expected) {
    const Star star(fcc(), std::sqrt(0.5), c);
    const double C11 = 2 * star.W(strain(1, 0, 0));
    expect_ratio(C11, expected.at("C11"), "C11");
    expect_ratio(star.W(strain(1, 1, 0)) - C11, expected.at("C12"), "C12");
    expect_ratio(star.W(strain(0, 0, 1)) / 2, expected.at("C44"), "C44");
  });
}

}  // namespace
}  // namespace vbond
