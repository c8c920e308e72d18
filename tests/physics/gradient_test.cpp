#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "random_law.hpp"
#include "vbond/core/dual.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {
namespace {

using D12 = Dual<12>;  // shift of i, turn of i, shift of j, turn of j

Vec3<D12> variables(std::size_t first) {
  return {D12::variable(0.0, first), D12::variable(0.0, first + 1), D12::variable(0.0, first + 2)};
}
Vec3<D12> constant(const Vec3d& a) {
  return {a.x, a.y, a.z};
}

/// The pose with dual parts: r -> r + dr and n -> n + dphi x n at both ends.
BondPose<D12> perturbed(const BondPose<double>& b) {
  BondPose<D12> p{constant(b.r_ij) + variables(6) - variables(0), {}, {}};
  for (int k = 0; k < 3; ++k) {
    p.n_i[k] = constant(b.n_i[k]) + cross(variables(3), constant(b.n_i[k]));
    p.n_j[k] = constant(b.n_j[k]) + cross(variables(9), constant(b.n_j[k]));
  }
  return p;
}

Vec3d slope(const D12& U, std::size_t first) {
  return {U.d[first], U.d[first + 1], U.d[first + 2]};
}

/// Largest difference between these loads and minus the gradient of the law's energy, over the size of the
/// loads.
template <class Law>
double gradient_error(const Law& law, const BondPose<double>& pose, const BondLoads<double>& l) {
  const BondEnergy<D12> e = bond_energy(with_scalar<D12>(law), perturbed(pose));
  const D12 U = e.U_L + e.U_B + e.U_T;
  const double wrong = std::max({norm(l.F + slope(U, 0)), norm(l.M_ij + slope(U, 3)),
                                 norm(-l.F + slope(U, 6)), norm(l.M_ji + slope(U, 9))});
  return wrong / (norm(l.F) + norm(l.M_ij) + norm(l.M_ji));
}

template <class Law>
class LawsOfBonds : public ::testing::Test {};
TYPED_TEST_SUITE(LawsOfBonds, testing::Laws);

// Both sides are exact derivatives; what is left is rounding, about 100 operations of 1e-16 each,
// magnified by at most 1/|D| <= 20.
TYPED_TEST(LawsOfBonds, HaveLoadsThatAreMinusTheGradientOfTheEnergy) {
  testing::PoseSource random(2012);
  for (int trial = 0; trial < 1000; ++trial) {
    const TypeParam law = testing::random_law<TypeParam>(random);
    // Bonded points that nearly meet are drawn again: 1/|D| magnifies rounding beyond the bound.
    BondPose<double> pose;
    do pose = random.pair(law.a + law.R_i + law.R_j, 0.1, 3.1).pose();
    while (norm(bonded_points(pose, law.R_i, law.R_j)) < 0.05);
    EXPECT_LT(gradient_error(law, pose, bond_loads(law, pose)), 1e-11) << "trial " << trial;
  }
}

// The measure itself: loads of coefficients that are off by 1e-9 do not pass.
TEST(GradientError, NoticesLoadsThatAreSlightlyWrong) {
  testing::PoseSource random(7);
  const VModel<double> law{1.0, 0.3, 0.4, 1.0, 0.1, 0.5, 0.2};
  const BondPose<double> pose = random.pair(1.7, 0.1, 1.0).pose();
  for (double VModel<double>::*B :
       {&VModel<double>::B1, &VModel<double>::B2, &VModel<double>::B3, &VModel<double>::B4}) {
    VModel<double> wrong = law;
    wrong.*B *= 1.0 + 1e-9;
    EXPECT_GT(gradient_error(law, pose, bond_loads(wrong, pose)), 1e-11);
  }
}

}  // namespace
}  // namespace vbond
