// Flat joints in motion: cells that break one by one, and then push and rub.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "campaigns/judge.hpp"
#include "joints.hpp"
#include "spheres_and_walls.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/model/touching.hpp"

namespace vbond::flat_joint_test {
namespace {

using testing::Dice;
using testing::Specimen;

using testing::cracked;
using testing::force_on_first;
using testing::join;
using testing::moment_on_second;
using testing::PlainJoint;
using testing::recipe_of;
using testing::Rock;
using testing::two_grains;

std::size_t gone(const State& s) {
  return static_cast<std::size_t>(
      std::count_if(s.bonds.begin(), s.bonds.end(), [](const Bond& b) { return b.broken; }));
}

Support driven(std::size_t p, const Vec3d& velocity, const Vec3d& angular_velocity = {}) {
  Support s = testing::held({ParticleId{p}}, testing::clamped, velocity);
  s.angular_velocity = angular_velocity;
  return s;
}

// Both grains turned against each other by theta/2: the cell at y < 0 is pulled by 2 |y| sin(theta/2),
// whatever theta, and cracks in the step in which k_n times that reaches the tensile strength. Nothing else
// breaks; what has cracked stands open and carries nothing.
TEST(FlatJoint, CellsCrackOneByOneInBendingAtTheStressOfTheirMiddle) {
  const Rock rock;
  const Specimen s = two_grains(rock);
  const double dt = 0.01, rate = 1e-4;
  Stage stage = testing::plain_stage(dt, 1e9);
  stage.supports = {driven(0, {}, {0, 0, -0.5 * rate}), driven(1, {}, {0, 0, 0.5 * rate})};
  Simulation run(s.model, stage, s.state);
  const std::vector<JointCell> cells = joint_cells(rock.joint);
  std::vector<double> angle(cells.size(), INFINITY);
  const auto theta_of = [&](const JointCell& c) {
    return 2.0 * std::asin(rock.tension / rock.k_n / (2.0 * rock.radius * std::abs(c.y)));
  };
  double last = 0.0;
  for (const JointCell& c : cells)
    if (c.y < 0.0) last = std::max(last, theta_of(c));
  ASSERT_LT(last, 1.0);
  double theta = 0.0;
  while (theta < 1.1 * last) {
    run.step();
    theta += rate * dt;
    for (const BondEvent& e : run.events()) {
      EXPECT_EQ(e.cause.mode, BreakMode::tension);
      EXPECT_NEAR(e.cause.limit, rock.tension, 1e-15);
      angle[e.bond.value] = std::min(angle[e.bond.value], theta);
    }
  }
  std::size_t pulled = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k].y > -1e-9) {
      EXPECT_TRUE(std::isinf(angle[k]));
      continue;
    }
    ++pulled;
    EXPECT_GE(angle[k], theta_of(cells[k]) - 1e-9);
    EXPECT_LE(angle[k], theta_of(cells[k]) + rate * dt + 1e-9);
  }
  EXPECT_EQ(pulled, 4u);  // of six around two lie on the axis
  EXPECT_EQ(cracked(run.state()), pulled);
  EXPECT_EQ(run.state().breaks, static_cast<std::int64_t>(pulled));
  for (const BondId k : run.state().bonds.ids())
    if (is_cracked(run.state().bonds[k])) {
      EXPECT_LT(norm(bond_loads(run.state(), k).F), 1e-15);
    }
}

// All cracked and pressed by p, then turned: cells that stay shut carry k_n times how deep they are pressed;
// the moment is the sum of these forces times their arms, and never above N times the radius.
TEST(FlatJoint, ACrackedJointUnderPressureResistsTurningByTheCellsThatAreShut) {
  Rock rock;
  rock.joint = {4, 16};
  Specimen s = two_grains(rock);
  const double p = 1e-3;
  testing::crack_all(s);
  s.state.r[ParticleId{1}].x -= p;
  const double dt = 0.01, rate = 1e-4;
  Stage stage = testing::plain_stage(dt, 1e9);
  stage.supports = {driven(0, {}, {0, 0, -0.5 * rate}), driven(1, {}, {0, 0, 0.5 * rate})};
  Simulation run(s.model, stage, s.state);
  const double A = M_PI * sq(rock.radius);
  bool all_shut = false, some_open = false;
  for (int n = 1; n <= 8000; ++n) {
    run.step();
    if (n % 800 != 0) continue;
    const double half = 0.5 * rate * dt * n, sine = std::sin(half);
    double N = 0.0, M = 0.0;
    std::size_t open = 0;
    for (const JointCell& c : joint_cells(rock.joint)) {
      const double y = rock.radius * c.y, u = -p - 2.0 * y * sine;
      const double force = A * c.area * rock.k_n * std::min(u, 0.0);
      N += force, M += force * y * std::cos(half);
      open += u > 0.0;
    }
    (open == 0 ? all_shut : some_open) = true;
    const State& now = run.state();
    EXPECT_NEAR(force_on_first(now).x, N, 1e-12);
    EXPECT_NEAR(force_on_first(now).y, 0.0, 1e-12);
    EXPECT_NEAR(moment_on_second(now).z, M, 1e-12);
    EXPECT_LE(std::abs(M), std::abs(N) * rock.radius);
    // while all are shut: all but the cells' own moments, 1/(radial around) of the section's, roughly
    if (open == 0) {
      const double J = 0.25 * A * sq(rock.radius);
      EXPECT_NEAR(M, -2.0 * sine * rock.k_n * J, 0.03 * 2.0 * sine * rock.k_n * J);
    }
  }
  EXPECT_TRUE(all_shut);
  EXPECT_TRUE(some_open);
}

// Pressed and sheared between held grains: the peak is (c + sigma tan phi) A, what is left mu sigma A. The
// books close: supports work, cells release, friction dissipates. Forces of the two laws, and of a bond that
// is turned by the shear, differ by the square of the strain, 1e-3.
TEST(FlatJoint, ShearUnderPressureHasThePeakOfMohrCoulombAndTheResidueOfFriction) {
  const Rock rock;
  Specimen s = two_grains(rock);
  const double p = 1e-3, dt = 0.01, speed = 1e-3;
  s.state.r[ParticleId{1}].x -= p;
  Stage stage = testing::plain_stage(dt, 1e9);
  stage.supports = {driven(0, {}), driven(1, {0, speed, 0})};
  Simulation run(s.model, stage, s.state);
  const double A = M_PI * sq(rock.radius), sigma = rock.k_n * p;
  double peak = 0.0;
  for (int n = 0; n < 2000; ++n) {
    run.step();
    peak = std::max(peak, std::abs(force_on_first(run.state()).y));
  }
  EXPECT_EQ(cracked(run.state()), 12u);
  const double expected = (rock.cohesion + sigma * rock.tan_phi) * A;
  EXPECT_NEAR(peak / expected, 1.0, 1e-2);
  EXPECT_NEAR(std::abs(force_on_first(run.state()).y) / (rock.friction * sigma * A), 1.0, 1e-9);
  EXPECT_NEAR(force_on_first(run.state()).x / (-sigma * A), 1.0, 1e-9);
  EXPECT_GT(run.books().released, 0.0);
  EXPECT_GT(losses_of(run)[Loss::friction], 0.0);
  EXPECT_LT(std::abs(run.balance_error()), 1e-9);
}

std::size_t touching(const Specimen& s, const State& state) {
  std::size_t n = 0;
  for_touching_pairs(s.model, state, [&](ParticleId, ParticleId, const Image&, double) { ++n; });
  return n;
}

// Twist and pressure leave the faces over each other. When they then slide apart all cells part at once,
// though twist has moved each of them another way: at no time do some still rub while spheres pass into each
// other.
TEST(FlatJoint, FacesThatTurnOrAreDeepDoNotPart) {
  Rock rock;
  rock.radius = 0.3, rock.tension = rock.cohesion = 1e-6, rock.tan_phi = 0.0;
  Specimen s = two_grains(rock);
  s.model.contact = testing::linear(1.0, 0.0);
  s.model.contact.pairs = ContactPairs::unbonded;
  s.state.r[ParticleId{1}].x -= 0.35;  // deeper than the radius of the section
  Stage stage = testing::plain_stage(0.01, 1e9);
  stage.supports = {driven(0, {}), driven(1, {}, {0.2, 0, 0})};
  Simulation twisting(s.model, stage, s.state);
  for (int k = 0; k < 1000; ++k) twisting.step();  // to 115 degrees
  EXPECT_EQ(cracked(twisting.state()), 12u);
  EXPECT_EQ(gone(twisting.state()), 0u);
  stage.supports = {driven(0, {}), driven(1, {0, 0.1, 0.02})};
  Simulation sliding(s.model, stage, twisting.state());
  double shift = 0.0;
  while (gone(sliding.state()) == 0 && shift < 0.4) {
    EXPECT_EQ(touching(s, sliding.state()), 0u);
    sliding.step(), shift += 0.01 * std::hypot(0.1, 0.02);
  }
  EXPECT_NEAR(shift, 0.3, 0.003);  // a step is 0.001, and a break is seen at its end
  EXPECT_EQ(gone(sliding.state()), 12u);
  EXPECT_EQ(touching(s, sliding.state()), 1u);
}

// Grains that have slid off each other are no pair any more: faces part when they have moved by the radius of
// the section, and spheres touch again as spheres. Not counted as breaks.
TEST(FlatJoint, FacesThatHaveSlidApartLeaveGrainsThatTouchAsSpheres) {
  Rock rock;
  rock.radius = 0.3;
  Specimen s = two_grains(rock);
  s.model.contact = testing::linear(1.0, 0.0);
  s.model.contact.pairs = ContactPairs::unbonded;
  s.state.r[ParticleId{1}].x -= 0.05;
  Stage stage = testing::plain_stage(0.01, 1e9);
  stage.supports = {driven(0, {}), driven(1, {0, 0.1, 0})};
  Simulation run(s.model, stage, s.state);
  double shift = 0.0;
  while (shift < 0.298) run.step(), shift += 0.1 * 0.01;
  EXPECT_EQ(cracked(run.state()), 12u);
  EXPECT_EQ(gone(run.state()), 0u);
  while (shift < 0.302) run.step(), shift += 0.1 * 0.01;
  EXPECT_EQ(gone(run.state()), 12u);
  EXPECT_EQ(run.state().breaks, 12);
  EXPECT_LT(std::abs(run.balance_error()), 1e-6);
  EXPECT_EQ(touching(s, run.state()), 1u);
}

/// A block of 3 x 3 x 2 grains, joined to their neighbours, thrown about.
Specimen block(const Rock& rock, bool rubs, double speed) {
  std::vector<Vec3d> r;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 2; ++z) r.push_back({2.0 * x, 2.0 * y, 2.0 * z});
  Specimen s = testing::particles_at(r, 1.0, 0.4);
  const BondRecipe recipe = recipe_of(rock, rubs);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm(r[j] - r[i]) < 2.1) join(s, i, j, recipe);
  Dice dice(4);
  for (const ParticleId p : s.state.r.ids())
    s.state.v[p] = dice.vector(speed), s.state.omega[p] = dice.vector(speed);
  return s;
}

// Leap-frog's energy error is of second order in the step. A crack is booked exactly.
TEST(FlatJoint, BooksCloseWhileABlockShakesToPieces) {
  for (const bool rubs : {true, false}) {
    const Specimen s = block({}, rubs, 2e-3);
    const double dt = 0.02 * step_bound(s.model, s.state).dt;
    Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
    for (int n = 0; n < 6000; ++n) run.step();
    EXPECT_GT(run.state().breaks, 30);
    EXPECT_EQ(cracked(run.state()) > 0, rubs);
    EXPECT_LT(std::abs(run.balance_error()), 2e-3);
    EXPECT_EQ(losses_of(run)[Loss::friction] > 0.0, rubs);
  }
}

TEST(FlatJoint, ThreadsDoNotChangeABit) {
  const Specimen s = block({}, true, 3e-3);
  const auto after = [&](int threads) {
    Simulation run(s.model, testing::plain_stage(0.05, 1e9), s.state, threads);
    for (int n = 0; n < 1000; ++n) run.step();
    return run.state();
  };
  const State one = after(1);
  EXPECT_GT(cracked(one), 30u);
  for (const int threads : {2, 3}) {
    const State other = after(threads);
    EXPECT_EQ(one.r, other.r);
    EXPECT_EQ(one.bonds, other.bonds);
    EXPECT_EQ(one.bond_history, other.bond_history);
  }
}

// ---- against plain code
// --------------------------------------------------------------------------------------

// Random joints between held grains, of which one moves along two straight ways, one after the other. Strains
// are 1e-4, which is how much the two differ; so cells that are near to their strength may differ.
TEST(FlatJoint, RandomJointsMoveAsPlainCodeSays) {
  const testing::Tally all = testing::campaign("flat joints", 40, [](unsigned seed, testing::Tally& tally) {
    Dice dice(seed);
    const Rock rock = testing::random_rock(dice);
    const Specimen s = two_grains(rock);
    PlainJoint plain(rock);
    State at = s.state;
    Vec3d u, w;
    constexpr int steps = 400;
    const double dt = 0.01;
    for (int leg = 0; leg < 2; ++leg) {
      const auto [to, turn] = testing::random_way(dice);
      Stage stage = testing::plain_stage(dt, 1e9);
      stage.supports = {driven(0, {}), driven(1, to / (steps * dt), turn / (steps * dt))};
      at.clock.stage_step = 0;
      Simulation run(s.model, stage, at);
      for (int n = 0; n < steps; ++n) {
        run.step();
        u += to / steps, w += turn / steps;
        plain.go_to(u, w);
      }
      at = run.state();
      const std::vector<bool> expected = plain.cracked();
      std::size_t same = 0, n = 0;
      for (const Bond& b : at.bonds) same += is_cracked(b) == expected[n++];
      const auto number = static_cast<double>(n);
      ASSERT_GE(static_cast<double>(same), 0.95 * number - 1.0);
      if (same < n) {
        tally.add("near its strength");
        return;
      }
      tally.add("cracked cells", static_cast<double>(cracked(at)));
      const double scale = rock.k_n * testing::small_strain * M_PI * sq(rock.radius);
      ASSERT_LT(norm(force_on_first(at) - plain.force()), 3e-3 * scale);
      tally.add("compared");
    }
  });
  EXPECT_GT(all.sum("cracked cells"), all.full ? 5 * all.cases : 0);
  EXPECT_LT(all.sum("near its strength"), all.full ? all.cases / 4 : 1);
}

}  // namespace
}  // namespace vbond::flat_joint_test
