#include "vbond/statics/detail/work.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bodies.hpp"
#include "campaigns/dice.hpp"
#include "periodic.hpp"

namespace vbond {
namespace {

/// A block of 3 x 3 x 3 bonded particles whose lower face is clamped. The upper one is moved sideways and
/// turned, and a force draws a particle between them.
struct Block {
  testing::Specimen s;
  StaticStage stage;

  Block() {
    constexpr std::size_t n = 3;
    std::vector<Vec3d> r;
    std::vector<ParticleId> lower, upper;
    for (std::size_t k = 0; k < n * n * n; ++k) {
      r.push_back({double(k % n), double(k / n % n), double(k / n / n)});
      if (k < n * n) lower.push_back(ParticleId{k});
      if (k >= n * n * (n - 1)) upper.push_back(ParticleId{k});
    }
    s = testing::particles_at(r, 0.1);
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
    testing::bond_within(s, 1.1, recipe);
    stage = testing::static_stage(StageKind::fracture,
                                  {testing::fixed(lower, testing::clamped),
                                   testing::fixed(upper, testing::clamped, {0.2, 0, 0.1}, {0, 0, 0.1})},
                                  {testing::pushed(13, {0, 0.1, 0.05})});
  }
};

/// At balances of it.
struct Walker {
  Block block;
  StaticBody body{block.s.model, block.stage, block.s.state};
  TangentSolver solver{LinearSolver::direct, FactorUse::new_each_time};
  StaticResult result;
  WorkOnTheWay way{body, solver, result};

  Walker() { solver.prepare(body); }
  Vector rate() {
    EXPECT_TRUE(solver.take_definite(body));
    return solver.solve(body.load_direction());
  }
  Stand at(double load_factor) {
    body.move(Vector::Zero(body.unknowns().size()), load_factor);
    EXPECT_TRUE(way.correct_here());
    return stand_of(body, rate());
  }
};

// The power of supports, less what the load that grows does on the way aside, is that of the balance but for
// what is of second order: half as far away a quarter is left. Without the rate it is half.
TEST(Work, PowerBesideABalanceIsThatOfTheBalance) {
  Walker w;
  const Stand balance = w.at(0.5);
  testing::Dice dice(5);
  Vector aside(balance.rate.size());
  for (Eigen::Index k = 0; k < aside.size(); ++k) aside[k] = dice(-1.0, 1.0);
  const auto off = [&](double far, const Vector& rate) {
    w.body.restore(balance.at);
    w.body.move(far * aside, 0.5);
    const double of_load = far * w.body.applied(1.0).dot(aside);
    return std::abs(stand_of(w.body, rate).power - of_load - balance.power);
  };
  constexpr double far = 1e-5;  // the third order is as much less than the second, rounding is 1e-16
  EXPECT_NEAR(off(far, {}) / off(0.5 * far, {}), 2.0, 0.01);
  EXPECT_NEAR(off(far, balance.rate) / off(0.5 * far, balance.rate), 4.0, 0.01);
  EXPECT_LT(off(far, balance.rate), 0.01 * off(far, {}));
}

// Between two balances whose rates are known the work is summed up over places that are nearly in balance,
// and becomes what is stored, as over balances, which take Newton's method.
TEST(Work, OfAnElasticWayTakesNoBalances) {
  Walker w;
  const Stand a = w.at(0.5), b = w.at(0.52);
  const double stored = b.stored - a.stored;
  const int before = w.result.iterations;
  EXPECT_NEAR(w.way.between(a, b, b.stored)[0], stored, 2e-10 * stored);
  EXPECT_EQ(w.result.iterations, before);
  Stand unknown = a;
  unknown.rate = {};
  EXPECT_NEAR(w.way.between(unknown, b, b.stored)[0], stored, 2e-10 * stored);
  EXPECT_GT(w.result.iterations, before);
}

/// Two bars of a shallow arch, whose crown is pressed down by a force.
testing::Specimen arch() {
  testing::Specimen s = testing::particles_at({{-1, 0, 0}, {0, 0, 0.1}, {1, 0, 0}}, 0.01);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 1e-6, 1e-6, 1e-6};
  testing::bond(s, 0, 1, recipe);
  testing::bond(s, 1, 2, recipe);
  return s;
}

// It snaps through on the way. What the force does beyond what is stored would go on as vibration, and the
// sums must not take it for work that is stored: W - dE = P dw - dE, both sides of which are known.
TEST(Work, OfAJumpStaysOpen) {
  const testing::Specimen s = arch();
  const HeldDofs upright{true, true, false, true, true, true};
  const double P = 7e-4;  // the largest load is 2 c_A h^3/(3 sqrt 3) / a^2, some 3.8e-4 of c_A
  const StaticStage stage =
      testing::static_stage(StageKind::fracture,
                            {testing::fixed({ParticleId{0}, ParticleId{2}}, testing::clamped),
                             testing::fixed({ParticleId{1}}, upright)},
                            {testing::pushed(1, {0, 0, -P})});
  StaticBody body(s.model, stage, s.state);
  TangentSolver solver(LinearSolver::direct, FactorUse::new_each_time);
  StaticResult result;
  WorkOnTheWay way(body, solver, result);
  solver.prepare(body);
  const auto stand = [&](double load_factor, double z) {
    Vector x = Vector::Zero(body.unknowns().size());
    x[0] = z - body.state().r[ParticleId{1}].z;
    body.move(x, load_factor);
    EXPECT_TRUE(way.correct_here());
    EXPECT_TRUE(solver.take_definite(body));
    return stand_of(body, solver.solve(body.load_direction()));
  };
  const Stand a = stand(0.5, 0.08), b = stand(0.6, -0.12);
  ASSERT_GT(a.at.r[ParticleId{1}].z, 0.05);
  ASSERT_LT(b.at.r[ParticleId{1}].z, -0.1);
  const double stored = b.stored - a.stored,
               work = 0.55 * P * (a.at.r[ParticleId{1}].z - b.at.r[ParticleId{1}].z);
  ASSERT_GT(work, 2.0 * std::abs(stored));
  EXPECT_GT(std::abs(way.between(a, b, work)[0] - stored), 0.5 * (work - stored));
}

}  // namespace
}  // namespace vbond
