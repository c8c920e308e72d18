// Validation cases K2, K3 and the heavy column of E7: critical loads on the nonlinear path.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "critical_loads.hpp"
#include "periodic.hpp"
#include "validation/cases.hpp"

namespace vbond::buckling_test {
namespace {

using testing::fixed;
using testing::pushed;
using testing::validation_case;

constexpr HeldDofs guided{false, true, true, true, true, true};

struct End {
  const char* name;
  HeldDofs held;
  double kappa_L;  ///< wave number of the mode
};
constexpr End ends[] = {{"clamped-clamped", guided, 2 * M_PI},
                        {"cantilever", {}, M_PI / 2},
                        {"fixed-pinned", {false, true, true, false, false, false}, 4.493}};

StaticResult buckled_column(std::size_t N, const End& end, int count) {
  return critical_loads(testing::rod50(N),
                        {fixed({ParticleId{0}}, testing::clamped), fixed({ParticleId{N}}, end.held)},
                        {pushed(N, {-1, 0, 0})}, count);
}

/// Of numbers in validation.json that were computed in doubles: of the cantilever of 80 bonds it is off the
/// closed form by 3.8e-9; ours by as much as standard_tolerance() says, 1.8e-8.
constexpr double table = 1e-8;

// K2.
TEST(Columns, BuckleAtTheirExactDiscreteForce) {
  for (const End& end : ends)
    for (const std::size_t N : {10u, 20u, 40u, 80u}) {
      const double P = validation_case("K2")
                           .at("expected")
                           .at(std::string("buckling_") + end.name + " (EI=L=1,EA=4e4)")
                           .at("discrete")
                           .at(std::to_string(N));
      const StaticResult result = buckled_column(N, end, 2);
      ASSERT_EQ(result.critical_loads.size(), 2u);
      for (const CriticalLoad& c : result.critical_loads)
        EXPECT_NEAR(c.force / P, 1.0, table) << end.name << ", N = " << N;
    }
}

// The cantilever is half a pinned rod, the clamped column two of them, cut where they do not turn.
TEST(Columns, BuckleAtTheForceOfThePinnedRodTheyArePartOf) {
  for (const double N : {10.0, 20.0, 40.0})
    for (const End& end : {ends[0], ends[1]}) {
      const double bonds = N * M_PI / end.kappa_L;
      const double P = exact_force(1, bonds, 1 / N, {4e4 * N, 12 * N * N * N, N, N / 1.2});
      const StaticResult result = buckled_column(static_cast<std::size_t>(N), end, 1);
      EXPECT_NEAR(result.critical_loads.at(0).force / P, 1.0, standard_tolerance(P, end.kappa_L, N))
          << end.name << ", N = " << N;
    }
}

// E7: half weight on the last particle.
TEST(Columns, BuckleUnderTheirOwnWeightAtTheExactDiscreteValue) {
  for (const std::size_t N : {10u, 20u, 40u, 80u}) {
    const double q = validation_case("E7").at("expected").at("col").at("discrete").at(std::to_string(N));
    testing::Specimen column = testing::rod50(N);
    column.model.mass[ParticleId{N}] /= 2;
    StaticStage stage =
        testing::static_stage(StageKind::buckling, {fixed({ParticleId{0}}, testing::clamped)});
    stage.gravity = {-1, 0, 0};
    stage.count = 1;
    const StaticResult result = run_static_stage(column.model, stage, column.state, {}).result;
    ASSERT_EQ(result.critical_loads.size(), 1u);
    EXPECT_NEAR(result.critical_loads[0].load_factor / q, 1.0, table) << "N = " << N;
    EXPECT_EQ(result.critical_loads[0].force, 0.0);
  }
}

// K3: both ends clamped, one free to slide along x, turned about it in proportion to the load factor.
TEST(Columns, LeaveTheirLineUnderTheExactDiscreteTwist) {
  for (const std::size_t N : {40u, 80u, 160u}) {
    const double twist =
        validation_case("K3").at("expected").at("discrete").at(std::to_string(N)).at("twist");
    const StaticResult result = critical_loads(
        testing::rod50(N),
        {fixed({ParticleId{0}}, testing::clamped), fixed({ParticleId{N}}, guided, {}, {1, 0, 0})}, {}, 1);
    ASSERT_EQ(result.critical_loads.size(), 1u);
    EXPECT_NEAR(result.critical_loads[0].load_factor / twist, 1.0, table) << "N = " << N;
  }
}

// At 20 bonds the torque has its peak at 45 degrees a bond, before that: 19 turns lose their stiffness at
// once. That is the end of the law, and no critical load of a rod.
TEST(Columns, EndInTwistAt45DegreesABond) {
  const std::size_t N = 20;
  const StaticResult result = critical_loads(
      testing::rod50(N),
      {fixed({ParticleId{0}}, testing::clamped), fixed({ParticleId{N}}, guided, {}, {1, 0, 0})}, {}, 1);
  EXPECT_EQ(result.ended, "bond range");
  EXPECT_TRUE(result.critical_loads.empty());
  EXPECT_NEAR(result.searched_to / (20 * M_PI / 4), 1.0, 1e-6);  // as near as counts as the end
}

// A chain that repeats without end is stretched along itself: none of its waves becomes unstable, and the
// search ends where bonds have twice their length, the end of what it takes for any law.
TEST(Columns, WithoutEndLookForWavesUpToTheEndOfTheirLaw) {
  testing::Specimen chain =
      testing::periodic_body({Vec3d{2, 0, 0}, Vec3d{0, 5, 0}, Vec3d{0, 0, 5}}, {{0, 0, 0}, {1, 0, 0}});
  chain.model.cell.periodic = {true, false, false};
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  testing::bond_image(chain, 0, 1, {0, 0, 0}, recipe);
  testing::bond_image(chain, 1, 0, {1, 0, 0}, recipe);
  StaticStage stage = testing::cell_stage({testing::strained(4.0)});
  stage.kind = StageKind::buckling;
  stage.count = 1;
  stage.waves = {{{0.3, 0, 0}, {0.5, 0, 0}}, true};
  const StaticResult result = run_static_stage(chain.model, stage, chain.state, {}).result;
  EXPECT_EQ(result.ended, "bond range");
  EXPECT_TRUE(result.critical_loads.empty());
  EXPECT_GE(result.searched_to, 0.25 - 1e-9);  // where 1 + 4 f is 2
  EXPECT_LT(result.searched_to, 0.5);
}

}  // namespace
}  // namespace vbond::buckling_test
