#include <gtest/gtest.h>

#include <cmath>

#include "random_pose.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {
namespace {

template <class Law>
class BondLaws : public ::testing::Test {
 protected:
  Law random_law() {
    return {random.uniform(0.2, 1.5), random.uniform(0.0, 0.6),  random.uniform(0.0, 0.6),
            random.uniform(0.5, 2.0), random.uniform(-0.2, 0.5), random.uniform(0.5, 1.0),
            random.uniform(0.1, 1.0)};
  }
  BondPose<double> random_pose(const Law& law) {
    return random.pair(law.a + law.R_i + law.R_j, 0.1 * law.a, 1.0).pose();
  }
  testing::PoseSource random{1966};
};
using Laws = ::testing::Types<VModel<double>, Evm<double>>;
TYPED_TEST_SUITE(BondLaws, Laws);

template <class T>
double total(const BondEnergy<T>& e) {
  return e.U_L + e.U_B + e.U_T;
}
double size(const BondLoads<double>& l) {
  return norm(l.F) + norm(l.M_ij) + norm(l.M_ji);
}

constexpr int trials = 300;
constexpr double rounding = 1e-13;  // some hundred operations of 1e-16 on terms of order one

TYPED_TEST(BondLaws, MomentsBalance) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    const BondPose<double> pose = this->random_pose(law);
    const BondLoads<double> l = bond_loads(law, pose);
    EXPECT_LT(norm(l.M_ij + l.M_ji - cross(pose.r_ij, l.F)), rounding * (1 + size(l)));
  }
}

TYPED_TEST(BondLaws, AreObjective) {
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

TYPED_TEST(BondLaws, DoNotDependOnWhichEndIsCalledI) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    const BondPose<double> pose = this->random_pose(law);
    TypeParam swapped = law;
    std::swap(swapped.R_i, swapped.R_j);
    BondPose<double> other{-pose.r_ij, {}, {}};
    for (int k = 0; k < 3; ++k) other.n_i[k] = pose.n_j[k], other.n_j[k] = pose.n_i[k];
    const BondLoads<double> l = bond_loads(law, pose), m = bond_loads(swapped, other);
    EXPECT_NEAR(total(bond_energy(law, pose)), total(bond_energy(swapped, other)), rounding);
    EXPECT_LT(norm(l.F + m.F), rounding * (1 + size(l)));
    EXPECT_LT(norm(l.M_ij - m.M_ji), rounding * (1 + size(l)));
    EXPECT_LT(norm(l.M_ji - m.M_ij), rounding * (1 + size(l)));
  }
}

TYPED_TEST(BondLaws, AreWithoutEnergyAndLoadsAtRest) {
  for (int t = 0; t < trials; ++t) {
    const TypeParam law = this->random_law();
    const BondPose<double> rest = this->random.pair(law.a + law.R_i + law.R_j, 0.0, 0.0).pose();
    EXPECT_NEAR(total(bond_energy(law, rest)), 0.0, rounding);
    EXPECT_LT(size(bond_loads(law, rest)), rounding);
  }
}

}  // namespace
}  // namespace vbond
