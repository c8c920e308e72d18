#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "bodies.hpp"
#include "validation/cases.hpp"
#include "validation/rings.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond {
namespace {

using testing::fixed;
using testing::number;
using testing::pushed;
using testing::static_stage;
using testing::validation_case;

const ParticleId first{0};

StaticOutcome equilibrium(const testing::Specimen& s, const StaticStage& stage,
                          const StaticHooks& hooks = {}) {
  return find_equilibrium(s.model, stage, s.state, hooks);
}

/// A rod of N bonds clamped at its first particle, with a force and a moment at its last.
StaticStage cantilever(std::size_t N, const Vec3d& force, const Vec3d& moment = {}) {
  return static_stage(StageKind::equilibrium, {fixed({first}, testing::clamped)}, {pushed(N, force, moment)});
}

// A chain of Bernoulli-Euler bonds is an exact beam at small load: 11 particles, a = 1, d = 0.2, EJ = 0.0025,
// EA = 1, G J_p = 1 / 480. Nonlinear terms are of the order of the slope squared, 4e-12 at P = 1e-10.
TEST(LinearCantilever, HasTheDeflectionsOfABeam) {
  const testing::Specimen rod = testing::straight_rod(11);
  const double P = 1e-10;
  const ParticleId tip{10};
  const auto end = [&](const Vec3d& force, const Vec3d& moment) {
    const State s = equilibrium(rod, cantilever(10, force, moment)).state;
    return std::pair((s.r[tip] - Vec3d{10, 0, 0}) / P, rotation_vector(s.q[tip]) / P);
  };
  for (const bool along_z : {false, true}) {
    const auto [u, turn] = end(along_z ? Vec3d{0, 0, P} : Vec3d{0, P, 0}, {});
    EXPECT_NEAR(along_z ? u.z : u.y, 1000 / (3 * 0.0025), 1e-9 * 133333);
    EXPECT_NEAR(along_z ? -turn.y : turn.z, 100 / (2 * 0.0025), 1e-9 * 20000);
  }
  EXPECT_NEAR(end({0, 0, 0}, {0, 0, P}).second.z, 10 / 0.0025, 1e-9 * 4000);
  EXPECT_NEAR(end({0, 0, 0}, {P, 0, 0}).second.x, 10 * 480, 1e-9 * 4800);
  EXPECT_NEAR(end({1e-6, 0, 0}, {}).first.x * P, 1e-5, 1e-9 * 1e-5);
}

// E1d: tolerances are those of the reference, whose residual is below 1e-9 of a force of 1; rounding of
// positions, 1e-16, times EA N = 4e4 N, is amplified by 1 / EI to 3e-10 at N = 80.
TEST(Cantilever, UnderADeadTipForceHasTheExactDiscreteTip) {
  for (const int alpha : {1, 5, 10})
    for (const auto& row : validation_case("E1d")
                               .at("expected")
                               .at("cantilever_tip_force_" + std::to_string(alpha))
                               .at("discrete")) {
      const std::size_t N = row.at("N");
      const StaticOutcome bent = equilibrium(testing::rod50(N), cantilever(N, {0, 1.0 * alpha, 0}));
      const ParticleId tip{N};
      EXPECT_NEAR(bent.state.r[tip].x, row.at("tip")[0], 1e-9) << "alpha = " << alpha << ", N = " << N;
      EXPECT_NEAR(bent.state.r[tip].y, row.at("tip")[1], 1e-9) << "alpha = " << alpha << ", N = " << N;
      EXPECT_NEAR(rotation_vector(bent.state.q[tip]).z, row.at("theta"), 1e-9);
      EXPECT_EQ(bent.result.unstable, 0);
    }
}

// E2: the moment that closes the polygon.
TEST(Cantilever, IsRolledUpToAPolygonByTheClosingEndMoment) {
  for (const auto& row : validation_case("E2").at("expected")) {
    const std::size_t N = row.at("N");
    const StaticOutcome closed =
        equilibrium(testing::rod50(N), cantilever(N, {}, {0, 0, number(row.at("M_to_close_polygon"))}));
    EXPECT_LE(norm(closed.state.r[ParticleId{N}]), 1e-8) << "N = " << N;
    EXPECT_NEAR(std::abs(rotation_vector(closed.state.q[ParticleId{N / 2}]).z), M_PI, 1e-8) << "N = " << N;
  }
}

/// Six particles in a row, stiff enough in shear and bending that all residuals tell the same story.
testing::Specimen stout_rod() {
  BondRecipe recipe = testing::papers_bond();
  recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
  return testing::straight_rod(6, recipe);
}

// The last two residuals are each below the square of the one before, times a constant of order 1 (loads,
// lengths and stiffnesses are), until rounding, 1e-15, is reached. Convergence at a fixed rate breaks this.
void expect_quadratic(const std::vector<double>& residuals) {
  std::string all;
  for (const double r : residuals) all += " " + std::to_string(std::log10(r));
  ASSERT_GE(residuals.size(), 4u) << all;
  for (std::size_t k = residuals.size() - 2; k < residuals.size(); ++k)
    EXPECT_LE(residuals[k], std::max(10.0 * residuals[k - 1] * residuals[k - 1], 1e-14)) << all;
}

TEST(Equilibrium, BeginsWithThePointAtLoadFactorZero) {
  const testing::Specimen rod = testing::rod50(10);
  std::vector<double> load_factors, tips;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) {
    load_factors.push_back(p.load_factor);
    tips.push_back(p.state.r[ParticleId{10}].y);
    EXPECT_EQ(p.unstable, 0);
    EXPECT_EQ(p.state.clock.step, static_cast<std::int64_t>(tips.size()));
  };
  const StaticOutcome bent = equilibrium(rod, cantilever(10, {0, 0.1, 0}), hooks);
  ASSERT_EQ(load_factors, (std::vector<double>{0, 1}));
  EXPECT_EQ(tips[0], 0.0);
  EXPECT_GT(tips[1], 0.03);
  EXPECT_EQ(bent.result.points, 2);
}

// At 10 EI / L^2 predictors are cut, so that there are points between.
TEST(Cantilever, MeetsTheLoadFactorsThatAreAskedForWhereOthersComeBetween) {
  StaticStage stage = cantilever(20, {0, 10, 0});
  stage.steps = 5;
  std::vector<double> met;
  StaticHooks hooks;
  hooks.point = [&met](const StaticPoint& p) { met.push_back(p.load_factor); };
  equilibrium(testing::rod50(20), stage, hooks);
  EXPECT_GT(met.size(), 5u);
  for (int k = 1; k <= 5; ++k)
    EXPECT_EQ(std::count(met.begin(), met.end(), k / 5.0), 1) << k;  // to the last bit
}

TEST(Newton, ConvergesQuadratically) {
  StaticStage stage = cantilever(5, {0.0, 0.02, 0.01});
  stage.newton.tolerance = 1e-14;
  expect_quadratic(equilibrium(stout_rod(), stage).result.residuals);
}

// A moment of fixed direction in space has no potential, and its tangent is not symmetric.
TEST(Newton, ConvergesQuadraticallyUnderAppliedMomentsInSpace) {
  StaticStage stage = cantilever(5, {0.0, 0.01, 0.01}, {0.01, -0.04, 0.03});
  stage.newton.tolerance = 1e-14;
  expect_quadratic(equilibrium(stout_rod(), stage).result.residuals);
}

// R1: a quarter of a right angle of a circle, clamped, loaded across its plane; lengths are 100.
TEST(BatheBolourchiBend, HasTheExactDiscreteTip) {
  for (const int P : {300, 600})
    for (const auto& row : validation_case("R1")
                               .at("expected")
                               .at("discrete")
                               .at("bathe_bolourchi_BE_" + std::to_string(P))
                               .at("discrete")) {
      const std::size_t N = row.at("N");
      const StaticOutcome bent =
          equilibrium(testing::bathe_bolourchi_bend(N), cantilever(N, {0, 0, 1.0 * P}));
      EXPECT_LE(norm(bent.state.r[ParticleId{N}] - testing::vector(row.at("tip"))), 1e-7)
          << "P = " << P << ", N = " << N;
      EXPECT_EQ(bent.result.unstable, 0);
    }
}

// E7: half weight on the last particle.
TEST(HeavyCantilever, HasTheExactDiscreteTip) {
  for (const auto& row : validation_case("E7")
                             .at("expected")
                             .at("cant")
                             .at("discrete qL3/EI=10, EA=4e4 (half weight on end particles)")
                             .at("rows")) {
    const std::size_t N = row.at("N");
    testing::Specimen s = testing::rod50(N);
    s.model.mass[ParticleId{N}] /= 2;
    StaticStage stage = cantilever(N, {});
    stage.gravity = {0, -10, 0};
    const State bent = equilibrium(s, stage).state;
    EXPECT_NEAR(bent.r[ParticleId{N}].x, row.at("tip")[0], 1e-9) << "N = " << N;
    EXPECT_NEAR(bent.r[ParticleId{N}].y, row.at("tip")[1], 1e-9) << "N = " << N;
  }
}

// E4: a ring has six rigid motions; supports that carry nothing in balance hold them.
TEST(Ring, UnderTwoOppositeLoadsHasTheExactDiscreteDiameters) {
  for (const int P : {1, 4, -4})
    for (const auto& row :
         validation_case("E4").at("expected").at("discrete").at("ring_" + std::to_string(P)).at("discrete")) {
      const std::size_t N = row.at("N");
      const testing::Specimen s = testing::ring(N, 4e4);
      const StaticStage stage =
          static_stage(StageKind::equilibrium,
                       {fixed({first}, {false, true, true, true, false, false}),
                        fixed({ParticleId{N / 2}}, {false, true, true, false, false, false}),
                        fixed({ParticleId{N / 4}}, {true, false, false, false, false, false})},
                       {pushed(0, {-1.0 * P, 0, 0}), pushed(N / 2, {1.0 * P, 0, 0})});
      const State rest = equilibrium(s, stage).state;
      const auto at = [&rest](std::size_t k) { return rest.r[ParticleId{k}]; };
      EXPECT_NEAR(norm(at(0) - at(N / 2)), row.at("diam_load"), 1e-9) << "P = " << P << ", N = " << N;
      EXPECT_NEAR(norm(at(N / 4) - at(3 * N / 4)), row.at("diam_perp"), 1e-9) << "P = " << P << ", N = " << N;
    }
}

/// A pinned rod of ten particles in the plane, shortened by 1 %: far past its critical load.
StaticStage shortened_strut(AtSaddle at_saddle) {
  StaticStage stage =
      static_stage(StageKind::equilibrium,
                   {fixed({first}, {true, true, true, true, true, false}),
                    fixed({ParticleId{9}}, {true, true, false, false, false, false}, {-0.09, 0, 0})});
  for (std::size_t k = 1; k < 10; ++k) stage.supports.push_back(fixed({ParticleId{k}}, testing::in_plane));
  stage.at_saddle = at_saddle;
  return stage;
}

TEST(Equilibrium, LeavesAStraightStrutPastItsCriticalLoad) {
  const testing::Specimen rod = testing::straight_rod(10);
  const StaticOutcome kept = equilibrium(rod, shortened_strut(AtSaddle::keep));
  // critical loads 3.08e-4, 1.27e-3, 3.0e-3, 5.7e-3, 9e-3 are below the compression of 0.01 of the straight
  // rod
  EXPECT_EQ(kept.result.unstable, 5);
  EXPECT_LT(*kept.result.smallest_eigenvalue, 0.0);
  EXPECT_EQ(kept.state.r[ParticleId{4}].y, 0.0);

  const StaticOutcome left = equilibrium(rod, shortened_strut(AtSaddle::leave));
  EXPECT_TRUE(left.result.left_saddle);
  EXPECT_EQ(left.result.unstable, 0);
  EXPECT_GT(*left.result.smallest_eigenvalue, 0.0);
  // one half wave: all deflections to one side, the largest in the middle
  const auto y = [&left](std::size_t k) { return left.state.r[ParticleId{k}].y; };
  EXPECT_GT(std::abs(y(4)), 0.5);
  for (std::size_t k = 1; k < 9; ++k) EXPECT_GT(y(k) * y(4), 0.0) << k;
  EXPECT_NEAR(y(4), y(5), 1e-9);
}

/// A pinned rod of eleven particles, free in space but for its axis, under this end force.
StaticStage pinned_column(double P) {
  return static_stage(StageKind::equilibrium,
                      {fixed({first}, {true, true, true, true, false, false}),
                       fixed({ParticleId{10}}, {false, true, true, false, false, false})},
                      {pushed(10, {-P, 0, 0})});
}

// The critical load, about pi^2 0.0025 / 100 = 2.47e-4, lies just below load step 10 of 20: the valley that
// leads away from the straight rod is nearly flat there.
TEST(Equilibrium, LeavesASaddleJustAboveTheCriticalLoad) {
  const testing::Specimen rod = testing::straight_rod(11);
  StaticStage stage = pinned_column(5e-4);
  stage.steps = 20;
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text; };
  const StaticOutcome bent = equilibrium(rod, stage, hooks);
  EXPECT_EQ(bent.result.unstable, 0);
  EXPECT_TRUE(bent.result.left_saddle);
  EXPECT_NE(told.find("was left along its lowest mode"), std::string::npos) << told;
  const Vec3d& middle = bent.state.r[ParticleId{5}];
  EXPECT_GT(std::hypot(middle.y, middle.z), 1.0);
}

// A moment far below rounding of what the rod carries makes no saddle stable.
TEST(Equilibrium, LeavesASaddleUnderATinyMoment) {
  StaticStage stage = pinned_column(1e-3);
  stage.loads[0].moment = {1e-12, 0, 0};
  const StaticOutcome bent = equilibrium(testing::straight_rod(11), stage);
  EXPECT_TRUE(bent.result.left_saddle);
  EXPECT_LT(bent.state.r[ParticleId{10}].x, 9.0);  // straight it stays within 0.01 of 10
}

enum class Free { in_space, in_plane };

/// The standard rod of 80 bonds, pinned, free but for its axis, under an end force.
StaticOutcome column_of_80_under(double P, AtSaddle at_saddle, Free free = Free::in_space) {
  const testing::Specimen rod = testing::rod50(80);
  StaticStage stage = static_stage(StageKind::equilibrium,
                                   {fixed({first}, {true, true, true, true, false, false}),
                                    fixed({ParticleId{80}}, {false, true, true, false, false, false})},
                                   {pushed(80, {-P, 0, 0})});
  if (free == Free::in_plane)
    for (const ParticleId p : rod.state.r.ids()) stage.supports.push_back(fixed({p}, testing::in_plane));
  stage.at_saddle = at_saddle;
  return equilibrium(rod, stage);
}

/// Where its lowest eigenvalue vanishes, by secants. It scatters by 3e-10 and falls by 1.2 per part of the
/// load, so this is good to some 2e-10.
double critical_force_of_80() {
  const auto lowest = [](double P) {
    return *column_of_80_under(P, AtSaddle::keep).result.smallest_eigenvalue;
  };
  double P = M_PI * M_PI;
  for (const double w : {1e-2, 1e-4, 1e-5, 1e-6}) {
    const double low = lowest(P * (1 - w)), high = lowest(P * (1 + w));
    P *= 1 - w + 2 * w * low / (low - high);
  }
  return P;
}

// The eigenvalue is -1.2 times the part by which the force is above the critical one, and known to 1.3e-9.
TEST(Equilibrium, JudgesByTheEigenvalueOnBothSidesOfTheCriticalLoad) {
  const double P = critical_force_of_80();
  for (const double off : {1e-8, 1e-6, 1e-5, 1e-4}) {
    const StaticResult below = column_of_80_under(P * (1 - off), AtSaddle::leave).result;
    EXPECT_EQ(below.unstable, 0) << off;
    EXPECT_FALSE(below.neutral || below.left_saddle) << off;
    EXPECT_NEAR(*below.smallest_eigenvalue / off, 1.216, 0.2) << off;
    const StaticResult above = column_of_80_under(P * (1 + off), AtSaddle::keep).result;
    EXPECT_EQ(above.unstable, 2) << off;
    EXPECT_FALSE(above.neutral) << off;
    EXPECT_NEAR(*above.smallest_eigenvalue / off, -1.216, 0.2) << off;
  }
  for (const double off : {-3e-10, 0.0, 3e-10}) {
    const StaticResult at = column_of_80_under(P * (1 + off), AtSaddle::leave).result;
    EXPECT_TRUE(at.neutral) << off;
    EXPECT_EQ(at.unstable, 0) << off;
    EXPECT_FALSE(at.left_saddle) << off;
  }
}

// The elastica: at P = P_c (1 + off) the middle of a column of length 1 is sqrt(8 off) / pi away; the chain
// of 80 differs from it by some off and 1/80^2, and the valley is known to about a hundredth of that.
TEST(Equilibrium, LeavesTheStraightColumnAsSoonAsItIsUnstable) {
  const double P = critical_force_of_80();
  for (const double off : {1e-6, 1e-5, 1e-4, 1e-3}) {
    const StaticOutcome bent = column_of_80_under(P * (1 + off), AtSaddle::leave, Free::in_plane);
    EXPECT_TRUE(bent.result.left_saddle) << off;
    EXPECT_EQ(bent.result.unstable, 0) << off;
    const Vec3d& middle = bent.state.r[ParticleId{40}];
    EXPECT_NEAR(std::hypot(middle.y, middle.z) / (std::sqrt(8 * off) / M_PI), 1.0, 0.02) << off;
  }
}

/// A ball that is pressed into another one by this much.
testing::Specimen ball_on_ball(double overlap) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0, 0, 0.6 - overlap}}, 0.3);
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::all, 1.0, 1.0, 0, 0};
  return s;
}

// The contact pushes the balls apart, and the tangent is zero then: the search for a shift that makes it
// definite must end.
TEST(Equilibrium, OfBallsThatCameApartIsNeutralAndTold) {
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text; };
  const StaticOutcome apart = equilibrium(
      ball_on_ball(0.01), static_stage(StageKind::equilibrium, {fixed({first}, testing::clamped)}), hooks);
  EXPECT_EQ(apart.result.ended, "converged");
  EXPECT_GE(apart.state.r[ParticleId{1}].z, 0.6);
  EXPECT_TRUE(apart.result.neutral);
  EXPECT_NE(told.find("the balance is neutral"), std::string::npos) << told;
}

// The ball is pressed onto the top of the other: it rolls off, and nothing holds it then.
TEST(Equilibrium, OfABallOnTopOfAnotherIsNotStable) {
  StaticStage stage = static_stage(
      StageKind::equilibrium,
      {fixed({first}, testing::clamped), fixed({ParticleId{1}}, {false, false, false, true, true, true})},
      {pushed(1, {0, 0, -1e-3})});
  stage.at_saddle = AtSaddle::keep;
  const StaticOutcome kept = equilibrium(ball_on_ball(0.01), stage);
  EXPECT_EQ(kept.result.unstable, 2);
  EXPECT_LT(*kept.result.smallest_eigenvalue, 0.0);
  stage.at_saddle = AtSaddle::leave;
  EXPECT_THROW(equilibrium(ball_on_ball(0.01), stage), NoEquilibrium);
}

TEST(Equilibrium, StartsFromWhatIsInBalanceAndNotFromNothing) {
  const testing::Specimen rod = testing::rod50(10);
  const State half = equilibrium(rod, cantilever(10, {0, 2, 0})).state;
  const State whole = equilibrium(rod, cantilever(10, {0, 4, 0})).state;
  int points = 0;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint&) { ++points; };
  const StaticOutcome again = find_equilibrium(rod.model, cantilever(10, {0, 2, 0}), half, hooks);
  EXPECT_EQ(again.result.iterations, 0);
  EXPECT_EQ(points, 2);  // at load factors 0 and 1
  const StaticOutcome on = find_equilibrium(rod.model, cantilever(10, {0, 4, 0}), half, {});
  for (const ParticleId p : on.state.r.ids()) EXPECT_LE(norm(on.state.r[p] - whole.r[p]), 1e-9);
}

// Two particles pressed together: Hertz's force, F = c_H overlap^(3/2), and a stiffness that changes with it.
TEST(Equilibrium, PressesContactsTogether) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {1.0, 0, 0}}, 0.505);
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::all, 1.0, 1.0, 0, 0};
  const StaticStage stage = static_stage(
      StageKind::equilibrium,
      {fixed({first}, testing::clamped), fixed({ParticleId{1}}, {false, true, true, true, true, true})},
      {pushed(1, {-0.008, 0, 0})});
  const State pressed = equilibrium(s, stage).state;
  EXPECT_NEAR(1.01 - pressed.r[ParticleId{1}].x, std::pow(0.008, 2.0 / 3.0), 1e-12);  // 0.04
}

TEST(Equilibrium, OfABodyThatIsHeldEverywhereIsThatBody) {
  const testing::Specimen rod = testing::straight_rod(3);
  const StaticOutcome held =
      equilibrium(rod, static_stage(StageKind::equilibrium,
                                    {fixed(rod.model.groups[0].particles, testing::clamped, {1, 0, 0})}));
  EXPECT_EQ(held.result.ended, "converged");
  EXPECT_EQ(held.state.r[ParticleId{2}].x, 3.0);
}

/// What a stage that finds no balance says; empty if it finds one.
std::string refusal(const testing::Specimen& s, const StaticStage& stage, const StaticHooks& hooks = {}) {
  try {
    run_static_stage(s.model, stage, s.state, hooks);
    return "";
  } catch (const NoEquilibrium& e) {
    return e.what();
  }
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Three particles in a row, of which the second is driven onto the first; the third is free.
StaticStage closing(std::array<double, 3> way = {-1, 0, 0}) {
  return static_stage(
      StageKind::equilibrium,
      {fixed({first}, testing::clamped), fixed({ParticleId{1}}, testing::clamped, {way[0], way[1], way[2]})});
}

// Where bonded points meet, the direction between them and all that comes from it is 0 / 0.
TEST(Equilibrium, OfBondedParticlesThatMeetIsNone) {
  double reached = 0.0;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) {
    reached = p.load_factor;
    EXPECT_TRUE(std::isfinite(p.energies.total()));
  };
  const std::string why = refusal(testing::straight_rod(3), closing(), hooks);
  EXPECT_TRUE(holds(why, "bond 0 (particles 0, 1): its loads are not finite")) << why;
  EXPECT_GT(reached, 0.9);
  // the same where nothing is free, so that nothing is out of balance
  const std::string held = refusal(testing::straight_rod(2), closing());
  EXPECT_TRUE(holds(held, "bond 0 (particles 0, 1): its loads are not finite")) << held;
}

TEST(Equilibrium, IsNotFoundFromWhereBondedParticlesLieOnEachOther) {
  testing::Specimen rod = testing::straight_rod(3);
  rod.state.r[ParticleId{2}] = rod.state.r[ParticleId{1}];
  for (const StageKind kind :
       {StageKind::equilibrium, StageKind::path, StageKind::buckling, StageKind::modes}) {
    StaticStage stage = cantilever(2, {0, 1e-6, 0});
    stage.kind = kind;
    const std::string why = refusal(rod, stage);
    EXPECT_TRUE(holds(why, "bond 1 (particles 1, 2): its loads are not finite")) << why;
  }
}

// Forces up to 1e308, and a way of 1e200 on a bond of 1e300.
TEST(Equilibrium, OfForcesThatOverflowIsNone) {
  testing::Specimen rod = testing::straight_rod(3);
  rod.state.bonds[BondId{0}].coefficients.set(0, 1e300);
  const std::string why = refusal(rod, closing({1e200, 0, 0}));
  EXPECT_TRUE(holds(why, "bond 0 (particles 0, 1): its")) << why;
  EXPECT_TRUE(holds(why, "not finite")) << why;
}

TEST(Equilibrium, OfNothingIsNothing) {
  const testing::Specimen nothing = testing::particles_at({});
  EXPECT_EQ(equilibrium(nothing, static_stage(StageKind::equilibrium, {})).result.ended, "converged");
}

TEST(StaticStages, OfWhatIsFreeRefuseABodyThatIsHeldEverywhere) {
  const testing::Specimen rod = testing::straight_rod(3), nothing = testing::particles_at({});
  for (const StageKind kind : {StageKind::path, StageKind::buckling, StageKind::modes}) {
    const StaticStage stage =
        static_stage(kind, {fixed(rod.model.groups[0].particles, testing::translations),
                            fixed(rod.model.groups[0].particles, {false, false, false, true, true, true})});
    const std::string why = refusal(rod, stage);
    EXPECT_TRUE(holds(why, "nothing is free to move")) << why;
    EXPECT_TRUE(holds(refusal(nothing, static_stage(kind, {})), "nothing is free to move"));
  }
}

TEST(Equilibrium, NamesWhatCanMoveFreely) {
  StaticStage stage = cantilever(10, {0, 1, 0});
  stage.supports[0].held = {true, true, true, false, true, true};
  try {
    equilibrium(testing::rod50(10), stage);
    FAIL() << "a rod that may turn about its axis has no single balance";
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("rotation about"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("particles 0 to 10"), std::string::npos) << e.what();
  }
}

// A bond in torsion carries B4 / 2 at most: no balance beyond, and the last one is kept.
TEST(Equilibrium, SaysHowFarTheLoadCouldGo) {
  const testing::Specimen rod = testing::straight_rod(2);
  const double most = 0.5 * rod.state.bonds[BondId{0}].coefficients[3];
  double reached = 0.0;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) { reached = p.load_factor; };
  StaticStage stage = cantilever(1, {}, {2.0 * most, 0, 0});
  try {
    equilibrium(rod, stage, hooks);
    FAIL();
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("load factor 0.4"), std::string::npos) << e.what();
  }
  EXPECT_GT(reached, 0.45);
  EXPECT_LT(reached, 0.5);
}

// The factor of a chain has what its tangent has: of ten free particles 21 entries on and below the diagonal
// of the own block, and 36 for each of nine bonds between them. A full square is 60 x 60.
TEST(ChooseSolver, SaysWhatTheFactorTakes) {
  const testing::Specimen rod = testing::straight_rod(11);
  StaticStage stage = cantilever(10, {0, 1e-6, 0});
  const SolverChoice automatic = choose_solver(rod.model, stage, rod.state);
  EXPECT_TRUE(automatic.direct);
  EXPECT_GE(automatic.factor_bytes, (10 * 21 + 9 * 36) * 8);
  EXPECT_LE(automatic.factor_bytes, 60 * 60 * 8);
  stage.kind = StageKind::modes;
  EXPECT_TRUE(choose_solver(rod.model, stage, rod.state).direct);
}

}  // namespace
}  // namespace vbond
