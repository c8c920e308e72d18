// Bonds that creep and soften, one at a time, driven by hand: against closed forms of materials.json.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "driven_bond.hpp"
#include "hardening_law.hpp"
#include "material_cases.hpp"
#include "random_pose.hpp"
#include "vbond/physics/laws.hpp"

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
  for (std::size_t k = 0; k < s["t"].size(); ++k) {
    const double t = s["t"][k], exact = c["expected"]["maxwell"][k];
    const double coarse = relaxed<TypeParam>(maxwell, N_0, t, 400) - exact;
    const double fine = relaxed<TypeParam>(maxwell, N_0, t, 800) - exact;
    EXPECT_LT(std::abs(fine), 1e-6 * N_0) << "t = " << t;
    if (t > 1.0) {
      EXPECT_NEAR(coarse / fine, 4.0, 0.2) << "t = " << t;
    }
    // exact whatever the step: what is left is the rounding of D - a, 2e-16 at most in each step
    EXPECT_NEAR(relaxed<TypeParam>(norton, N_0, t, 400), c["expected"]["norton"][k], 400 * 3e-16);
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

// N' = -c k N^n from N_0 on is (N_0^(1-n) + (n-1) c k t)^(1/(1-n)), also where the first rate would take N
// to zero a million times in a step.
TYPED_TEST(FlowingBond, RelaxesByNortonsLawWhateverTheStep) {
  constexpr double N_0 = 0.02;
  for (const int n : {2, 3, 4, 5, 6, 7, 8, 9})
    for (const double x : {1e-9, 1e-3, 0.5, 4.0, 64.0, 1e6}) {
      BondRules rules;
      rules.creep = {x / std::pow(N_0, n - 1), static_cast<std::size_t>(n)};
      Driven<TypeParam> bond(rules);
      for (int step = 1; step <= 10; ++step) {
        bond.move_to(pose_of(1.0 + N_0, {}, {}), 1.0);
        const double m = n - 1.0, fall = std::expm1(std::log1p(m * x * step) / m);  // N_0/N - 1
        EXPECT_NEAR(tension(bond.law, 1.0 + N_0, bond.h), N_0 / (1.0 + fall), step * 3e-16)
            << "n = " << n << ", x = " << x << ", step " << step;
        // of little creep nothing is lost
        EXPECT_NEAR(bond[memory::crept] / (N_0 * fall / (1.0 + fall)), 1.0, 1e-12 + 1e-15 / (N_0 * fall));
      }
    }
}

// Pulled to and fro: N has no closed form, and three steps tell the order.
TYPED_TEST(FlowingBond, CreepsToSecondOrderWhileItIsDriven) {
  for (const int n : {1, 2, 3, 5, 9}) {
    BondRules rules;
    rules.creep = {0.5 / std::pow(0.02, n - 1), static_cast<std::size_t>(n)};
    const auto left = [&](int steps) {
      Driven<TypeParam> bond(rules);
      double D = 1.0;
      for (int k = 1; k <= steps; ++k) {
        const double t = 3.0 * k / steps, next = 1.0 + 0.03 * std::sin(2.0 * t), dt = 3.0 / steps;
        bond.move_to(pose_of(next, {}, {}), dt, {{(next - D) / dt, 0, 0}, {}, {}});
        D = next;
      }
      return tension(bond.law, D, bond.h);
    };
    const double coarse = left(400), middle = left(800), fine = left(1600);
    EXPECT_NEAR((coarse - middle) / (middle - fine), 4.0, 0.1) << "n = " << n;
  }
}

TEST(RootOf, IsThatOfTheLibrary) {
  for (std::size_t n = 1; n <= 8; ++n)
    for (const double y : {1.0, 1.0 + 1e-12, 1.001, 2.0, 10.0, 1e3, 1e6, 1e12, 1e25, 1e50})
      EXPECT_NEAR(root_of(y, n) / std::pow(y, 1.0 / static_cast<double>(n)), 1.0, 3e-14) << n << ", " << y;
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

// ---- laws whose tension is no straight line
// ----------------------------------------------------------------

using OwnFlow = WithFlow<testing::Hardening>::Law<double>;

/// Slope of the tension u (1 + h u^2/u_0^2) at u_0: 1 + 3 h.
constexpr double hardenings[] = {0.0, 0.25, 2.0, 4.0, 10.0, 50.0};

// The tension falls along the line all the same, and what is dissipated is the area below the path less what
// can be had back, however many steps lead there.
TEST(SofteningOfAnOwnLaw, FollowsTheLineAndDissipatesTheAreaBelow) {
  constexpr double u_c = 0.05, u_f = 0.2;
  for (const double hardening : hardenings)
    for (const int steps : {1, 3, 50}) {
      const double per_s2 = hardening / (u_c * u_c), N_c = u_c * (1.0 + hardening),
                   U_c = u_c * u_c * (0.5 + 0.25 * hardening);
      BondRules rules;
      rules.softening = {N_c, u_f};
      Driven<OwnFlow> bond(rules);
      bond.law.per_s2 = per_s2;
      bond.move_to(pose_of(1.0 + u_c, {}, {}));
      EXPECT_NEAR(bond[memory::damage], 0.0, 1e-11) << hardening;
      for (int k = 1; k <= steps; ++k) {
        const double u = k == steps ? u_f : u_c + (u_f - u_c) * k / steps, N = N_c * (u_f - u) / (u_f - u_c);
        const BondPose<double> b = pose_of(1.0 + u, {}, {});
        bond.move_to(b);
        // u_c is known to 1e-12 of N_c over a slope of N_c/u_c at least; the tension without damage is
        // rounded
        const double rounding = 1e-15 * u * (1.0 + per_s2 * u * u);
        EXPECT_NEAR(tension(bond.law, 1.0 + u, bond.h), N, 1e-12 * N_c + rounding) << hardening << ", " << k;
        EXPECT_NEAR(bond[memory::dissipated] + bond.energy(b), U_c + 0.5 * (N_c + N) * (u - u_c),
                    k * (1e-12 * N_c + rounding))
            << hardening << ", " << k;
      }
      EXPECT_NEAR(bond[memory::damage], 1.0, 1e-15);  // D less a is rounded
    }
}

// From its limit at u_y on, however far it is driven at once.
TEST(YieldOfAnOwnLaw, BringsTheTensionToItsLimit) {
  constexpr double u_y = 0.02;
  for (const double hardening : hardenings)
    for (const double times : {1.1, 3.0, 10.0})
      for (const double sign : {-1.0, 1.0}) {
        BondRules rules;
        rules.yield.limit.axial = rules.yield.compression = u_y * (1.0 + hardening);
        rules.yield.isotropic.axial = 0.1;
        Driven<OwnFlow> bond(rules);
        bond.law.per_s2 = hardening / (u_y * u_y);
        const double D = 1.0 + sign * times * u_y, limit = rules.yield.limit.axial;
        bond.move_to(pose_of(D, {}, {}));
        EXPECT_NEAR(sign * tension(bond.law, D, bond.h), limit + 0.1 * bond[memory::axial],
                    1e-12 * limit + 1e-16)
            << hardening << ", " << times;
        EXPECT_GT(bond[memory::axial], 0.0);
      }
}

/// Held at the elongation u = 0.1 for the time 1 in so many steps, with rate c_A = 1.
Driven<OwnFlow>& relaxed(Driven<OwnFlow>& bond, int steps) {
  for (int k = 0; k < steps; ++k) bond.move_to(pose_of(1.1, {}, {}), 1.0 / steps);
  return bond;
}

TEST(CreepOfAnOwnLaw, NeitherOscillatesNorMakesEnergy) {
  for (const double hardening : hardenings) {
    BondRules rules;
    rules.creep = {1.0, 1};
    Driven<OwnFlow> bond(rules), coarse(rules), fine(rules), exact(rules);
    for (Driven<OwnFlow>* b : {&bond, &coarse, &fine, &exact}) b->law.per_s2 = hardening / 0.01;
    double N = tension(bond.law, 1.1, bond.h), lost = 0.0;
    for (int k = 0; k < 20; ++k) {  // steps as long as the time of relaxation at rest
      bond.move_to(pose_of(1.1, {}, {}), 1.0);
      EXPECT_LE(tension(bond.law, 1.1, bond.h), N) << hardening << ", " << k;
      EXPECT_GE(tension(bond.law, 1.1, bond.h), 0.0) << hardening << ", " << k;
      EXPECT_GE(bond[memory::dissipated], lost) << hardening << ", " << k;
      N = tension(bond.law, 1.1, bond.h), lost = bond[memory::dissipated];
    }
    const double end = tension(exact.law, 1.1, relaxed(exact, 20000).h);
    const double error = std::abs(tension(coarse.law, 1.1, relaxed(coarse, 500).h) - end),
                 less = std::abs(tension(fine.law, 1.1, relaxed(fine, 1000).h) - end);
    EXPECT_GT(error / less, 3.0) << hardening;  // second order: 4
    EXPECT_LT(error / less, 5.0) << hardening;
  }
}

/// The root of a function that falls, between low and high.
template <class F>
double falls_through_zero(F f, double low, double high) {
  for (int k = 0; k < 200; ++k) (f(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

// Random laws and paths against bisection: limits that harden and shift, or a tension that falls along a
// line.
TEST(FlowOfOwnLaws, FollowsRandomPathsAsBisectionDoes) {
  testing::PoseSource random(39);
  int wrong = 0, flowed = 0, softened = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const double u_0 = random.uniform(0.005, 0.05), hardening = std::pow(10.0, random.uniform(-2.0, 1.7));
    const double per_s2 = hardening / (u_0 * u_0), limit = u_0 * (1.0 + hardening),
                 u_f = random.uniform(1.5, 6.0) * u_0;
    const auto N = [per_s2](double u) { return u * (1.0 + per_s2 * u * u); };
    const bool softens = trial % 2 == 0;
    BondRules rules;
    if (softens) {
      rules.softening = {limit, u_f};
    } else {
      rules.yield.limit.axial = rules.yield.compression = limit;
      rules.yield.isotropic.axial = random.uniform(0.0, 1.0),
      rules.yield.kinematic.axial = random.uniform(0.0, 1.0);
    }
    Driven<OwnFlow> bond(rules);
    bond.law.per_s2 = per_s2;
    double u_p = 0.0, all = 0.0, whole = 1.0;
    for (int step = 0; step < 20; ++step) {
      const double u = random.uniform(softens ? -1.0 : -4.0, softens ? 1.1 * u_f / u_0 : 4.0) * u_0;
      bond.move_to(pose_of(1.0 + u, {}, {}));
      double expected = 0.0;
      if (softens) {
        if (u > u_0) whole = std::min(whole, limit * std::max(u_f - u, 0.0) / (u_f - u_0) / N(u));
        expected = u > 0.0 ? whole * N(u) : N(u);
        softened += whole < 1.0;
      } else {
        const double H = rules.yield.isotropic.axial, K = rules.yield.kinematic.axial;
        const double sign = N(u - u_p) > K * u_p ? 1.0 : -1.0;
        const auto over = [&](double x) {
          return sign * (N(u - u_p - sign * x) - K * (u_p + sign * x)) - limit - H * (all + x);
        };
        if (over(0.0) > 0.0) {
          const double x = falls_through_zero(over, 0.0, 10.0 * u_0);
          u_p += sign * x, all += x, ++flowed;
        }
        expected = N(u - u_p);
      }
      // each flow is at its limit to 1e-12, and 20 of them add up
      wrong += !(std::abs(tension(bond.law, 1.0 + u, bond.h) - expected) <= 1e-9 * (limit + std::abs(N(u))));
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(flowed, 1000);
  EXPECT_GT(softened, 1000);
  RecordProperty("flowed", flowed), RecordProperty("softened", softened);
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
