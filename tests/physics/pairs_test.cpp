// Reference numbers: data/pairs.json, 13 bond configurations with energy, force and moments to 20 digits,
// from 60-digit numerical differentiation of the energy of [KA12] eq. (7); made independently of this code.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "vbond/core/quat.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond::pairs_test {
namespace {

double number(const nlohmann::json& j) {
  return j.is_string() ? std::stod(j.get<std::string>()) : j.get<double>();
}
Vec3d vector(const nlohmann::json& j) {
  return {number(j[0]), number(j[1]), number(j[2])};
}
Quatd quaternion(const nlohmann::json& j) {
  return normalised(Quatd{number(j[0]), number(j[1]), number(j[2]), number(j[3])});
}

nlohmann::json read(const std::string& name) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/" + name);
  return nlohmann::json::parse(file);
}

BondPose<double> pose_of(const nlohmann::json& c) {
  const Quatd q_i = quaternion(c["q_i_wxyz"]), q_j = quaternion(c["q_j_wxyz"]);
  BondPose<double> b{vector(c["r_j"]) - vector(c["r_i"]), {}, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    b.n_i[k] = rotate(q_i, vector(c["body_n_i"][k]));
    b.n_j[k] = rotate(q_j, vector(c["body_n_j"][k]));
  }
  return b;
}

TEST(Pairs, EnergyForceAndMomentsMatchSixtyDigitReference) {
  const nlohmann::json pairs = read("pairs.json");
  ASSERT_EQ(pairs["configs"].size(), 13u);
  for (const auto& c : pairs["configs"]) {
    const auto& B = c["B"];
    const VModel<double> law{number(c["a"]), number(c["R_i"]), number(c["R_j"]), number(B[0]),
                             number(B[1]),   number(B[2]),     number(B[3])};
    const BondPose<double> pose = pose_of(c);
    const BondLoads<double> l = bond_loads(law, pose);
    const BondEnergy<double> e = bond_energy(law, pose);
    const Vec3d F = vector(c["F_ij"]), M_ij = vector(c["M_ij"]), M_ji = vector(c["M_ji"]);
    // relative 1e-12 of the load; at rest loads are rounding of terms as large as B1 a and B2..B4
    const double rounding =
        4e-16 * (law.B1 * (law.a + law.R_i + law.R_j) + std::abs(law.B2) + law.B3 + law.B4) * 10;
    const std::string name = c["name"];
    EXPECT_LE(norm(l.F - F), 1e-12 * norm(F) + rounding) << name;
    EXPECT_LE(norm(l.M_ij - M_ij), 1e-12 * norm(M_ij) + rounding) << name;
    EXPECT_LE(norm(l.M_ji - M_ji), 1e-12 * norm(M_ji) + rounding) << name;
    const double U = number(c["U_minus_U0"]);
    EXPECT_NEAR(e.U_L + e.U_B + e.U_T, U, 1e-12 * U + rounding) << name;
  }
}

}  // namespace
}  // namespace vbond::pairs_test
