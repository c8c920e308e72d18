// Flat joints at rest: cells crack one by one, and then push and rub.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bodies.hpp"
#include "campaigns/judge.hpp"
#include "dynamics/joints.hpp"
#include "vbond/model/bond_sums.hpp"
#include "walks.hpp"

namespace vbond::flat_joint_at_rest_test {
namespace {

using testing::Specimen;

using testing::crack_all;
using testing::cracked;
using testing::force_on_first;
using testing::join;
using testing::moment_on_second;
using testing::recipe_of;
using testing::Rock;

const Rock rock;
const double k_n = rock.k_n, radius = rock.radius, mu = rock.friction, A = M_PI * sq(radius);

Rock in_cells(const FlatJoint& joint) {
  Rock r;
  r.joint = joint;
  return r;
}
Specimen two_grains(const FlatJoint& joint, bool rubs = true) {
  return testing::two_grains(in_cells(joint), rubs);
}
Support grain(std::size_t p, HeldDofs held, const Vec3d& displacement = {}, const Vec3d& rotation = {}) {
  return testing::fixed({ParticleId{p}}, held, displacement, rotation);
}

// Held grains turned against each other: the cell at y < 0 cracks where 2 |y| sin(theta/2) k_n is the tensile
// strength, the next after it. Two cells lie at each y. Rubbing or not, as all stand open.
TEST(FlatJointAtRest, CellsCrackOneByOneInBending) {
  const FlatJoint joint{2, 6};
  const double theta = 0.02;
  std::vector<double> expected;
  for (const JointCell& c : joint_cells(joint))
    if (c.y < -1e-9) expected.push_back(2.0 * std::asin(rock.tension / k_n / (2.0 * radius * -c.y)) / theta);
  std::sort(expected.begin(), expected.end());
  for (const bool rubs : {true, false}) {
    const Specimen s = two_grains(joint, rubs);
    const StaticStage stage =
        testing::static_stage(StageKind::fracture, {grain(0, testing::clamped, {}, {0, 0, -0.5 * theta}),
                                                    grain(1, testing::clamped, {}, {0, 0, 0.5 * theta})});
    const testing::Walked w = testing::walk(s, stage);
    const FractureResult& f = w.result.fracture;
    ASSERT_EQ(f.breaks.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_NEAR(f.breaks[k].use.load_factor, expected[k], 1e-9);
    EXPECT_EQ(cracked(w.last()), rubs ? 4u : 0u);
    EXPECT_LT(std::abs(f.books.error()), 1e-9);
    double N = 0.0;
    for (const JointCell& c : joint_cells(joint))
      if (c.y > -1e-9) N += A * c.area * k_n * -2.0 * radius * c.y * std::sin(0.5 * theta);
    EXPECT_NEAR(force_on_first(w.last()).x, N, 1e-12);
  }
}

// The second grain is free along x, under a constant force -P, and is drawn along y: all cells crack at
// (c + sigma tan phi) A, and what is left is mu P to the tolerance of balance.
TEST(FlatJointAtRest, ShearUnderAConstantForceEndsInFriction) {
  const Specimen s = two_grains({2, 5});
  const double P = 1e-3 * k_n * A;
  StaticStage stage = testing::static_stage(
      StageKind::fracture,
      {grain(0, testing::clamped), grain(1, {false, true, true, true, true, true}, {0, 0.02, 0})},
      {testing::pushed(1, {-P, 0, 0})});
  stage.loads[0].constant = true;
  stage.steps = 20;
  const testing::Walked w = testing::walk(s, stage);
  const FractureResult& f = w.result.fracture;
  EXPECT_EQ(w.result.ended, "load factor") << f.reason;
  EXPECT_EQ(cracked(w.last()), 10u);
  EXPECT_NEAR(f.peak_load / ((rock.cohesion + P / A * rock.tan_phi) * A), 1.0,
              1e-2);  // laws differ by the strain
  EXPECT_NEAR(force_on_first(w.last()).x / -P, 1.0, 1e-8);
  EXPECT_NEAR(std::abs(force_on_first(w.last()).y) / (mu * P), 1.0, 1e-8);
  EXPECT_GT(f.books.dissipated, 0.5 * mu * P * 0.015);
  EXPECT_LT(std::abs(f.books.error()), 1e-6);
}

// A cracked joint under a constant force, turned: what balances P, and the moment, from the sum over cells
// that are shut, solved by bisection. As it is turned on, the moment tends to P times the arm of the
// outermost cells.
TEST(FlatJointAtRest, ACrackedJointUnderAConstantForceHasItsMomentAndRotation) {
  const FlatJoint joint{3, 8};
  Specimen s = two_grains(joint);
  const double P = 1e-3 * k_n * A;
  crack_all(s);
  double most = 0.0, arm = 0.0;
  for (const JointCell& c : joint_cells(joint)) arm = std::max(arm, radius * c.y);
  for (const double theta : {0.0005, 0.002, 0.05}) {
    StaticStage stage =
        testing::static_stage(StageKind::equilibrium,
                              {grain(0, testing::clamped, {}, {0, 0, -0.5 * theta}),
                               grain(1, {false, true, true, true, true, true}, {}, {0, 0, 0.5 * theta})},
                              {testing::pushed(1, {-P, 0, 0})});
    stage.loads[0].constant = true;
    stage.steps = 10;
    Specimen pressed = s;
    pressed.state.r[ParticleId{1}].x -= 1e-3;
    const testing::Walked w = testing::walk(pressed, stage);
    const auto sum = [&](double u, bool moments) {
      double all = 0.0;
      for (const JointCell& c : joint_cells(joint)) {
        const double y = radius * c.y,
                     force = A * c.area * k_n * std::min(u - 2.0 * y * std::sin(0.5 * theta), 0.0);
        all += moments ? force * y * std::cos(0.5 * theta) : force;
      }
      return all;
    };
    double low = -1.0, high = 1.0;
    for (int k = 0; k < 200; ++k) (sum(0.5 * (low + high), false) > -P ? high : low) = 0.5 * (low + high);
    EXPECT_NEAR(w.last().r[ParticleId{1}].x - 2.0, low, 1e-10);
    EXPECT_NEAR(moment_on_second(w.last()).z, sum(low, true), 1e-9 * P);
    EXPECT_LE(std::abs(moment_on_second(w.last()).z), P * arm);
    most = std::abs(moment_on_second(w.last()).z);
  }
  EXPECT_GT(most, 0.9 * P * arm);
}

// A wall of three grains side by side on a row of three, joined, pressed by weights and pushed by the middle
// one: books close, nothing is given up.
TEST(FlatJointAtRest, AFrameOfJointsCracksUnderALoadThatIsPushedOn) {
  std::vector<Vec3d> r;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) r.push_back({2.0 * x, 2.0 * y, 0});
  Specimen s = testing::particles_at(r, 1.0, 0.4);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm(r[j] - r[i]) < 2.1) join(s, i, j, recipe_of(in_cells({1, 4})));
  StaticStage stage = testing::static_stage(
      StageKind::fracture, {grain(0, testing::clamped), grain(3, testing::clamped),
                            grain(5, {false, true, false, false, false, false}, {0, -0.02, 0}),
                            grain(6, {false, true, false, false, false, false}, {0, -0.02, 0})});
  stage.steps = 20;
  const testing::Walked w = testing::walk(s, stage);
  const FractureResult& f = w.result.fracture;
  EXPECT_GT(f.breaks.size(), 4u);
  EXPECT_LT(std::abs(f.books.error()), 1e-3);
  EXPECT_NE(w.result.ended, "interrupted");
}

// Random joints between held grains, of which one moves along a straight way: as FlatJoint.RandomJoints... of
// dynamics, by load steps.
TEST(FlatJointAtRest, RandomJointsRestAsPlainCodeSays) {
  const testing::Tally all =
      testing::campaign("flat joints at rest", 40, [](unsigned seed, testing::Tally& tally) {
        testing::Dice dice(seed);
        const Rock random = testing::random_rock(dice);
        const auto [to, turn] = testing::random_way(dice);
        StaticStage stage = testing::static_stage(
            StageKind::fracture, {grain(0, testing::clamped), grain(1, testing::clamped, to, turn)});
        constexpr int steps = 400;
        stage.steps = steps;
        testing::PlainJoint plain(random);
        for (int n = 1; n <= steps; ++n) {
          const double part = static_cast<double>(n) / steps;
          plain.go_to(part * to, part * turn);
        }
        const testing::Walked w = testing::walk(testing::two_grains(random), stage);
        ASSERT_EQ(w.result.ended, "load factor");
        std::size_t expected = 0;
        for (const bool is : plain.cracked()) expected += is;
        if (cracked(w.last()) != expected) {
          tally.add("near its strength");
          return;
        }
        tally.add("cracked cells", static_cast<double>(expected));
        const double scale = random.k_n * testing::small_strain * M_PI * sq(random.radius);
        ASSERT_LT(norm(force_on_first(w.last()) - plain.force()), 5e-3 * scale);
        ASSERT_LT(std::abs(w.result.fracture.books.error()), 1e-6);
      });
  EXPECT_GT(all.sum("cracked cells"), all.full ? 3 * all.cases : 0);
  EXPECT_LT(all.sum("near its strength"), all.full ? all.cases / 4 : 1);
}

// Intact joints are elastic: paths and critical loads take them; cracked ones are refused there, by name.
TEST(FlatJointAtRest, PathsTakeIntactJointsAndRefuseCrackedOnes) {
  Specimen s = two_grains({1, 4});
  StaticStage stage = testing::static_stage(StageKind::path, {grain(0, testing::clamped)},
                                            {testing::pushed(1, {-1e-4, 0, 0})});
  stage.path.most_points = 10;
  EXPECT_EQ(testing::refusal(s, stage), "");
  crack_all(s);
  EXPECT_NE(testing::refusal(s, stage).find("cracked"), std::string::npos);
}

// Grains on smooth faces slide freely: a load along them has no balance, and none is told.
TEST(FlatJointAtRest, FacesWithoutFrictionAreRefused) {
  Rock smooth = in_cells({1, 4});
  smooth.friction = 0.0;
  const StaticStage stage = testing::static_stage(StageKind::equilibrium, {grain(0, testing::clamped)},
                                                  {testing::pushed(1, {-1e-4, 1e-5, 0})});
  EXPECT_NE(testing::refusal(testing::two_grains(smooth), stage).find("no friction"), std::string::npos);
  EXPECT_EQ(testing::refusal(testing::two_grains(in_cells({1, 4})), stage), "");
}

}  // namespace
}  // namespace vbond::flat_joint_at_rest_test
