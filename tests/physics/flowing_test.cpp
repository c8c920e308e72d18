// Bonds that yield, creep and soften, one at a time, driven by hand: against closed forms of materials.json.
#include "vbond/physics/flow_tangent.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "material_cases.hpp"
#include "random_pose.hpp"
#include "vbond/core/dual.hpp"

namespace vbond::flowing_test {
namespace {

constexpr BondStiffness<double> slender{1.0, 0.03, 0.0025, 1.0 / 480};
const Vec3d unit_x{1, 0, 0}, unit_y{0, 1, 0}, unit_z{0, 0, 1};

BondPose<double> pose_of(double D, const Quatd& q_i, const Quatd& q_j) {
  return {D * unit_x,
          {rotate(q_i, unit_x), rotate(q_i, unit_y), rotate(q_i, unit_z)},
          {rotate(q_j, -unit_x), rotate(q_j, unit_y), rotate(q_j, unit_z)}};
}

/// One bond between particles that are put anywhere, and what it remembers.
template <class Law>
struct Driven {
  BondRules rules;
  Law law = Law::from(slender, 1.0, 0.0, 0.0);
  LawHistory<Law> h{};

  explicit Driven(const BondRules& r) : rules(r) { law.rules = &rules; }
  Driven(const Driven&) = delete;
  void move_to(const BondPose<double>& b, double dt = 1.0, const BondRates<double>& rates = {}) {
    h = advance(law, b, bond_axis(b, law.R_i, law.R_j), rates, dt, h);
  }
  BondLoads<double> loads(const BondPose<double>& b) const {
    return bond_loads(law, b, bond_axis(b, law.R_i, law.R_j), h);
  }
  SectionMoments<double> moments(const BondPose<double>& b) const {
    return section_moments(b, law.R_i, law.R_j, loads(b));
  }
  double energy(const BondPose<double>& b) const {
    const BondEnergy<double> U = bond_energy(law, b, h);
    return U.U_L + U.U_B + U.U_T;
  }
  double operator[](std::size_t k) const { return h.value[k]; }
};

template <class Law>
class FlowingBond : public ::testing::Test {};
using FlowingLaws = ::testing::Types<FlowingVModel<double>, FlowingEvm<double>>;
TYPED_TEST_SUITE(FlowingBond, FlowingLaws);

Quatd about(const Vec3d& axis, double angle) {
  return rotation_of(angle * axis);
}

// ---- PL1: axial cycles, any size of step -------------------------------------------------------------

TYPED_TEST(FlowingBond, FollowsAxialCyclesExactlyInAnyNumberOfSteps) {
  for (const std::string id : {"PL1a", "PL1b", "PL1c"})
    for (const int steps : {1, 7, 100}) {
      const nlohmann::json c = testing::material_case(id);
      const auto& setup = c["setup"];
      BondRules rules;
      rules.yield.limit.axial = rules.yield.compression = setup["N_y"];
      rules.yield.isotropic.axial = setup["H_iso"];
      rules.yield.kinematic.axial = setup["H_kin"];
      Driven<TypeParam> bond(rules);
      double u = 0.0;
      for (const auto& row : c["expected"]["rows"]) {
        const double from = u, to = row["u"];
        for (int k = 1; k <= steps; ++k) {
          u = from + (to - from) * k / steps;
          bond.move_to(pose_of(1.0 + u, {}, {}));
        }
        u = to;
        const double stored = row["back_stress_energy"], work = row["plastic_work"];
        EXPECT_NEAR(tension(bond.law, 1.0 + u, bond.h), row["N"], 1e-12) << id << ", u = " << u;
        EXPECT_NEAR(bond[memory::stretch], row["u_p"], 1e-12);
        EXPECT_NEAR(bond[memory::axial], row["alpha"], 1e-12);
        EXPECT_NEAR(bond[memory::dissipated], work - stored, 1e-12);
        EXPECT_NEAR(bond.energy(pose_of(1.0 + u, {}, {})), 0.5 * std::pow(row["N"].get<double>(), 2) + stored,
                    1e-12);
      }
    }
}

TYPED_TEST(FlowingBond, MayYieldEarlierInCompression) {
  BondRules rules;
  rules.yield.limit.axial = 0.02, rules.yield.compression = 0.01;
  Driven<TypeParam> bond(rules);
  bond.move_to(pose_of(0.95, {}, {}));
  EXPECT_NEAR(tension(bond.law, 0.95, bond.h), -0.01, 1e-15);
  bond.move_to(pose_of(1.05, {}, {}));
  EXPECT_NEAR(tension(bond.law, 1.05, bond.h), 0.02, 1e-15);
}

// ---- PL2, PL2t: bending and twist --------------------------------------------------------------------

/// Turns the ends by -t/2 and t/2 about an axis through the turning points, and gives what `see` sees there.
template <class Law, class See>
void turn_to_and_fro(Driven<Law>& bond, const Vec3d& axis, const std::vector<double>& points, int steps,
                     See see) {
  double t = 0.0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const double from = t;
    for (int k = 1; k <= steps; ++k) {
      t = from + (points[n] - from) * k / steps;
      bond.move_to(pose_of(1.0, about(axis, -0.5 * t), about(axis, 0.5 * t)));
    }
    see(n, pose_of(1.0, about(axis, -0.5 * t), about(axis, 0.5 * t)));
  }
}
/// The relative turn of the frames about an axis.
template <class Law>
double flowed_angle(const Driven<Law>& bond, const Vec3d& axis) {
  const FlowTurns<double> q = turns_of<Law>(bond.h);
  return dot(axis, rotation_vector(q.i)) - dot(axis, rotation_vector(q.j));
}

TYPED_TEST(FlowingBond, BendsToAndFroAtItsYieldMoment) {
  const nlohmann::json c = testing::material_case("PL2");
  const auto& expected = c["expected"][std::is_same_v<TypeParam, FlowingEvm<double>> ? "evm" : "vmodel"];
  BondRules rules;
  rules.yield.limit.bending = 8e-4;
  for (const double sign : {1.0, -1.0})
    for (const Vec3d& axis : {unit_z, unit_y}) {
      Driven<TypeParam> bond(rules);
      turn_to_and_fro(bond, sign * axis, c["expected"]["turning_points"], 250,
                      [&](std::size_t n, const auto& b) {
                        const auto& row = expected["rows"][n];
                        EXPECT_NEAR(dot(bond.moments(b).middle, sign * axis), row["moment"], 1e-9 * 8e-4);
                        EXPECT_NEAR(flowed_angle(bond, sign * axis), row["plastic_angle"], 1e-7);
                        EXPECT_NEAR(bond[memory::dissipated], row["dissipated"], 1e-6);
                      });
    }
}

TYPED_TEST(FlowingBond, TwistsFarPastARightAngleWithoutSnapping) {
  if constexpr (std::is_same_v<TypeParam, FlowingVModel<double>>) {
    const nlohmann::json c = testing::material_case("PL2t");
    BondRules rules;
    rules.yield.limit.torsion = 4e-4;
    Driven<TypeParam> bond(rules);
    turn_to_and_fro(bond, unit_x, {2.5, -2.5, 0.0}, 500, [&](std::size_t n, const auto& b) {
      const auto& row = c["expected"]["rows"][n];
      EXPECT_NEAR(dot(bond.moments(b).middle, unit_x), row["torque"], 1e-9 * 4e-4);
      EXPECT_NEAR(flowed_angle(bond, unit_x), row["plastic_angle"], 1e-6);
      EXPECT_NEAR(bond[memory::dissipated], row["dissipated"], 1e-6);
      EXPECT_EQ(bond_range(bond.law, bond_shape(elastic_pose(bond.law, b, bond.h), 0, 0)), BondRange::good);
    });
  }
}

// ---- shear, hardening ---------------------------------------------------------------------------------

/// End i turned by t about z, j held back so that only shear is left: both ends turned alike by t.
BondPose<double> sheared(double t) {
  return pose_of(1.0, about(unit_z, t), about(unit_z, t));
}

TYPED_TEST(FlowingBond, SlidesAtItsYieldForce) {
  BondRules rules;
  rules.yield.limit.shear = 2e-3;
  Driven<TypeParam> bond(rules);
  double plastic_work = 0.0, V = 0.0;
  for (int k = 1; k <= 200; ++k) {
    bond.move_to(sheared(1e-3 * k));
    const double before = V;
    V = -bond.loads(sheared(1e-3 * k)).F.y;
    plastic_work += 0.5 * (before + V) * 1e-3;
  }
  EXPECT_NEAR(std::abs(V), 2e-3, 1e-14);
  EXPECT_NEAR(bond[memory::shear], 0.2 - 2e-3 / slender.c_D, 2e-3);  // the V-model's sine: 1e-3
  EXPECT_NEAR(bond[memory::dissipated] + bond.energy(sheared(0.2)), std::abs(plastic_work), 1e-7);
}

// One material, hardening in bending and torsion: the moment grows from the limit on by c H/(c + H), and what
// is stored can be had back.
TYPED_TEST(FlowingBond, HardensInBendingAndTorsion) {
  for (const bool kinematic : {false, true})
    for (const Vec3d& axis : {unit_x, unit_z}) {
      const bool twists = axis == unit_x;
      const double H = 2e-4, small = 1e-5, c = twists ? slender.c_T : slender.c_B;
      BondRules rules;
      rules.yield.limit.bending = rules.yield.limit.torsion = c * small;
      (kinematic ? rules.yield.kinematic : rules.yield.isotropic).bending = H;
      (kinematic ? rules.yield.kinematic : rules.yield.isotropic).torsion = H;
      Driven<TypeParam> bond(rules);
      turn_to_and_fro(bond, axis, {3.0 * small, -3.0 * small}, 10, [&](std::size_t n, const auto& b) {
        // small turns: linear, to 1e-10 of it
        const double x = 2.0 * small * c / (c + H), M = dot(bond.moments(b).middle, axis);
        const double limit = c * small + H * x;
        const double back = 6.0 * small - 2.0 * (kinematic ? c * small : limit) / c;
        const double second = back * c / (c + H);
        const double expected = n == 0 ? limit : kinematic ? -limit : -(limit + H * second);
        EXPECT_NEAR(M, expected, 1e-7 * limit) << kinematic << ", twisted: " << twists << ", " << n;
        const double elastic = 0.5 * M * M / c, shift = twists ? bond[memory::twisted] : 0.0;
        const double bent = twists ? 0.0 : std::hypot(bond[memory::bent], bond[memory::bent + 1]);
        EXPECT_NEAR(bond.energy(b), elastic + (kinematic ? 0.5 * H * (shift * shift + bent * bent) : 0.0),
                    1e-7 * elastic + 2e-18);
      });
    }
}

// ---- what holds for any memory -----------------------------------------------------------------------

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

// ---- PL5: loads of a section ----------------------------------------------------------------------------

TEST(PlasticSection, HasTheLoadsOfASolidCircle) {
  const nlohmann::json e = testing::material_case("PL5")["expected"];
  const FlowLimits first = first_yield_loads(circle(0.2), 1.0, 1.0),
                   all = plastic_loads_of_circle(0.2, 1.0, 1.0);
  EXPECT_NEAR(all.axial, e["N_y"], 1e-12);
  EXPECT_NEAR(first.axial, e["N_y"], 1e-12);
  EXPECT_NEAR(first.bending, e["M_first_yield"], 1e-12);
  EXPECT_NEAR(all.bending, e["M_plastic"], 1e-12);
  EXPECT_NEAR(first.torsion, e["T_first_yield"], 1e-12);
  EXPECT_NEAR(all.torsion, e["T_plastic"], 1e-12);
}

// Any rotation, also by more than half a turn, comes back the same.
TEST(RotationByQuarter, HoldsAnyRotation) {
  testing::PoseSource random(20);
  for (int trial = 0; trial < 300; ++trial) {
    const Quatd q = random.rotation(6.2), p = rotation_by_quarter(quarter_of_rotation(q));
    const double sign = q.w * p.w + q.x * p.x + q.y * p.y + q.z * p.z;
    EXPECT_NEAR(std::abs(sign), 1.0, 1e-15);
    EXPECT_LE(norm(quarter_of_rotation(q)), 1.0 + 1e-15);
  }
  EXPECT_EQ(rotation_by_quarter(Vec3d{}), Quatd{});
}

}  // namespace
}  // namespace vbond::flowing_test
