#include "vbond/statics/detail/bond_lanes.hpp"

#include <gtest/gtest.h>

#include "bodies.hpp"
#include "vbond/statics/detail/assembly.hpp"
#include "vbond/statics/detail/in_lanes.hpp"

namespace vbond::bond_lanes_test {
namespace {

constexpr double length = 0.7;

/// Pairs of particles turned anyhow, each with a bond of this law.
State pairs(const BondLaw& law, std::size_t number) {
  testing::Dice dice(3);
  const auto any = [&dice](double size) {
    return Vec3d{dice(-size, size), dice(-size, size), dice(-size, size)};
  };
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < 2 * number; ++k)
    r.push_back(Vec3d{3.0 * static_cast<double>(k), 0.0, 0.0} + any(0.5));
  testing::Specimen s = testing::particles_at(r, 0.7);
  for (std::size_t k = 0; k < number; ++k) {
    BondRecipe recipe = testing::papers_bond(&law);
    recipe.parameters = BondStiffness<double>{1.0 + dice(0.0, 1.0), 0.5, 0.2, 0.1};
    recipe.attachment = Attachment::given, recipe.R_i = dice(0.0, 0.4), recipe.R_j = dice(0.0, 0.4);
    testing::bond(s, 2 * k, 2 * k + 1, recipe);
  }
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] += any(0.1);
    s.state.q[p] = normalised(rotation_of(any(0.4)) * s.state.q[p]);
  }
  return s.state;
}

class Lanes : public ::testing::TestWithParam<const BondLaw*> {};

// Not nearly: with every instruction set, and whichever bonds go together, results are the same.
TEST_P(Lanes, RoundAsBondsByThemselves) {
  const State s = pairs(*GetParam(), bonds_together);
  for (int number = 0; bond_lane_kernel(number) != nullptr; ++number) {
    WaitingBonds waiting;
    for (const BondId k : s.bonds.ids()) waiting.add(s, k);
    BondLanes& lanes = waiting.filled(s);
    const BondLaneLoops* loops =
        lane_loops(*bond_lane_kernel(number), *s.bonds[BondId{0}].law, *s.bonds[BondId{0}].rules);
    ASSERT_NE(loops, nullptr);
    loops->energy(lanes), loops->loads(lanes), loops->tangent(lanes, length);
    for (const BondId k : s.bonds.ids()) {
      const Bond& b = s.bonds[k];
      const std::size_t l = k.value;
      const auto vec = [l](const BondLanes::Lane(&x)[3]) { return Vec3d{x[0][l], x[1][l], x[2][l]}; };
      const BondEnergy<double> U = bond_energy(s, k);
      EXPECT_EQ(vec(lanes.U), (Vec3d{U.U_L, U.U_B, U.U_T}));
      const BondLoads<double> f = bond_loads(s, k);
      EXPECT_EQ(vec(lanes.F), f.F);
      EXPECT_EQ(vec(lanes.M_ij), f.M_ij);
      EXPECT_EQ(vec(lanes.M_ji), f.M_ji);
      const Assembly::Block K = block_of(b.law->tangent(b, bond_pose(b, s), no_history), length);
      for (int c = 0; c < 12; ++c)
        for (int r = 0; r < 12; ++r)
          EXPECT_EQ(lanes.block[c][r][l], 0.5 * (K(r, c) + K(c, r))) << number << ": " << r << ", " << c;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, Lanes,
                         ::testing::Values(&bond_law<VModel>, &bond_law<Evm>, bond_law<VModel>.with_rules,
                                           bond_law<Evm>.with_rules));

TEST(BondLanes, AreOfElasticLawsAndThoseWithRulesForAnythingButStretching) {
  const BondLaneKernel& kernel = bond_lane_kernel();
  BondRules stretches;
  stretches.stretch.form = StretchForm::morse;
  const BondLaw& ruled = *bond_law<VModel>.with_rules;
  EXPECT_EQ(lane_loops(kernel, bond_law<VModel>, no_rules), lane_loops(kernel, ruled, no_rules));
  EXPECT_NE(lane_loops(kernel, bond_law<VModel>, no_rules), lane_loops(kernel, bond_law<Evm>, no_rules));
  EXPECT_EQ(lane_loops(kernel, ruled, stretches), nullptr);
  EXPECT_EQ(lane_loops(kernel, *bond_law<VModel>.with_flow, no_rules), nullptr);
  EXPECT_EQ(lane_loops(kernel, *with_offsets(ruled), no_rules), nullptr);
}

// Some of another law among them, and no multiple of what goes together.
TEST(BondLanes, TakeAllBondsThatHoldInTheirOrder) {
  State s = pairs(bond_law<VModel>, 21);
  s.bonds[BondId{4}].broken = s.bonds[BondId{20}].broken = true;
  for (const std::size_t k : {7U, 8U}) s.bonds[BondId{k}].law = bond_law<VModel>.with_flow;
  std::vector<BondId> seen, alone;
  for_bonds_in_lanes(
      s, s.bonds.ids(), [&](BondId k) { return k.value != 11; },
      [](const BondLaneLoops& loops, BondLanes& lanes) { loops.loads(lanes); },
      [&](BondId k, const BondLanes& lanes, std::size_t l) {
        seen.push_back(k);
        EXPECT_EQ(lanes.F[0][l], bond_loads(s, k).F.x);
      },
      [&](BondId k) { seen.push_back(k), alone.push_back(k); });
  std::vector<BondId> holding;
  for (const BondId k : s.bonds.ids())
    if (!s.bonds[k].broken) holding.push_back(k);
  EXPECT_EQ(seen, holding);
  EXPECT_EQ(alone, (std::vector<BondId>{BondId{7}, BondId{8}, BondId{11}}));
}

}  // namespace
}  // namespace vbond::bond_lanes_test
