// Bonds that creep and soften, one at a time, driven by hand: against closed forms of materials.json.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "driven_bond.hpp"
#include "hardening_law.hpp"
#include "material_cases.hpp"

namespace vbond::flowing_test {
namespace {

// ---- CR1: creep ----------------------------------------------------------------------------------------

/// The tension that is left at time t of a bond held at its length.
template <class Law>
double relaxed(const BondRules& rules, double N_0, double t, int steps) {
  Driven<Law> bond(rules);
  for (int k = 0; k < steps; ++k) bond.move_to(pose_of(1.0 + N_0, {}, {}), t / steps);
  EXPECT_NEAR(bond[memory::dissipated] + 0.5 * sq(N_0 - bond[memory::crept]), 0.5 * sq(N_0), 1e-17);
  return tension(bond.law, 1.0 + N_0, bond.h);
}

TYPED_TEST(FlowingBond, RelaxesByCreepToSecondOrderInTheStep) {
  const nlohmann::json c = testing::material_case("CR1");
  const auto& s = c["setup"];
  const double N_0 = s["N0"];
  BondRules maxwell, norton;
  maxwell.creep = {1.0 / s["eta"].get<double>(), 1};
  norton.creep = {s["A"], s["n"]};
  for (const auto& [name, rules] : {std::pair{"maxwell", maxwell}, {"norton", norton}})
    for (std::size_t k = 0; k < s["t"].size(); ++k) {
      const double t = s["t"][k], exact = c["expected"][name][k];
      const double coarse = relaxed<TypeParam>(rules, N_0, t, 400) - exact;
      const double fine = relaxed<TypeParam>(rules, N_0, t, 800) - exact;
      EXPECT_LT(std::abs(fine), 1e-6 * N_0) << name << ", t = " << t;
      if (t > 1.0) {
        EXPECT_NEAR(coarse / fine, 4.0, 0.2) << name << ", t = " << t;
      }
    }
}

TYPED_TEST(FlowingBond, CreepsWithoutOscillationWhateverTheStep) {
  BondRules rules;
  rules.creep = {1e4, 1};
  Driven<TypeParam> bond(rules);
  for (int k = 0; k < 5; ++k) {
    bond.move_to(pose_of(1.02, {}, {}), 10.0);
    EXPECT_GE(tension(bond.law, 1.02, bond.h), -1e-16);
  }
}

// ---- SO1: softening --------------------------------------------------------------------------------------

TYPED_TEST(FlowingBond, SoftensAlongTheLineOfItsFractureEnergy) {
  const nlohmann::json c = testing::material_case("SO1");
  for (const auto& [name, n] : {std::pair{"n4", 4}, {"n20", 20}}) {
    const auto& e = c["expected"][name];
    BondRules rules;
    rules.softening = {0.02, e["u_f"]};
    Driven<TypeParam> bond(rules);
    for (const auto& point : e["points"]) {
      const double u = point["damaged_bond"], N = point["N"];
      bond.move_to(pose_of(1.0 + u, {}, {}));
      EXPECT_NEAR(tension(bond.law, 1.0 + u, bond.h), N, 1e-14);
      EXPECT_NEAR(u + (n - 1) * tension(bond.law, 1.0 + u, bond.h), point["total"], 1e-6);
      // towards the origin and back: nothing more happens
      const double damage = bond[memory::damage], dissipated = bond[memory::dissipated];
      bond.move_to(pose_of(1.0 + 0.3 * u, {}, {}));
      EXPECT_NEAR(tension(bond.law, 1.0 + 0.3 * u, bond.h), 0.3 * N, 1e-14);
      bond.move_to(pose_of(0.9, {}, {}));
      EXPECT_NEAR(tension(bond.law, 0.9, bond.h), -0.1, 1e-14);
      EXPECT_EQ(bond[memory::damage], damage);
      EXPECT_EQ(bond[memory::dissipated], dissipated);
    }
    EXPECT_EQ(bond[memory::damage], 1.0);
    EXPECT_NEAR(bond[memory::dissipated], e["energy_total"], 1e-15);
    const BondPose<double> b = pose_of(1.3, {}, {});
    EXPECT_GE(utilisation(bond.law, b, bond_axis(b, 0.0, 0.0), bond.loads(b), bond.h), 1.0);
  }
}

// Of a law whose tension is no straight line: the tension falls along the line all the same, and what is
// dissipated is the area below the path less what can be had back, however many steps lead there.
TEST(SofteningOfAnOwnLaw, FollowsTheLineAndDissipatesTheAreaBelow) {
  using Law = WithFlow<testing::Hardening>::Law<double>;
  constexpr double per_s2 = 100.0, u_c = 0.05, u_f = 0.2;
  constexpr double N_c = u_c * (1.0 + per_s2 * u_c * u_c),
                   U_c = 0.5 * u_c * u_c + 0.25 * per_s2 * u_c * u_c * u_c * u_c;
  for (const int steps : {1, 3, 50}) {
    BondRules rules;
    rules.softening = {N_c, u_f};
    Driven<Law> bond(rules);
    bond.law.per_s2 = per_s2;
    bond.move_to(pose_of(1.0 + u_c, {}, {}));
    EXPECT_NEAR(bond[memory::damage], 0.0, 1e-12);
    for (int k = 1; k <= steps; ++k) {
      const double u = u_c + (u_f - u_c) * k / steps, N = N_c * (u_f - u) / (u_f - u_c);
      const BondPose<double> b = pose_of(1.0 + u, {}, {});
      bond.move_to(b);
      EXPECT_NEAR(tension(bond.law, 1.0 + u, bond.h), N, 1e-14) << steps << ", " << k;
      // the area is known to the tolerance of u_before, 1e-12 of N_c, in each step
      EXPECT_NEAR(bond[memory::dissipated] + bond.energy(b), U_c + 0.5 * (N_c + N) * (u - u_c),
                  1e-12 * N_c * k);
    }
    EXPECT_EQ(bond[memory::damage], 1.0);
  }
}

// Damage takes its share of bending and torsion, and of tension, but not of compression.
TYPED_TEST(FlowingBond, IsWeakenedByDamageInAllButCompression) {
  BondRules rules;
  rules.softening = {0.02, 0.2};
  Driven<TypeParam> bond(rules), whole(rules);
  bond.move_to(pose_of(1.05, {}, {}));
  const double left = 1.0 - bond[memory::damage];
  EXPECT_GT(left, 0.1);
  EXPECT_LT(left, 0.5);
  for (const double D : {0.95, 1.01}) {
    const BondPose<double> b = pose_of(D, about(unit_z, 0.1), about(unit_x + unit_z, 0.2));
    const BondLoads<double> l = bond.loads(b), m = whole.loads(b);
    EXPECT_NEAR(l.F.x, (D < 1.0 ? 1.0 : left) * m.F.x, 1e-15);
    EXPECT_LT(norm(across(l.F, unit_x) - left * across(m.F, unit_x)), 1e-15);
    EXPECT_LT(norm(l.M_ij - left * m.M_ij) + norm(l.M_ji - left * m.M_ji), 1e-15);
  }
}

}  // namespace
}  // namespace vbond::flowing_test
