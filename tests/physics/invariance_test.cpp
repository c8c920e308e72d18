#include <gtest/gtest.h>

#include <cmath>

#include "random_law.hpp"
#include "vbond/core/dual.hpp"

namespace vbond {
namespace {

template <class Law>
class InvariantLaws : public ::testing::Test {
 protected:
  Law random_law() { return testing::random_law<Law>(random); }
  BondPose<double> random_pose(const Law& law) {
    return random.pair(law.a + law.R_i + law.R_j, 0.1 * law.a, 1.0).pose();
  }
  testing::PoseSource random{1966};
};
TYPED_TEST_SUITE(InvariantLaws, testing::Laws);

template <class T>
double total(const BondEnergy<T>& e) {
  return e.U_L + e.U_B + e.U_T;
}
double size(const BondLoads<double>& l) {
  return norm(l.F) + norm(l.M_ij) + norm(l.M_ji);
}

constexpr int trials = 300;
constexpr double rounding = 1e-13;  // some hundred operations of 1e-16 on terms of order one

TYPED_TEST(InvariantLaws, MomentsBalance) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    const BondPose<double> pose = this->random_pose(law);
    const BondLoads<double> l = bond_loads(law, pose);
    EXPECT_LT(norm(l.M_ij + l.M_ji - cross(pose.r_ij, l.F)), rounding * (1 + size(l)));
  }
}

TYPED_TEST(InvariantLaws, AreObjective) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    const BondPose<double> pose = this->random_pose(law);
    const Quatd Q = this->random.rotation(3.1);
    BondPose<double> turned{rotate(Q, pose.r_ij), {}, {}};
    for (int k = 0; k < 3; ++k)
      turned.n_i[k] = rotate(Q, pose.n_i[k]), turned.n_j[k] = rotate(Q, pose.n_j[k]);
    const BondLoads<double> l = bond_loads(law, pose), m = bond_loads(law, turned);
    EXPECT_NEAR(total(bond_energy(law, pose)), total(bond_energy(law, turned)), rounding);
    EXPECT_LT(norm(rotate(Q, l.F) - m.F), rounding * (1 + size(l)));
    EXPECT_LT(norm(rotate(Q, l.M_ij) - m.M_ij), rounding * (1 + size(l)));
    EXPECT_LT(norm(rotate(Q, l.M_ji) - m.M_ji), rounding * (1 + size(l)));
  }
}

TYPED_TEST(InvariantLaws, DoNotDependOnWhichEndIsCalledI) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    const BondPose<double> pose = this->random_pose(law);
    TypeParam swapped = law;
    std::swap(swapped.R_i, swapped.R_j);
    if constexpr (OffsetLaw<TypeParam>)
      std::swap(swapped.o_i2, swapped.o_j2), std::swap(swapped.o_i3, swapped.o_j3);
    BondPose<double> other{-pose.r_ij, {}, {}};
    for (int k = 0; k < 3; ++k) other.n_i[k] = pose.n_j[k], other.n_j[k] = pose.n_i[k];
    const BondLoads<double> l = bond_loads(law, pose), m = bond_loads(swapped, other);
    EXPECT_NEAR(total(bond_energy(law, pose)), total(bond_energy(swapped, other)), rounding);
    EXPECT_LT(norm(l.F + m.F), rounding * (1 + size(l)));
    EXPECT_LT(norm(l.M_ij - m.M_ji), rounding * (1 + size(l)));
    EXPECT_LT(norm(l.M_ji - m.M_ij), rounding * (1 + size(l)));
  }
}

TYPED_TEST(InvariantLaws, AreWithoutEnergyAndLoadsAtRest) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    BondPose<double> rest = this->random.pair(law.a + law.R_i + law.R_j, 0.0, 0.0).pose();
    if constexpr (OffsetLaw<TypeParam>) rest.r_ij += law.offset_i(rest) - law.offset_j(rest);
    EXPECT_NEAR(total(bond_energy(law, rest)), 0.0, rounding);
    EXPECT_LT(size(bond_loads(law, rest)), rounding);
  }
}

// What a law says of itself agrees: coefficients from stiffnesses give these back, the derivative of the
// energy of stretching is the tension, and about rest it grows with c_A.
TYPED_TEST(InvariantLaws, GiveTheStiffnessesTheyWereMadeFrom) {
  for (int t = 0; t < trials; ++t) {
    const BondStiffness<double> c{this->random.uniform(0.5, 2.0), this->random.uniform(0.2, 2.0),
                                  this->random.uniform(0.1, 1.0), this->random.uniform(0.1, 1.0)};
    const double a = this->random.uniform(0.2, 1.5);
    const BondStiffness<double> back = stiffness(TypeParam::from(c, a, 0.1, 0.2));
    EXPECT_NEAR(back.c_A, c.c_A, rounding);
    EXPECT_NEAR(back.c_D, c.c_D, rounding);
    EXPECT_NEAR(back.c_B, c.c_B, rounding);
    EXPECT_NEAR(back.c_T, c.c_T, rounding);
  }
}

TYPED_TEST(InvariantLaws, HaveTheTensionOfTheirStretching) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    const BondStiffness<double> c = stiffness(law);
    const double D = law.a * this->random.uniform(0.5, 1.5);
    const Dual<1> U = stretch_energy(with_scalar<Dual<1>>(law), Dual<1>::variable(D, 0));
    EXPECT_NEAR(tension(law, D), U.d[0], rounding);
    const Dual<1> N = tension(with_scalar<Dual<1>>(law), Dual<1>::variable(law.a, 0));
    EXPECT_NEAR(N.value, 0.0, rounding);
    EXPECT_NEAR(N.d[0], c.c_A, rounding);
    const BondPose<double> pose = this->random_pose(law);
    const BondAxis<double> axis = bond_axis(law, pose);
    const BondLoads<double> l = bond_loads(law, pose);
    EXPECT_NEAR(dot(l.F, axis.d), tension(law, axis.D), rounding * (1 + size(l)) / axis.D);
  }
}

}  // namespace
}  // namespace vbond
