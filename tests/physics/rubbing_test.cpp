// Bonds that have cracked: faces that push and rub.
#include "vbond/physics/with_rubbing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cracked.hpp"
#include "random_pose.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/flow_tangent.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond::rubbing_test {
namespace {

using namespace cracked;

template <class Law>
Law law_of_test() {
  Law law = Law::from(c, 1.0, 0.3, 0.2);
  if constexpr (OffsetLaw<Law>) law.o_i2 = 0.1, law.o_i3 = -0.2, law.o_j2 = 0.15, law.o_j3 = 0.05;
  law.rules = &rules;
  return law;
}

double total(const BondEnergy<double>& U) {
  return U.U_L + U.U_B + U.U_T;
}
double size(const BondLoads<double>& l) {
  return norm(l.F) + norm(l.M_ij) + norm(l.M_ji);
}

template <class Law>
class RubbingLaws : public ::testing::Test {};
using All = ::testing::Types<WithRubbing<VModel>::Law<double>, WithRubbing<Evm>::Law<double>,
                             WithOffsets<WithRubbing<VModel>::Law>::Law<double>,
                             WithOffsets<WithRubbing<Evm>::Law>::Law<double>>;
TYPED_TEST_SUITE(RubbingLaws, All);

/// Of 200 poses with shifts and turns of up to 0.3, those whose faces are pressed, with a slip at random.
template <class Law, class F>
void for_pressed(F check) {
  testing::PoseSource random(42);
  const Law law = law_of_test<Law>();
  int pressed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const BondPose<double> pose = random.pair(1.35, 0.3, 0.3).pose();
    const LawHistory<Law> h = slipped<Law>(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
    if (!(bond_energy(law, pose, h).U_L > 1e-4)) continue;
    ++pressed;
    check(law, pose, h);
  }
  EXPECT_GT(pressed, 50);
}

// Both sides are exact derivatives; what is left is rounding of some hundred operations.
TYPED_TEST(RubbingLaws, HaveLoadsThatAreMinusTheGradientOfTheirEnergyAtFixedSlip) {
  for_pressed<TypeParam>(
      [](const TypeParam& law, const BondPose<double>& pose, const LawHistory<TypeParam>& h) {
        using D = Dual<9>;
        const auto m = with_scalar<D>(law);
        LawHistory<std::remove_const_t<decltype(m)>> of_duals;
        for (std::size_t k = 0; k < rubbed::count; ++k) of_duals.value[k] = D(h.value[k]);
        const BondEnergy<D> U = bond_energy(m, moved_pose<9>(pose), of_duals);
        const D all = U.U_L + U.U_B + U.U_T;
        const BondLoads<double> l = loads(law, pose, h);
        const double expected[9] = {l.F.x,     l.F.y,     l.F.z,     -l.M_ij.x, -l.M_ij.y,
                                    -l.M_ij.z, -l.M_ji.x, -l.M_ji.y, -l.M_ji.z};
        for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(all.d[k], expected[k], 1e-13 * (1.0 + size(l)));
        EXPECT_LT(norm(l.M_ij + l.M_ji - cross(pose.r_ij, l.F)), 1e-13 * (1.0 + size(l)));
      });
}

TYPED_TEST(RubbingLaws, AreObjective) {
  testing::PoseSource random(7);
  for_pressed<TypeParam>(
      [&](const TypeParam& law, const BondPose<double>& pose, const LawHistory<TypeParam>& h) {
        const Quatd Q = random.rotation(3.1);
        BondPose<double> turned{rotate(Q, pose.r_ij), {}, {}};
        for (int k = 0; k < 3; ++k)
          turned.n_i[k] = rotate(Q, pose.n_i[k]), turned.n_j[k] = rotate(Q, pose.n_j[k]);
        const LawHistory<TypeParam> now = after(law, pose, h), same = after(law, turned, h);
        for (std::size_t k = 0; k < rubbed::count; ++k) EXPECT_NEAR(now.value[k], same.value[k], 1e-14);
        const BondLoads<double> l = loads(law, pose, now), m = loads(law, turned, same);
        EXPECT_LT(
            norm(rotate(Q, l.F) - m.F) + norm(rotate(Q, l.M_ij) - m.M_ij) + norm(rotate(Q, l.M_ji) - m.M_ji),
            1e-13 * (1.0 + size(l)));
      });
}

// Seen from the other end n and n_3 are reversed: slip has the other sign along t_2, and t_3 is reversed,
// too.
TYPED_TEST(RubbingLaws, DoNotDependOnWhichEndIsCalledI) {
  for_pressed<TypeParam>([](const TypeParam& law, const BondPose<double>& pose,
                            const LawHistory<TypeParam>& h) {
    TypeParam swapped = law;
    std::swap(swapped.R_i, swapped.R_j);
    if constexpr (OffsetLaw<TypeParam>)
      std::swap(swapped.o_i2, swapped.o_j2), swapped.o_i3 = -law.o_j3, swapped.o_j3 = -law.o_i3;
    BondPose<double> other{-pose.r_ij, {}, {}};
    for (int k = 0; k < 3; ++k) other.n_i[k] = pose.n_j[k], other.n_j[k] = pose.n_i[k];
    other.n_i[2] = -other.n_i[2], other.n_j[2] = -other.n_j[2];
    const LawHistory<TypeParam> now = after(law, pose, h),
                                there = after(
                                    swapped, other,
                                    slipped<TypeParam>(-h.value[rubbed::slip], h.value[rubbed::slip + 1]));
    for (const std::size_t k : {rubbed::slip, rubbed::shear}) {
      EXPECT_NEAR(now.value[k], -there.value[k], 1e-14);
      EXPECT_NEAR(now.value[k + 1], there.value[k + 1], 1e-14);
    }
    const BondLoads<double> l = loads(law, pose, now), m = loads(swapped, other, there);
    EXPECT_LT(norm(l.F + m.F) + norm(l.M_ij - m.M_ji) + norm(l.M_ji - m.M_ij), 1e-13 * (1.0 + size(l)));
  });
}

// After a step the shear force is at most mu N, on the cone where the faces have slipped, along the way of
// the slip; what has not slipped keeps all of it.
TYPED_TEST(RubbingLaws, SlipUntilTheShearForceIsOnTheCone) {
  int slid = 0, stuck = 0;
  for_pressed<TypeParam>(
      [&](const TypeParam& law, const BondPose<double>& pose, const LawHistory<TypeParam>& h) {
        const LawHistory<TypeParam> now = after(law, pose, h);
        const double N = std::sqrt(2.0 * c.c_A * bond_energy(law, pose, now).U_L),
                     Q_before = std::sqrt(2.0 * c.c_D * bond_energy(law, pose, h).U_B),
                     Q = std::sqrt(2.0 * c.c_D * bond_energy(law, pose, now).U_B);
        EXPECT_NEAR(Q, std::min(Q_before, mu * N), 1e-14);
        (Q < Q_before ? slid : stuck) += 1;
        const LawHistory<TypeParam> again = after(law, pose, now);  // and then it stays
        for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(again.value[k], now.value[k], 1e-14);
        // from no shear force before, half of that after times the slip
        EXPECT_NEAR(now.value[rubbed::dissipated], 0.5 * Q * (Q_before - Q) / c.c_D, 1e-14);
      });
  EXPECT_GT(slid, 20);
  EXPECT_GT(stuck, 5);
}

TYPED_TEST(RubbingLaws, CarryNothingWhereTheyStandOpen) {
  testing::PoseSource random(5);
  const TypeParam law = law_of_test<TypeParam>();
  int open = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const BondPose<double> pose = random.pair(1.65, 0.3, 0.3).pose();
    const LawHistory<TypeParam> now = after(law, pose, slipped<TypeParam>(0.1, -0.05));
    if (bond_energy(law, pose, now).U_L > 0.0) continue;
    ++open;
    EXPECT_LT(size(loads(law, pose, now)), 1e-15);
    EXPECT_EQ(now.value[rubbed::shear], 0.0);
    EXPECT_EQ(now.value[rubbed::dissipated], 0.0);
  }
  EXPECT_GT(open, 50);
}

/// The pair at rest along x, j then moved by these.
BondPose<double> placed(double gap, double shift, double tilt = 0.0) {
  return bond_pose(BondFrames<double>{}, Vec3d{1.5 + gap, shift, 0}, Quatd{}, rotation_of(Vec3d{0, 0, tilt}));
}

// Pressed by p and sheared to x and back: elastic up to mu N/c_D, then mu N; the work of a loop is the
// dissipation, mu N times the slip, to rounding: steps take the mean of the forces at their ends.
TEST(Rubbing, AShearTestHasTheForcesAndTheWorkOfCoulomb) {
  using Law = WithRubbing<VModel>::Law<double>;
  const Law law = law_of_test<Law>();
  const double p = 0.05, limit = mu * c.c_A * p;
  LawHistory<Law> h = slipped<Law>(0, 0);
  double work = 0.0, F_before = 0.0, x_before = 0.0, slip = 0.0;
  std::vector<double> way;
  for (int k = 0; k <= 100; ++k) way.push_back(0.003 * k);
  for (int k = 0; k <= 200; ++k) way.push_back(0.3 - 0.003 * k);
  double elastic = 0.0;  // plainly: the elastic part of the shift
  for (const double x : way) {
    const BondPose<double> pose = placed(-p, x);
    h = after(law, pose, h);
    const BondLoads<double> l = loads(law, pose, h);
    const double trial = elastic + (x - x_before), most = limit / c.c_D;
    elastic = std::clamp(trial, -most, most);
    slip += std::abs(trial - elastic);
    EXPECT_NEAR(l.F.y, c.c_D * elastic, 1e-15);
    EXPECT_NEAR(l.F.x, -c.c_A * p, 1e-15);
    work += 0.5 * (l.F.y + F_before) * (x - x_before);
    F_before = l.F.y, x_before = x;
  }
  const double stored = total(bond_energy(law, placed(-p, x_before), h)) - 0.5 * c.c_A * sq(p);
  EXPECT_NEAR(work, h.value[rubbed::dissipated] + stored, 1e-14);
  // two steps, in which it begins to slip and turns, have mean forces below the limit
  EXPECT_NEAR(h.value[rubbed::dissipated], limit * slip, 2.0 * limit * 0.003);
  EXPECT_GT(slip, 0.5);
}

// The faces are plane: where they have slipped far they are pressed as deep as before.
TEST(Rubbing, SlipDoesNotLiftThePlaneFaces) {
  using Law = WithRubbing<Evm>::Law<double>;
  const Law law = law_of_test<Law>();
  LawHistory<Law> h = slipped<Law>(0, 0);
  for (int k = 0; k <= 100; ++k) h = after(law, placed(-0.05, 0.006 * k), h);
  EXPECT_NEAR(loads(law, placed(-0.05, 0.6), h).F.x, -0.05 * c.c_A, 1e-15);
  EXPECT_NEAR(h.value[rubbed::slip], 0.6 - mu * 0.05 * c.c_A / c.c_D, 1e-14);
}

// Work along a closed way at random, in steps h: what it dissipates is the work to second order in h.
TYPED_TEST(RubbingLaws, DissipateTheWorkOfAClosedWay) {
  const TypeParam law = law_of_test<TypeParam>();
  std::vector<double> missing;
  for (const int steps : {2000, 4000}) {
    LawHistory<TypeParam> h = slipped<TypeParam>(0, 0);
    double work = 0.0;
    BondPose<double> before;
    BondLoads<double> l_before;
    Vec3d turn_before;
    for (int k = 0; k <= steps; ++k) {
      const double t = 2.0 * M_PI * k / steps;
      const Vec3d r{1.44 + 0.03 * std::cos(t), 0.1 * std::sin(t), 0.08 * std::sin(2 * t)};
      const Vec3d turn{0, 0, 0.1 * std::sin(t)};  // about one axis: the sum of small turns
      const BondPose<double> pose = bond_pose(BondFrames<double>{}, r, Quatd{}, rotation_of(turn));
      h = after(law, pose, h);
      const BondLoads<double> l = loads(law, pose, h);
      if (k > 0)
        work += dot(0.5 * (l.F + l_before.F), pose.r_ij - before.r_ij) -
                dot(0.5 * (l.M_ji + l_before.M_ji), turn - turn_before);
      if (k == 0) work = total(bond_energy(law, pose, h)) + h.value[rubbed::dissipated];
      before = pose, l_before = l, turn_before = turn;
    }
    EXPECT_GT(h.value[rubbed::dissipated], 1e-3);
    missing.push_back(work - total(bond_energy(law, before, h)) - h.value[rubbed::dissipated]);
  }
  EXPECT_LT(std::abs(missing[1]), 1e-6);
  EXPECT_LT(std::abs(missing[1]), 0.4 * std::abs(missing[0]) + 1e-9);
}

// truncation is h^2 times third derivatives of order 10, rounding 1e-16/h
TYPED_TEST(RubbingLaws, HaveATangentThatIsTheDerivativeOfTheLoadsAfterAnIncrement) {
  constexpr double h = 1e-5, tolerance = 1e-8;
  using Numbers = std::array<double, 9>;
  const TypeParam law = law_of_test<TypeParam>();
  const auto loads_after = [&](const BondPose<double>& pose, const LawHistory<TypeParam>& before) -> Numbers {
    const BondLoads<double> l = loads(law, pose, after(law, pose, before));
    return {l.F.x, l.F.y, l.F.z, l.M_ij.x, l.M_ij.y, l.M_ij.z, l.M_ji.x, l.M_ji.y, l.M_ji.z};
  };
  testing::PoseSource source(9);
  int pressed = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const LawHistory<TypeParam> before =
        slipped<TypeParam>(source.uniform(-0.1, 0.1), source.uniform(-0.1, 0.1));
    const testing::RandomPair pair = source.pair(1.4, 0.2, 0.2);
    const double U_L = bond_energy(law, pair.pose(), before).U_L;
    if (U_L > 0.0 && U_L < 1e-4) continue;  // too near to where they open: differences see both sides
    pressed += U_L > 0.0;
    const PairTangent<9> t = flow_tangent(law, pair.pose(), before);
    for (int k = 0; k < 9; ++k) {
      const auto moved = [&](double x) {
        testing::RandomPair p = pair;
        Vec3d step[3];
        component(step[k / 3], k % 3) = x;
        p.r_j += step[0];
        p.q_i = rotation_of(step[1]) * p.q_i;
        p.q_j = rotation_of(step[2]) * p.q_j;
        return loads_after(p.pose(), before);
      };
      const Numbers less = moved(-h), more = moved(h);
      for (std::size_t row = 0; row < 9; ++row)
        EXPECT_NEAR(t.d[row][static_cast<std::size_t>(k)], (more[row] - less[row]) / (2.0 * h), tolerance);
    }
  }
  EXPECT_GT(pressed, 30);
}

// An intact bond is the law with rules: loads, energy and failure.
TYPED_TEST(RubbingLaws, AreTheLawWithRulesUntilTheyCrack) {
  using Inner = typename TypeParam::Inner;
  testing::PoseSource random(3);
  BondRules strong = rules;
  strong.strength = linear_strength(0.3, 0.2, 0.1, 0.1);
  TypeParam law = law_of_test<TypeParam>();
  Inner inner = Inner::from(c, 1.0, 0.3, 0.2);
  law.rules = inner.rules = &strong;
  for (int trial = 0; trial < 50; ++trial) {
    const BondPose<double> pose = random.pair(1.5, 0.3, 0.3).pose();
    BondPose<double> there = pose;
    if constexpr (OffsetLaw<TypeParam>) there = law.at_offsets(pose);
    const LawHistory<TypeParam> none{}, now = after(law, pose, none);
    for (const double x : now.value) EXPECT_EQ(x, 0.0);
    EXPECT_EQ(total(bond_energy(law, pose, none)), total(bond_energy(inner, there)));
    const BondLoads<double> l = loads(law, pose, none), m = bond_loads(inner, there);
    EXPECT_EQ(l.F, m.F);
    EXPECT_NEAR(utilisation(law, pose, bond_axis(law, pose), l, none),
                utilisation(inner, there, bond_axis(inner, there), m), 1e-14);
  }
}

// Cracked in small shear under pressure the faces go on with the shear force that they had, cut at mu N; what
// was in bending and torsion is gone. Small: 1e-4, laws differ by its square.
TEST(Rubbing, KeepsTheShearForceThatFrictionCarries) {
  using Law = WithRubbing<VModel>::Law<double>;
  const Law law = law_of_test<Law>();
  for (const double shift : {0.5e-4, 3e-4}) {
    const BondPose<double> pose = placed(-1e-4, shift);
    const BondAxis<double> axis = bond_axis(law, pose);
    const LawHistory<Law> h = crack(law, pose, axis, {});
    const BondLoads<double> l = bond_loads(law, pose, axis, h), whole = bond_loads(law, pose, axis, {});
    EXPECT_NEAR(l.F.x, whole.F.x, 1e-7);
    EXPECT_NEAR(l.F.y, std::min(whole.F.y, mu * c.c_A * 1e-4), 1e-7);
    EXPECT_EQ(h.value[rubbed::dissipated], 0.0);
    EXPECT_EQ(h.value[rubbed::cracked], 1.0);
    EXPECT_EQ(utilisation(law, pose, axis, l, h), parting(law, pose, axis));
  }
}

// own_radius2 = 4 c_B/c_A = 0.6: faces part when they have moved by its root, along each other or open.
TEST(Rubbing, FacesPartAtTheReach) {
  using Law = WithRubbing<VModel>::Law<double>;
  const Law law = law_of_test<Law>();
  const double reach = std::sqrt(0.6);
  for (const auto& [gap, shift] : {std::pair{0.0, 1.0}, std::pair{1.0, 0.0}, std::pair{0.6, 0.8}}) {
    for (const double part : {0.99, 1.01}) {
      const BondPose<double> pose = placed(gap * part * reach, shift * part * reach);
      const BondAxis<double> axis = bond_axis(law, pose);
      const LawHistory<Law> h = after(law, pose, slipped<Law>(0, 0));
      EXPECT_NEAR(utilisation(law, pose, axis, bond_loads(law, pose, axis, h), h), sq(part), 1e-13);
      EXPECT_EQ(bond_failure(law, pose, axis, bond_loads(law, pose, axis, h), h).utilisation, 0.0);
    }
  }
}

}  // namespace
}  // namespace vbond::rubbing_test
