// Paths of a shallow truss against its closed form; how paths end and what they refuse.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "vbond/core/crossing.hpp"
#include "walks.hpp"

namespace vbond::path_test {
namespace {

using testing::fixed;
using testing::in_plane;
using testing::pushed;
using testing::refusal;
using testing::Seen;
using testing::Specimen;
using testing::static_stage;
using testing::walk;
using testing::Walked;

TEST(Crossing, IsFoundOfWhatIsSteepFlatOrAJump) {
  const auto found = [](double lo, double hi, auto f) {
    return crossing({lo, f(lo)}, {hi, f(hi)}, 0.0, [&f](double s) { return std::optional<double>(f(s)); }).s;
  };
  // the bracket ends at 1e-13 of its first width
  EXPECT_NEAR(found(0.0, 3.0, [](double s) { return std::exp(4 * s) - 2; }), std::log(2.0) / 4, 1e-12);
  EXPECT_NEAR(found(-1.0, 2.0, [](double s) { return std::pow(s - 0.3, 9); }), 0.3, 1e-12);
  EXPECT_NEAR(found(0.0, 1.0, [](double s) { return s < 0.7 ? -1e-9 : 1.0; }), 0.7, 1e-12);
  EXPECT_NEAR(found(1.0, 0.0, [](double s) { return s < 0.7 ? -1.0 : 1e-9; }), 0.7, 1e-12);
}

// ---- a shallow truss of two bonds: von Mises' ----

constexpr double half_span = 1.0, height = 0.1;
constexpr double B1 = 1.0, B3 = 1e-5, B4 = 1e-5;

/// The middle particle is high, the outer ones are held, and nobody turns.
Specimen truss(double high = height, double b3 = B3) {
  Specimen s = testing::particles_at({{-half_span, 0, 0}, {0, high, 0}, {half_span, 0, 0}});
  BondRecipe recipe;
  recipe.parameters = GivenCoefficients{{B1, 0.0, b3, B4}};
  recipe.n_2 = Vec3d{0, 0, 1};
  testing::bond(s, 0, 1, recipe);
  testing::bond(s, 1, 2, recipe);
  return s;
}

StaticStage truss_stage() {
  return static_stage(StageKind::path,
                      {fixed({ParticleId{0}, ParticleId{2}}, testing::clamped),
                       fixed({ParticleId{1}}, {false, false, true, true, true, true})},
                      {pushed(1, {0, -1e-3, 0})});
}

/// Force downwards on the middle particle when it has come down by v: twice the slope of the energy of a
/// bond, [KA12] eq. (7), that has turned by delta while its ends have not: U = B1/2 (D - a)^2 - B3 cos^2
/// delta - B4/4 (1 - sin^4 delta)^2 + constant.
double truss_force(double v, double high = height, double b3 = B3) {
  const double a = std::hypot(half_span, high), y = high - v, D = std::hypot(half_span, y);
  const double delta = std::atan2(high, half_span) - std::atan2(y, half_span);
  const double s = std::sin(delta), c = std::cos(delta);
  const double dU_ddelta = 2 * b3 * c * s + 2 * B4 * (1 - std::pow(s, 4)) * std::pow(s, 3) * c;
  return 2 * (-B1 * (D - a) * y / D + dU_ddelta * half_span / (D * D));
}

/// Where f changes its sign between low and high.
template <class F>
double root(double low, double high, F f) {
  const bool sign = f(low) > 0;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    ((f(middle) > 0) == sign ? low : high) = middle;
  }
  return low;
}

double truss_stiffness(double v) {
  constexpr double h = 1e-4;  // fourth order: 1e-16 of truncation, 1e-16 / h of rounding
  return (8 * (truss_force(v + h) - truss_force(v - h)) - truss_force(v + 2 * h) + truss_force(v - 2 * h)) /
         (12 * h);
}

double descent(const State& s) {
  return height - s.r[ParticleId{1}].y;
}

TEST(ShallowTruss, SnapsThroughAtTheLimitPointsOfItsClosedForm) {
  StaticStage stage = truss_stage();
  stage.path.above = 1.0;
  const Walked w = walk(truss(), stage);
  EXPECT_EQ(w.result.ended, "load factor");
  ASSERT_EQ(w.result.special_points.size(), 2u);
  const double middle = height;  // the chord is flat
  const double v[2] = {root(0.0, middle, truss_stiffness), root(middle, 2 * height, truss_stiffness)};
  for (std::size_t k = 0; k < 2; ++k) {
    const SpecialPoint& p = w.result.special_points[k];
    EXPECT_EQ(p.kind, PointKind::limit_point);
    EXPECT_EQ(p.unstable_before, k == 0 ? 0 : 1);
    EXPECT_EQ(p.unstable_after, k == 0 ? 1 : 0);
    // residual 1e-10 of the largest force, a bond's 5e-3, on 4e-4
    EXPECT_NEAR(p.load_factor, truss_force(v[k]) / 1e-3, 1e-9);
    EXPECT_NEAR(descent(w.at(p).state), v[k], 1e-6);
    EXPECT_EQ(w.at(p).kind, PointKind::limit_point);
  }
  EXPECT_EQ(w.result.load_factor, 1.0);
  EXPECT_NEAR(descent(w.last()), root(2 * height, 4 * height, [](double x) { return truss_force(x) - 1e-3; }),
              1e-9);
  EXPECT_EQ(w.seen.back().unstable, 0);
  EXPECT_EQ(w.seen.back().kind, PointKind::end);
}

TEST(ShallowTruss, IsFollowedPointByPointOnItsClosedForm) {
  StaticStage stage = truss_stage();
  stage.path.above = 1.0;
  const Walked w = walk(truss(), stage);
  const double v[2] = {root(0.0, height, truss_stiffness), root(height, 2 * height, truss_stiffness)};
  for (const Seen& p : w.seen) {
    const double d = descent(p.state);
    EXPECT_NEAR(p.load_factor * 1e-3, truss_force(d), 1e-12);
    if (p.kind != PointKind::limit_point) {
      EXPECT_EQ(p.unstable, d > v[0] && d < v[1] ? 1 : 0) << "v = " << d;
    }
  }
}

TEST(ShallowTruss, IsNotSteppedOverByALongStep) {
  StaticStage stage = truss_stage();
  stage.path.first_step = 0.05;  // to three heights, by the tangent: beyond both limit points
  stage.path.largest_step = 1.0;
  stage.path.above = 2.0;
  EXPECT_EQ(walk(truss(0.02), stage).result.special_points.size(), 2u);
}

/// Loads at the maximum and the minimum of a truss with this stiffness against turning its bonds; equal if
/// there are none.
std::pair<double, double> extremes(double b3) {
  double top = 0.0, bottom = 0.0, before = 0.0;
  bool falls = false;
  for (double v = 0.0; v < 2 * height; v += 1e-5 * height) {
    const double f = truss_force(v, height, b3);
    if (!falls && f < before) top = before, falls = true;
    if (falls && f < before) bottom = f;
    before = f;
  }
  return {top, bottom};
}

// Just before its turning stiffness keeps it from snapping through, the truss has its maximum and its minimum
// next to each other, at nearly one load: on either side of both it is stable, and neither the direction of
// the path nor the load factor shows that they lie between.
TEST(ShallowTruss, HasBothLimitPointsWhereTheyLieWithinOneStep) {
  double snaps = B3, holds = 1.0;  // stiffnesses
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (snaps + holds);
    const auto [top, bottom] = extremes(middle);
    (top - bottom > 1e-3 * top ? snaps : holds) = middle;
  }
  const auto [top, bottom] = extremes(snaps);
  ASSERT_NEAR(top / bottom - 1, 1e-3, 1e-4);
  StaticStage stage = truss_stage();
  for (const double first_step : {0.3, 1.0, 3.0}) {
    stage.path.first_step = first_step * top / 1e-3;
    stage.path.largest_step = 1.0;
    stage.path.above = 2 * top / 1e-3;
    const Walked w = walk(truss(height, snaps), stage);
    ASSERT_EQ(w.result.special_points.size(), 2u) << first_step;
    EXPECT_NEAR(w.result.special_points[0].load_factor * 1e-3 / top, 1.0, 1e-6);
    EXPECT_NEAR(w.result.special_points[1].load_factor * 1e-3 / bottom, 1.0, 1e-6);
  }
}

// Just below the limit point, where the truss is soft, steps of any length end on the way to it; just above
// it every balance lies on the other side. The lower truss goes back by itself without a load: its force is
// least at 2.2e-7, on the way from 5.8e-7.
TEST(ShallowTruss, JumpsUnderLoadStepsOnlyPastItsLimitPointAndIsToldSo) {
  for (const double high : {height, 0.1 * height}) {
    double limit = 0;
    for (double v = 0; v < high; v += 1e-5 * high) limit = std::max(limit, truss_force(v, high));
    const Specimen s = truss(high);
    StaticStage stage = truss_stage();
    stage.kind = StageKind::equilibrium;
    for (const double part : {0.3, 0.9, 0.999, 1.001, 1.5, 3.0})
      for (const int steps : {1, 2, 3, 7, 20, 100}) {
        stage.loads = {pushed(1, {0, -part * limit, 0})};
        stage.steps = steps;
        std::string told;
        StaticHooks hooks;
        hooks.tell = [&told](const std::string& text) { told += text; };
        const StaticOutcome end = run_static_stage(s.model, stage, s.state, hooks);
        EXPECT_EQ(end.state.r[ParticleId{1}].y<0, part> 1.0);
        EXPECT_EQ(end.result.jumped, part > 1.0) << part << " of the limit in " << steps << " steps";
        EXPECT_EQ(told.find("the body jumped") != std::string::npos, part > 1.0) << told;
      }
  }
}

TEST(Path, EndsExactlyAtADistance) {
  StaticStage stage = truss_stage();
  stage.path.distance = DistanceStop{ParticleId{0}, ParticleId{1}, 1.001, true};
  const Walked w = walk(truss(), stage);
  EXPECT_EQ(w.result.ended, "distance");
  EXPECT_NEAR(norm(w.last().r[ParticleId{1}] - w.last().r[ParticleId{0}]), 1.001, 1e-12);
  EXPECT_NEAR(w.result.load_factor * 1e-3, truss_force(descent(w.last())), 1e-12);
}

TEST(Path, EndsExactlyAtALoadFactorMetFromAbove) {
  StaticStage stage = truss_stage();
  stage.path.below = 0.1;  // first met beyond the upper limit point
  const Walked w = walk(truss(), stage);
  EXPECT_EQ(w.result.ended, "load factor");
  EXPECT_EQ(w.result.load_factor, 0.1);
  EXPECT_EQ(w.result.special_points.size(), 1u);
  EXPECT_EQ(w.result.unstable, 1);
  EXPECT_FALSE(w.result.smallest_eigenvalue);  // the one nearest to zero need not be it
}

TEST(Path, SaysThatALoadFactorOfStopIsPassedAtTheStart) {
  StaticStage stage = truss_stage();
  stage.path.above = 0.2;
  stage.path.below = 0.1;
  std::vector<std::string> told;
  const StaticHooks hooks{{}, [&told](const std::string& text) { told.push_back(text); }, {}};
  const Specimen s = truss();
  run_static_stage(s.model, stage, s.state, hooks);
  ASSERT_FALSE(told.empty());
  EXPECT_NE(told[0].find("load factor 0.1 of stop is passed at the start"), std::string::npos) << told[0];
}

TEST(Path, GoesTheWayOfTheFirstStep) {
  StaticStage stage = truss_stage();
  stage.path.first_step = -0.01;
  stage.path.below = -0.5;
  const Walked w = walk(truss(), stage);
  EXPECT_EQ(w.result.ended, "load factor");
  EXPECT_TRUE(w.result.special_points.empty());
  EXPECT_LT(descent(w.last()), 0.0);
}

// A bar of two bonds whose far end is turned about its line by 1 rad: nothing moves, and turns count times
// the length of a bond, here 1. Bonds may turn by 0.2 rad a step, so that some 5 points would do.
TEST(Path, TakesStepsInWhichTurnsAreNoLongerThanTheLargestStep) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1, 1, 1, 1};
  testing::bond(s, 0, 1, recipe);
  testing::bond(s, 1, 2, recipe);
  StaticStage stage = static_stage(
      StageKind::path,
      {fixed({ParticleId{0}}, testing::clamped), fixed({ParticleId{2}}, testing::clamped, {}, {1, 0, 0})});
  stage.path.above = 1.0;
  const auto most_turned = [](const Walked& w) {
    double most = 0.0;
    for (std::size_t k = 1; k < w.seen.size(); ++k)
      most = std::max(most, w.seen[k].load_factor - w.seen[k - 1].load_factor);
    return most;
  };
  stage.path.first_step = 0.2;
  stage.path.largest_step = 1.0;
  EXPECT_GT(most_turned(walk(s, stage)), 0.1);
  stage.path.largest_step = 0.02;
  EXPECT_LE(most_turned(walk(s, stage)), 0.02 * (1 + 1e-9));
}

TEST(Path, StopsAtTheMostPointsAndWhenInterrupted) {
  StaticStage stage = truss_stage();
  stage.path.most_points = 4;
  const Walked w = walk(truss(), stage);
  EXPECT_EQ(w.result.ended, "points");
  EXPECT_EQ(w.seen.size(), 4u);
  EXPECT_EQ(w.result.points, 4);

  int points = 0;
  StaticHooks hooks;
  hooks.point = [&points](const StaticPoint&) { ++points; };
  hooks.interrupted = [&points] { return points == 3; };
  const StaticOutcome outcome = run_static_stage(truss().model, truss_stage(), truss().state, hooks);
  EXPECT_EQ(outcome.result.ended, "interrupted");
  EXPECT_EQ(outcome.result.points, 3);
  EXPECT_EQ(outcome.state.clock.stage_step, 3);
}

TEST(Path, RefusesAStageInWhichNothingGrows) {
  StaticStage stage = truss_stage();
  stage.loads.clear();
  const std::string text = refusal(truss(), stage);
  EXPECT_NE(text.find("nothing changes with the load factor"), std::string::npos) << text;
}

// Bonds without stiffness against bending leave the turn of the middle particle free, though no rigid motion.
TEST(Path, NamesWhatIsSingularAtTheStart) {
  Specimen s = testing::particles_at({{-half_span, 0, 0}, {0, height, 0}, {half_span, 0, 0}});
  BondRecipe recipe;
  recipe.parameters = GivenCoefficients{{B1, 0.0, 0.0, 0.0}};
  testing::bond(s, 0, 1, recipe);
  testing::bond(s, 1, 2, recipe);
  StaticStage stage = truss_stage();
  stage.supports[1].held = in_plane;
  const std::string text = refusal(s, stage);
  EXPECT_NE(text.find("singular at load factor 0, first of all in: rotation about z of particle 1"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace vbond::path_test
