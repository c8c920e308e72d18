// The tangent of bonds that flow, against differences of their loads after the flow of an increment.
#include "vbond/physics/flow_tangent.hpp"
#include "vbond/physics/laws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "hardening_law.hpp"
#include "random_pose.hpp"

namespace vbond::flow_tangent_test {
namespace {

using Numbers = std::array<double, 9>;

Numbers numbers(const BondLoads<double>& l) {
  return {l.F.x, l.F.y, l.F.z, l.M_ij.x, l.M_ij.y, l.M_ij.z, l.M_ji.x, l.M_ji.y, l.M_ji.z};
}

BondPose<double> moved(testing::RandomPair p, int variable, double x) {
  Vec3d step[3];
  component(step[variable / 3], variable % 3) = x;
  p.r_j += step[0];
  p.q_i = rotation_of(step[1]) * p.q_i;
  p.q_j = rotation_of(step[2]) * p.q_j;
  return p.pose();
}

template <class Law>
LawHistory<Law> after(const Law& law, const BondPose<double>& pose, const LawHistory<Law>& before) {
  return advance(law, pose, bond_axis(law, pose), BondRates<double>{}, 0.0, before);
}
template <class Law>
Numbers loads_after(const Law& law, const BondPose<double>& pose, const LawHistory<Law>& before) {
  return numbers(bond_loads(law, pose, bond_axis(law, pose), after(law, pose, before)));
}

/// Yields in all ways at these parts of the loads that deformations of 0.2 make, with hardening or not.
BondRules yielding(double part, double hardening) {
  BondRules rules;
  rules.yield.limit = {0.2 * part, 0.12 * part, 0.11 * part, 0.04 * part};
  rules.yield.compression = 0.3 * part;
  rules.yield.isotropic = {hardening, hardening, hardening, hardening};
  rules.yield.kinematic = {hardening, 0.0, hardening, hardening};
  return rules;
}
BondRules softening() {
  BondRules rules;
  rules.softening = {0.02, 0.3};
  return rules;
}

// truncation is h^2 times third derivatives, of order 1 to 1000 where a bond softens; loads at their limits
// are known to 1e-13, which differences take to 1e-8
constexpr double h = 1e-5, tolerance = 2e-6;

template <class Law>
struct Compared {
  double error = 0;
  int flowed = 0, soft = 0;
};

/// Increments from a memory that has flowed once before, from and to random poses. In increments of 0.3 rad
/// and more the corrections of the flow sometimes end before loads are at their limits; then this is no
/// derivative.
template <class Law>
Compared<Law> compare(const BondRules& rules) {
  testing::PoseSource source(11);
  Law law = Law::from({1.0, 0.6, 0.55, 0.2}, 1.0, 0.3, 0.2);
  if constexpr (requires { law.per_s2; }) law.per_s2 = 5.0;
  if constexpr (OffsetLaw<Law>) law.o_i2 = 0.1, law.o_i3 = -0.2, law.o_j2 = 0.15, law.o_j3 = 0.05;
  law.rules = &rules;
  Compared<Law> c;
  for (int trial = 0; trial < 60; ++trial) {
    const LawHistory<Law> before = after(law, source.pair(1.5, 0.06, 0.1).pose(), LawHistory<Law>{});
    const testing::RandomPair pair = source.pair(1.5, 0.06, 0.1);
    const LawHistory<Law> now = after(law, pair.pose(), before);
    const PairTangent<9> t = flow_tangent(law, pair.pose(), before);
    const Numbers loads = loads_after(law, pair.pose(), before), same = numbers(t.loads);
    for (std::size_t row = 0; row < 9; ++row) EXPECT_NEAR(same[row], loads[row], 1e-12);
    for (std::size_t k = 0; k < ways_to_flow; ++k)
      c.flowed += now.value[memory::axial + k] > before.value[memory::axial + k];
    c.soft += now.value[memory::damage] > before.value[memory::damage];
    for (int k = 0; k < 9; ++k) {
      const Numbers less = loads_after(law, moved(pair, k, -h), before),
                    more = loads_after(law, moved(pair, k, h), before);
      for (std::size_t row = 0; row < 9; ++row)
        c.error = std::max(
            c.error, std::abs(t.d[row][static_cast<std::size_t>(k)] - (more[row] - less[row]) / (2.0 * h)));
    }
  }
  return c;
}

template <class Law>
class FlowTangent : public ::testing::Test {};
using FlowingLaws = ::testing::Types<
    WithFlow<VModel>::Law<double>, WithFlow<Evm>::Law<double>, WithFlow<testing::Hardening>::Law<double>,
    WithOffsets<WithFlow<VModel>::Law>::Law<double>, WithOffsets<WithFlow<Evm>::Law>::Law<double>>;
TYPED_TEST_SUITE(FlowTangent, FlowingLaws);

TYPED_TEST(FlowTangent, IsTheDerivativeOfTheLoadsAfterYieldingInAllWays) {
  for (const double part : {0.15, 0.25})
    for (const double hardening : {0.0, 0.05}) {
      const auto c = compare<TypeParam>(yielding(part, hardening));
      EXPECT_LT(c.error, tolerance) << part << ", " << hardening;
      EXPECT_GT(c.flowed, 50) << part << ", " << hardening;
    }
}

TYPED_TEST(FlowTangent, IsTheDerivativeOfTheLoadsAfterSoftening) {
  const auto c = compare<TypeParam>(softening());
  EXPECT_LT(c.error, tolerance);
  EXPECT_GT(c.soft, 10);
}

TYPED_TEST(FlowTangent, OfABondThatDoesNotFlowIsThatOfTheLawWithRules) {
  testing::PoseSource source(3);
  const BondRules rules = yielding(100.0, 0.0);
  TypeParam law = TypeParam::from({1.0, 0.6, 0.55, 0.2}, 1.0, 0.3, 0.2);
  law.rules = &rules;
  using Elastic = typename TypeParam::Inner;
  Elastic elastic = Elastic::from({1.0, 0.6, 0.55, 0.2}, 1.0, 0.3, 0.2);
  for (int trial = 0; trial < 20; ++trial) {
    const BondPose<double> pose = source.pair(1.0, 0.2, 0.5).pose();
    const PairTangent<9> flowing = flow_tangent(law, pose, {}), other = bond_tangent(elastic, pose);
    for (std::size_t row = 0; row < 9; ++row)
      for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(flowing.d[row][k], other.d[row][k], 1e-14);
  }
}

}  // namespace
}  // namespace vbond::flow_tangent_test
