// Bonds that flow, whatever they remember: energy, loads and books.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "driven_bond.hpp"
#include "random_pose.hpp"
#include "vbond/core/dual.hpp"

namespace vbond::flowing_test {
namespace {

/// One end held, the other turned by 4 rad where it is: the bond is sheared far, and its two ends do not lie
/// opposite. The work, by the trapezium rule, is what is stored and dissipated, with an error of its second
/// order.
TYPED_TEST(FlowingBond, KeepsItsBooksWhereItHardensAndIsTurnedFar) {
  BondRules rules;
  rules.yield.limit.bending = 2e-4, rules.yield.kinematic.bending = 5e-4;
  double error[2];
  for (const int steps : {1000, 4000}) {
    Driven<TypeParam> bond(rules);
    double work = 0.0, moment = 0.0;
    BondPose<double> b;
    for (int k = 1; k <= steps; ++k) {
      b = pose_of(1.0, {}, about(unit_z, 4.0 * k / steps));
      bond.move_to(b);
      const double before = std::exchange(moment, bond.loads(b).M_ji.z);
      work -= 0.5 * (before + moment) * 4.0 / steps;
    }
    error[steps == 4000] = (bond.energy(b) + bond[memory::dissipated]) / work - 1.0;
    EXPECT_GT(bond[memory::bending], 1.0);
  }
  EXPECT_LT(std::abs(error[0]), 1e-5);
  EXPECT_LT(std::abs(error[1]), 1e-6);
}

/// A flowing bond with attachments and a memory of any kind, between ends that stand anywhere.
template <class Law>
struct AnyBond {
  BondRules rules;
  Law law;
  LawHistory<Law> h{};
  BondPose<double> pose;
  BondRates<double> rates;

  explicit AnyBond(testing::PoseSource& random) {
    rules.yield.limit = {0.02, 0.03, 0.02, 0.01};
    rules.yield.compression = 0.03;
    rules.yield.isotropic = {0.1, 0.1, 0.05, 0.02};
    rules.yield.kinematic = {0.2, 0.0, 0.1, 0.1};
    rules.creep = {0.5, 3};
    const double a = random.uniform(0.5, 1.5);
    law = Law::from({1.0, random.uniform(0.1, 1.0), random.uniform(0.1, 0.5), random.uniform(0.1, 0.5)}, a,
                    random.uniform(0.0, 0.4), random.uniform(0.0, 0.4));
    law.rules = &rules;
    for (std::size_t k = 0; k < memory::axial; ++k) h.value[k] = random.uniform(-0.1, 0.1);
    for (std::size_t k = memory::axial; k < memory::bent; ++k) h.value[k] = random.uniform(0.0, 0.2);
    for (std::size_t k = memory::bent; k < memory::damage; ++k) h.value[k] = random.uniform(-0.1, 0.1);
    h.value[memory::damage] = random.uniform(0.0, 0.9);
    do pose = random.pair(a + law.R_i + law.R_j, 0.2, 0.4).pose();
    while (norm(bonded_points(pose, law.R_i, law.R_j)) < 0.1);
    rates = {random.vector(0.1), random.vector(0.1), random.vector(0.1)};
  }
  AnyBond(const AnyBond&) = delete;
  BondAxis<double> axis() const { return bond_axis(pose, law.R_i, law.R_j); }
  BondLoads<double> loads() const { return bond_loads(law, pose, axis(), h); }
  double energy() const {
    const BondEnergy<double> U = bond_energy(law, pose, h);
    return U.U_L + U.U_B + U.U_T;
  }
  void advance_by(double dt) { h = advance(law, pose, axis(), rates, dt, h); }
};

using Shift = Dual<12>;
Vec3<Shift> shift_of(std::size_t first) {
  return {Shift::variable(0.0, first), Shift::variable(0.0, first + 1), Shift::variable(0.0, first + 2)};
}
Vec3<Shift> fixed(const Vec3d& a) {
  return {a.x, a.y, a.z};
}

// As for laws without memory: rounding, magnified by 1/|D| <= 10.
TYPED_TEST(FlowingBond, HasLoadsThatAreMinusTheGradientWhateverItRemembers) {
  testing::PoseSource random(15);
  for (int trial = 0; trial < 300; ++trial) {
    const AnyBond<TypeParam> bond(random);
    const auto law = with_scalar<Shift>(bond.law);
    LawHistory<std::remove_const_t<decltype(law)>> h;
    for (std::size_t k = 0; k < memory::count; ++k) h.value[k] = bond.h.value[k];
    BondPose<Shift> p{fixed(bond.pose.r_ij) + shift_of(6) - shift_of(0), {}, {}};
    for (int k = 0; k < 3; ++k) {
      p.n_i[k] = fixed(bond.pose.n_i[k]) + cross(shift_of(3), fixed(bond.pose.n_i[k]));
      p.n_j[k] = fixed(bond.pose.n_j[k]) + cross(shift_of(9), fixed(bond.pose.n_j[k]));
    }
    const BondEnergy<Shift> e = bond_energy(law, p, h);
    const Shift U = e.U_L + e.U_B + e.U_T;
    const auto slope = [&U](std::size_t k) { return Vec3d{U.d[k], U.d[k + 1], U.d[k + 2]}; };
    const BondLoads<double> l = bond.loads();
    const double size = norm(l.F) + norm(l.M_ij) + norm(l.M_ji);
    EXPECT_LT(
        norm(l.F + slope(0)) + norm(-l.F + slope(6)) + norm(l.M_ij + slope(3)) + norm(l.M_ji + slope(9)),
        1e-12 * size);
    EXPECT_LT(norm(l.M_ij + l.M_ji - cross(bond.pose.r_ij, l.F)), 1e-13 * (1 + size));
    EXPECT_NEAR(dot(l.F, bond.axis().d), tension(bond.law, bond.axis().D, bond.h), 1e-13 * (1 + size));
  }
}

TYPED_TEST(FlowingBond, FlowsAlikeInAnyTurnedWorld) {
  testing::PoseSource random(16);
  for (int trial = 0; trial < 300; ++trial) {
    AnyBond<TypeParam> bond(random);
    const Quatd Q = random.rotation(3.1);
    const BondPose<double> pose = bond.pose;
    const BondRates<double> rates = bond.rates;
    const LawHistory<TypeParam> h = bond.h;
    bond.advance_by(0.1);
    const BondLoads<double> l = bond.loads();
    const LawHistory<TypeParam> now = bond.h;
    EXPECT_GT(now.value[memory::dissipated], h.value[memory::dissipated]);
    for (int k = 0; k < 3; ++k)
      bond.pose.n_i[k] = rotate(Q, pose.n_i[k]), bond.pose.n_j[k] = rotate(Q, pose.n_j[k]);
    bond.pose.r_ij = rotate(Q, pose.r_ij);
    bond.rates = {rotate(Q, rates.v_ij), rotate(Q, rates.w_i), rotate(Q, rates.w_j)};
    bond.h = h;
    bond.advance_by(0.1);
    const BondLoads<double> m = bond.loads();
    EXPECT_LT(
        norm(rotate(Q, l.F) - m.F) + norm(rotate(Q, l.M_ij) - m.M_ij) + norm(rotate(Q, l.M_ji) - m.M_ji),
        1e-10);  // loads are within flow_tolerance of their limits
    for (std::size_t k = 0; k < memory::count; ++k) EXPECT_NEAR(bond.h.value[k], now.value[k], 1e-10) << k;
  }
}

// Bent, twisted and sheared at random by radians, up to 20 times past their limits, where one way of flowing
// takes much from another. What does not come to its limits must not go on with loads that are wrong.
TYPED_TEST(FlowingBond, ComesToAllItsLimitsOrHasNoLoads) {
  testing::PoseSource random(18);
  constexpr double within = 2.0 * flow_apart * (0.03 + 0.1 * 0.2);  // of the largest limit, hardened
  constexpr int trials = 20000;
  int lost = 0;
  for (int trial = 0; trial < trials; ++trial) {
    AnyBond<TypeParam> bond(random);
    bond.rules.creep = {};
    const LawHistory<TypeParam> before = bond.h;
    bond.advance_by(0.0);
    if (!std::isfinite(bond.h.value[memory::dissipated])) {
      const BondLoads<double> l = bond.loads();
      EXPECT_FALSE(std::isfinite(norm(l.F) + norm(l.M_ij) + norm(l.M_ji)));
      ++lost;
      continue;
    }
    FlowAmounts<double> amounts, over{};
    for (std::size_t k = 0; k < ways_to_flow; ++k)
      amounts[k] = bond.h.value[memory::axial + k] - before.value[memory::axial + k];
    flowed_by(amounts, bond.law, bond.pose, bond.axis(), before, over);
    for (std::size_t k = 0; k < ways_to_flow; ++k) {
      EXPECT_LT(over[k], within) << trial;
      if (amounts[k] > 0.0) {
        EXPECT_GT(over[k], -within) << trial;
      }
    }
  }
  EXPECT_LT(lost, trials / 1000);
}

// Swapped, the frame's first and third axis point the other way.
TYPED_TEST(FlowingBond, FlowsAlikeWhicheverEndIsCalledI) {
  testing::PoseSource random(17);
  for (int trial = 0; trial < 300; ++trial) {
    AnyBond<TypeParam> bond(random);
    for (double& x : bond.h.value) x = 0.0;  // the memory of the other end is known for none
    const BondPose<double> pose = bond.pose;
    const BondRates<double> rates = bond.rates;
    const auto drive = [&bond] {
      for (int k = 0; k < 3; ++k) bond.advance_by(0.1);
      return bond.loads();
    };
    const BondLoads<double> l = drive();
    const double dissipated = bond.h.value[memory::dissipated];
    std::swap(bond.law.R_i, bond.law.R_j);
    bond.pose.r_ij = -pose.r_ij;
    for (int k = 0; k < 3; ++k) bond.pose.n_i[k] = pose.n_j[k], bond.pose.n_j[k] = pose.n_i[k];
    bond.pose.n_i[2] = -bond.pose.n_i[2], bond.pose.n_j[2] = -bond.pose.n_j[2];
    bond.rates = {-rates.v_ij, rates.w_j, rates.w_i};
    for (double& x : bond.h.value) x = 0.0;
    const BondLoads<double> m = drive();
    EXPECT_LT(norm(l.F + m.F) + norm(l.M_ij - m.M_ji) + norm(l.M_ji - m.M_ij), 1e-10);
    EXPECT_NEAR(bond.h.value[memory::dissipated], dissipated, 1e-10);
  }
}

// A step of flow takes no more from the energy of the bond than it says, and never gives.
TYPED_TEST(FlowingBond, DissipatesWhatItTakesFromTheEnergy) {
  testing::PoseSource random(18);
  for (int trial = 0; trial < 300; ++trial) {
    AnyBond<TypeParam> bond(random);
    bond.rules.creep = {};
    bond.h.value[memory::damage] = 0.0;
    const double dissipated = bond.h.value[memory::dissipated], before = bond.energy();
    bond.advance_by(0.1);
    const double taken = before - bond.energy(), booked = bond.h.value[memory::dissipated] - dissipated;
    EXPECT_GE(booked, 0.0);
    EXPECT_GT(taken, booked);  // loads fall to their limits on the way
  }
}

TYPED_TEST(FlowingBond, KeepsItsAttachmentsWhereTheyAreWhenItsFramesTurn) {
  BondRules rules;
  Driven<TypeParam> bond(rules);
  bond.law.R_i = 0.3;
  bond.h.value[memory::turn_i + 2] = std::tan(0.2 / 4);  // the frame of i turned by 0.2 about its third axis
  const BondPose<double> b = pose_of(1.3, {}, {});
  EXPECT_EQ(elastic_pose(bond.law, b, bond.h).r_ij, unit_x);
  // i turned back by as much finds its frame at rest; the arm turns with it
  const BondPose<double> back = {
      Vec3d{1, 0, 0} + 0.3 * rotate(about(unit_z, -0.2), unit_x),
      {rotate(about(unit_z, -0.2), unit_x), rotate(about(unit_z, -0.2), unit_y), unit_z},
      {-unit_x, unit_y, unit_z}};
  EXPECT_LT(norm(bond.loads(back).F) + norm(bond.loads(back).M_ij), 1e-15);
}

TYPED_TEST(FlowingBond, RemembersNothingOfARigidMotion) {
  testing::PoseSource random(19);
  AnyBond<TypeParam> bond(random);
  for (double& x : bond.h.value) x = 0.0;
  const double reach = bond.law.a + bond.law.R_i + bond.law.R_j;
  for (int k = 0; k < 100; ++k) {
    bond.pose = random.pair(reach, 0.0, 0.0).pose();
    bond.rates = {};
    bond.advance_by(0.1);
  }
  for (std::size_t k = 0; k < memory::count; ++k) EXPECT_NEAR(bond.h.value[k], 0.0, 1e-13) << k;
}

}  // namespace
}  // namespace vbond::flowing_test
