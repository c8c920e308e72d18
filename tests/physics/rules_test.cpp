// Stretching, damping and strength against data/materials.json: cases DA5, F1, FR1, NL1
// and NL3, made independently of this code.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "material_cases.hpp"
#include "random_law.hpp"
#include "vbond/physics/tangent.hpp"
#include "vbond/physics/with_rules.hpp"

namespace vbond::rules_test {
namespace {

using nlohmann::json;
using testing::material_case;

Vec3d vec(const json& j) {
  return {j[0], j[1], j[2]};
}

// ---- strength --------------------------------------------------------------------------------------

/// A state of FR1: a bond along x with n_2 = y when unturned, its particles turned by rotation vectors.
struct StateOfBond {
  WithRules<VModel>::Law<double> law;
  BondPose<double> pose;
  BondAxis<double> axis;
  BondLoads<double> loads;
};
StateOfBond state_of(const json& c, const BondStiffness<double>& stiffness) {
  StateOfBond s{};
  s.law = WithRules<VModel>::Law<double>::from(stiffness, c["a"], c["R_i"], c["R_j"]);
  s.law.R_i = c["R_i"], s.law.R_j = c["R_j"];
  s.law.a = c["a"];
  const BondFrames<double> unturned{};
  s.pose =
      bond_pose(unturned, vec(c["r_j"]), rotation_of(vec(c["rotvec_i"])), rotation_of(vec(c["rotvec_j"])));
  s.axis = bond_axis(s.pose, s.law.R_i, s.law.R_j);
  s.loads = bond_loads(s.law, s.pose, s.axis);
  return s;
}
double utilisation_by(const StateOfBond& s, const Strength& strength) {
  BondRules rules;
  rules.strength = strength;
  WithRules<VModel>::Law<double> law = s.law;
  law.rules = &rules;
  return utilisation(law, s.pose, s.axis, s.loads);
}

TEST(Strength, SectionLoadsAndAllCriteriaMatchTheReference) {
  const json fr1 = material_case("FR1"), setup = fr1["setup"];
  const auto& c = setup["c"];
  const double tolerance = 1e-12;
  const Section section = circle(setup["d"]);
  const double tan_phi = std::tan(setup["phi"].get<double>() * std::numbers::pi / 180.0);
  for (const json& state : fr1["expected"]) {
    const StateOfBond s = state_of(state, {c[0], c[1], c[2], c[3]});
    const SectionMoments<double> m = section_moments(s.pose, s.law.R_i, s.law.R_j, s.loads);
    const SectionLoads<double> l = section_loads(m, s.axis, s.loads);
    const json &want = state["loads"], &criteria = state["criteria"];
    EXPECT_LT(norm(s.loads.F - vec(want["F"])), tolerance);
    EXPECT_NEAR(l.N, want["N"], tolerance);
    EXPECT_NEAR(l.V, want["V"], tolerance);
    EXPECT_NEAR(l.M_t, want["T"], tolerance);
    EXPECT_NEAR(l.M_b, want["M_centre"], tolerance);
    EXPECT_NEAR(larger_end_moment(m, s.axis),
                std::max(want["M_end_i"].get<double>(), want["M_end_j"].get<double>()), tolerance);

    const double never = 1e30;  // a strength that the other part of the criterion does not reach
    for (const auto& [name, b] : {std::pair{"PC_betabar_1", 1.0}, std::pair{"PC_betabar_0.4", 0.4}}) {
      const json& pc = criteria[name];
      EXPECT_NEAR(utilisation_by(s, stress_strength(section, 1.0, never, b)),
                  std::max(pc["sigma"].get<double>(), 0.0), 1e-11)
          << name;
      EXPECT_NEAR(utilisation_by(s, stress_strength(section, never, 1.0, b)), pc["tau"], 1e-11) << name;
      EXPECT_NEAR(utilisation_by(s, mohr_coulomb_strength(section, never, tan_phi, 1.0, b)),
                  std::max(pc["sigma"].get<double>(), 0.0), 1e-11)
          << name;
    }
    const json& fibre = criteria["fibre_ends"];
    EXPECT_NEAR(utilisation_by(s, fibre_strength(section, 1.0, never)), fibre["sigma_tension"], 1e-11);
    EXPECT_NEAR(utilisation_by(s, fibre_strength(section, never, 1.0)), fibre["tau"], 1e-11);
    EXPECT_NEAR(utilisation_by(s, fibre_strength(section, never, never, 1.0)), fibre["sigma_compression"],
                1e-11);
    const double cohesion = setup["cohesion"], cut_off = setup["sigma_t"];
    EXPECT_NEAR(utilisation_by(s, mohr_coulomb_strength(section, cohesion, tan_phi, cut_off)),
                criteria["mohr_coulomb_cutoff"]["utilisation"], 1e-11);
    const double f[] = {setup["Fn"], setup["Fs"], setup["Mb"], setup["Mt"]};
    EXPECT_NEAR(utilisation_by(s, linear_strength(f[0], f[1], f[2], f[3], true)),
                criteria["linear_sum_lammps"], 1e-11);
    EXPECT_NEAR(utilisation_by(s, linear_strength(f[0], f[1], f[2], f[3])),
                criteria["linear_sum_tension_part_only"], 1e-11);
    EXPECT_NEAR(utilisation_by(s, quadratic_strength(f[0], f[1], f[2], f[3])), criteria["quadratic_sum"],
                1e-11);
    EXPECT_NEAR(utilisation_by(s, energy_strength(setup["W1"], setup["W2"])), criteria["energy_power_law"],
                1e-11);
    EXPECT_NEAR(utilisation_by(s, elongation_strength(0.01)), (s.axis.D / s.law.a - 1.0) / 0.01, 1e-11);
  }
}

std::vector<Strength> every_criterion() {
  const Section section = circle(0.2);
  return {stress_strength(section, 1e-3, 1e-3),
          fibre_strength(section, 1e-3, 1e-3),
          mohr_coulomb_strength(section, 1e-3, 0.7, 1e-3),
          linear_strength(1e-6, 1e-6, 1e-6, 1e-6),
          quadratic_strength(1e-6, 1e-6, 1e-6, 1e-6),
          energy_strength(1e-12, 1e-12),
          elongation_strength(1e-6)};
}

// In exact arithmetic both utilisations are zero or less. Loads are rounded: 1e-15 of order one over limits
// of 1e-6.
TEST(Strength, CompressionAndRigidMotionBreakNothing) {
  testing::PoseSource random(8);
  for (const Strength& strength : every_criterion())
    for (int t = 0; t < 100; ++t) {
      WithRules<VModel>::Law<double> law = testing::random_law<WithRules<VModel>::Law<double>>(random);
      BondRules rules;
      rules.strength = strength;
      law.rules = &rules;
      law.weakness = 0.0;
      const double reach = law.a + law.R_i + law.R_j;
      const Quatd turn = random.rotation(3.1);
      for (const double shorter : {0.0, random.uniform(0.0, 0.5)}) {
        const Vec3d r = rotate(turn, {reach - shorter * law.a, 0, 0});
        const BondPose<double> pose = bond_pose(BondFrames<double>{}, r, turn, turn);
        const BondAxis<double> axis = bond_axis(pose, law.R_i, law.R_j);
        EXPECT_LT(utilisation(law, pose, axis, bond_loads(law, pose, axis)), 1e-7);
      }
    }
}

TEST(Strength, IsTheSameForEitherEndAndInEveryDirection) {
  testing::PoseSource random(9);
  for (const Strength& strength : every_criterion())
    for (int t = 0; t < 100; ++t) {
      WithRules<Evm>::Law<double> law = testing::random_law<WithRules<Evm>::Law<double>>(random);
      BondRules rules;
      rules.strength = strength;
      law.rules = &rules;
      const BondPose<double> b = random.pair(law.a + law.R_i + law.R_j, 0.1 * law.a, 0.5).pose();
      const auto used = [](const auto& m, const BondPose<double>& pose) {
        const BondAxis<double> axis = bond_axis(pose, m.R_i, m.R_j);
        return utilisation(m, pose, axis, bond_loads(m, pose, axis));
      };
      const double u = used(law, b);
      const Quatd Q = random.rotation(3.1);
      BondPose<double> turned{rotate(Q, b.r_ij), {}, {}}, swapped{-b.r_ij, {}, {}};
      for (int k = 0; k < 3; ++k) {
        turned.n_i[k] = rotate(Q, b.n_i[k]), turned.n_j[k] = rotate(Q, b.n_j[k]);
        swapped.n_i[k] = b.n_j[k], swapped.n_j[k] = b.n_i[k];
      }
      WithRules<Evm>::Law<double> other = law;
      std::swap(other.R_i, other.R_j);
      EXPECT_NEAR(used(law, turned), u, 1e-9 * (1.0 + std::abs(u)));
      EXPECT_NEAR(used(other, swapped), u, 1e-9 * (1.0 + std::abs(u)));
    }
}

TEST(Strength, BondStressesAreThoseOfF1) {
  const json e = material_case("F1")["expected"];
  const Section s = circle(e["d_b"]);
  EXPECT_NEAR(s.A, e["A"], 1e-15);
  const double N = e["F_n_tension_positive"], V = e["F_s"];
  for (const char* where : {"centre", "end_i", "end_j"}) {
    const json& w = e[where];
    const Strength tension = stress_strength(s, 1.0, 1e30), shear = stress_strength(s, 1e30, 1.0);
    const double M_b = w["Mb"], M_t = w["T"];
    EXPECT_NEAR(tension.axial * N + tension.bending * M_b, w["sigma"], 1e-11) << where;
    EXPECT_NEAR(shear.shear * V + shear.torsion * M_t, w["tau"], 1e-11) << where;
  }
}

// ---- damping ---------------------------------------------------------------------------------------

// DA5: with g = beta c the dissipation is beta times the second derivative of the energy at rest.
template <class Law>
void expect_rayleigh() {
  testing::PoseSource random(10);
  for (int t = 0; t < 50; ++t) {
    Law law = testing::random_law<Law>(random);
    const double beta = 0.3;
    const BondStiffness<double> c = stiffness(law);
    law.g_A = beta * c.c_A, law.g_D = beta * c.c_D, law.g_B = beta * c.c_B, law.g_T = beta * c.c_T;
    BondPose<double> rest =
        bond_pose(BondFrames<double>{}, Vec3d{law.a + law.R_i + law.R_j, 0, 0}, Quatd{}, Quatd{});
    if constexpr (OffsetLaw<Law>) rest.r_ij += law.offset_i(rest) - law.offset_j(rest);
    const PairTangent<9> K = bond_tangent(law, rest);
    for (std::size_t k = 0; k < 9; ++k) {
      double rate[9] = {};
      rate[k] = 1.0;
      const BondRates<double> rates{
          {rate[0], rate[1], rate[2]}, {rate[3], rate[4], rate[5]}, {rate[6], rate[7], rate[8]}};
      const BondLoads<double> l = bond_damping(law, rest, bond_axis(law, rest), rates);
      const double loads[9] = {l.F.x,    l.F.y,    l.F.z,    l.M_ij.x, l.M_ij.y,
                               l.M_ij.z, l.M_ji.x, l.M_ji.y, l.M_ji.z};
      for (std::size_t row = 0; row < 9; ++row) EXPECT_NEAR(loads[row], beta * K.d[row][k], 1e-10);
    }
  }
}
TEST(BondDamping, ByTimeIsRayleighsAtRest) {
  expect_rayleigh<WithRules<VModel>::Law<double>>();
  expect_rayleigh<WithRules<Evm>::Law<double>>();
  expect_rayleigh<WithOffsets<WithRules<VModel>::Law>::Law<double>>();
  expect_rayleigh<WithOffsets<WithRules<Evm>::Law>::Law<double>>();
}

// ---- stretching ------------------------------------------------------------------------------------

/// Every form about c_A = 1.3, a = 0.8.
std::vector<Stretch> every_form() {
  std::vector<Stretch> forms(5);
  forms[0].form = StretchForm::cubic, forms[0].k3 = -2.0, forms[0].k4 = 5.0;
  forms[1].form = StretchForm::two_slopes, forms[1].compression = 4.0;
  forms[2].form = StretchForm::fene, forms[2].largest = 0.3;
  forms[3].form = StretchForm::morse, forms[3].alpha = 5.0;
  forms[4].form = StretchForm::table;
  forms[4].table.count = 4;
  const double D[] = {0.5, 0.7, 0.9, 1.2}, U[] = {0.06, 0.01, 0.0, 0.05};
  std::copy(D, D + 4, forms[4].table.D), std::copy(U, U + 4, forms[4].table.U);
  make_spline(forms[4].table);
  return forms;
}

// Central differences with h = 1e-5: their error is h^2 times a third derivative of at most 1e3, and 1e-16/h.
TEST(Stretching, ForceIsTheDerivativeOfTheEnergyAndSlopeThatOfTheForce) {
  for (const Stretch& form : every_form())
    for (double D = 0.55; D < 1.09; D += 0.047) {
      const double h = 1e-5;
      const Stretched s = stretched(form, 1.3, 0.8, D), up = stretched(form, 1.3, 0.8, D + h),
                      down = stretched(form, 1.3, 0.8, D - h);
      EXPECT_NEAR((up.U - down.U) / (2 * h), s.N, 1e-6 * (1 + std::abs(s.N)));
      EXPECT_NEAR((up.N - down.N) / (2 * h), s.c, 1e-6 * (1 + std::abs(s.c)));
    }
}

TEST(Stretching, AllFormsButTheTableHaveTheStiffnessAtRest) {
  for (const Stretch& form : every_form()) {
    if (form.form == StretchForm::table) continue;
    const Stretched s = stretched(form, 1.3, 0.8, 0.8);
    EXPECT_EQ(s.U, 0.0);
    EXPECT_EQ(s.N, 0.0);
    EXPECT_NEAR(s.c, 1.3, 1e-15);
  }
}

TEST(Stretching, HasTheForcesAndSlopesOfTheReference) {
  const json nl1 = material_case("NL1")["expected"];
  const std::vector<Stretch> forms = every_form();
  const auto at = [&](std::size_t form, double u) { return stretched(forms[form], 1.0, 1.0, 1.0 + u); };
  const json &morse = nl1["morse"], &fene = nl1["fene"], &cubic = nl1["cubic"];
  EXPECT_NEAR(at(3, morse["at_u"]).N, morse["max_force"], 1e-12);
  EXPECT_NEAR(at(3, morse["at_u"]).c, 0.0, 1e-12);
  EXPECT_NEAR(at(3, morse["tangent_at"]["u"]).c, morse["tangent_at"]["c"], 1e-12);
  for (const char* turn : {"u_min", "u_max"}) {
    EXPECT_NEAR(at(3, morse[turn]).U, morse["relative_energy"], 1e-12);
    EXPECT_NEAR(at(0, cubic[turn]).U, cubic["energy"], 1e-12);
  }
  EXPECT_NEAR(at(2, fene["amplitude"]).N, fene["force"], 1e-12);
  EXPECT_NEAR(at(2, fene["amplitude"]).c, fene["tangent"], 1e-11);
}

TEST(Stretching, TableIsTheNaturalSplineOfTheReference) {
  const json nl3 = material_case("NL3"), expected = nl3["expected"];
  Stretch form;
  form.form = StretchForm::table;
  form.table.count = nl3["setup"]["D"].size();
  for (std::size_t k = 0; k < form.table.count; ++k)
    form.table.D[k] = nl3["setup"]["D"][k], form.table.U[k] = nl3["setup"]["U"][k];
  make_spline(form.table);
  for (std::size_t k = 0; k < expected["at"].size(); ++k) {
    const Stretched s = stretched(form, 1.0, 1.0, expected["at"][k]);
    EXPECT_NEAR(s.U, expected["U"][k], 1e-12);
    EXPECT_NEAR(s.N, expected["N"][k], 1e-12);
    EXPECT_NEAR(s.c, expected["c"][k], 1e-12);
  }
}

}  // namespace
}  // namespace vbond::rules_test
