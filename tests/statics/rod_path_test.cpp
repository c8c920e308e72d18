// Paths of frames and rods, through limit points and off along branches, against exact discrete solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "validation/cases.hpp"
#include "vbond/model/bond_sums.hpp"
#include "walks.hpp"

namespace vbond::rod_path_test {
namespace {

using testing::fixed;
using testing::in_plane;
using testing::number;
using testing::pushed;
using testing::refusal;
using testing::Seen;
using testing::Specimen;
using testing::static_stage;
using testing::validation_case;
using testing::walk;
using testing::Walked;

std::vector<ParticleId> everybody(const Specimen& s) {
  return s.model.groups[0].particles;
}

Vec3d force_of_bonds(const State& s, std::size_t particle) {
  Loads loads{PerParticle<Vec3d>(s.r.size()), PerParticle<Vec3d>(s.r.size())};
  add_bond_loads(s, loads);
  return loads.F[ParticleId{particle}];
}

// ---- Lee's frame: validation case E5 ----

/// Legs of length 1 and N bonds: a column up from the origin, a beam from its top towards +x.
Specimen lees_frame(std::size_t N) {
  std::vector<Vec3d> r;
  const double a = 1.0 / static_cast<double>(N);
  for (std::size_t k = 0; k <= N; ++k) r.push_back({0, static_cast<double>(k) * a, 0});
  for (std::size_t k = 1; k <= N; ++k) r.push_back({static_cast<double>(k) * a, 1, 0});
  Specimen s = testing::particles_at(r, 0.1 * a);
  for (std::size_t k = 0; k < 2 * N; ++k) testing::bond(s, k, k + 1, testing::rod50_bond());
  return s;
}

StaticStage lees_stage(const Specimen& s, std::size_t N) {
  const ParticleId foot{0}, end{2 * N};
  StaticStage stage = static_stage(
      StageKind::path,
      {fixed(everybody(s), in_plane), fixed({foot, end}, {true, true, false, false, false, false})},
      {pushed(N + N / 5, {0, -1, 0})});
  stage.path.first_step = 1.0;
  return stage;
}

/// The largest load and the fall of the loaded particle there: energy and its derivatives by mpmath with 34
/// digits, displacement by displacement, balance to 1e-20. The values of the file are off by 3e-8 of these.
struct LargestLoad {
  std::size_t N;
  double load, fall;
};
constexpr LargestLoad largest_loads[] = {{10, 20.183672951190751, 0.420631891560622},
                                         {20, 18.9782228397193607, 0.410237633564693}};

TEST(LeesFrame, HasTheExactDiscreteLimitLoadAndConvergesToTheContinuumsMinimum) {
  const auto& expected = validation_case("E5").at("expected");
  const auto& least = expected.at("continuum").at("lee EA L^2/EI=4e4, no shear").at("limit_min");
  double error_before = 0.0;
  for (const auto& row : expected.at("discrete").at("discrete")) {
    const std::size_t N = row.at("N_per_leg");
    if (N > 40) continue;
    const Specimen s = lees_frame(N);
    StaticStage stage = lees_stage(s, N);
    stage.path.above = 25.0;
    const Walked w = walk(s, stage);
    EXPECT_EQ(w.result.ended, "load factor");
    ASSERT_EQ(w.result.special_points.size(), 2u) << "N = " << N;
    const SpecialPoint &top = w.result.special_points[0], &bottom = w.result.special_points[1];
    EXPECT_EQ(top.kind, PointKind::limit_point);
    EXPECT_EQ(bottom.kind, PointKind::limit_point);
    EXPECT_EQ(top.unstable_before, 0);
    EXPECT_EQ(top.unstable_after, 1);
    EXPECT_EQ(bottom.unstable_before, 1);
    EXPECT_EQ(bottom.unstable_after, 0);
    const auto fall = [&](const SpecialPoint& p) { return 1 - w.at(p).state.r[ParticleId{N + N / 5}].y; };
    EXPECT_NEAR(top.load_factor / number(row.at("Pmax")), 1.0, 5e-8) << "N = " << N;
    EXPECT_NEAR(fall(top), number(row.at("v")), 1e-6) << "N = " << N;
    for (const LargestLoad& exact : largest_loads) {
      if (exact.N != N) continue;
      EXPECT_NEAR(top.load_factor / exact.load, 1.0, 1e-10);  // the tolerance of the balance
      EXPECT_NEAR(fall(top), exact.fall, 1e-8);               // the load is stationary there
    }
    const double error = bottom.load_factor - number(least.at("P_L2_over_EI"));
    // second order; from 10 to 20 bonds 3.7, from 20 to 40 3.9
    if (error_before != 0.0) {
      EXPECT_NEAR(error_before / error, 4.0, 0.4);
    }
    error_before = error;
  }
}

// ---- rods driven by their ends ----

/// Both ends pinned, the last particle moved along x by `travel` at load factor 1; all else in the plane.
StaticStage pinned_stage(const Specimen& s, double travel) {
  const ParticleId first{0}, last{s.model.particles() - 1};
  constexpr HeldDofs pin{true, true, false, false, false, false};
  return static_stage(StageKind::path, {fixed(everybody(s), in_plane), fixed({first}, pin),
                                        fixed({last}, pin, {travel, 0, 0})});
}

/// Load factors at which the straight rod of the paper, driven like this, bends: at rest its bonds carry
/// P = travel / 9 each, and mode q is in balance at P D = 4 c_B B3 S^2 / (B3 + 2 B2 S^2), D = 1 - P,
/// S = sin(q pi / 18): case K1.
double critical_shortening(int q) {
  const double b2 = -0.005, b3 = 0.015, S2 = std::pow(std::sin(q * M_PI / 18), 2);
  const double X = 4 * (b2 + b3 / 2) * b3 * S2 / (b3 + 2 * b2 * S2);
  return 9 * 0.5 * (1 - std::sqrt(1 - 4 * X));
}

TEST(StraightRod, MeetsItsBifurcationsAtTheExactLoadsHoweverLongTheSteps) {
  const Specimen s = testing::straight_rod(10);
  for (const double first_step : {1e-3, 0.02, 0.2}) {  // the largest passes three at once
    StaticStage stage = pinned_stage(s, -0.2);
    stage.path.first_step = first_step;
    stage.path.above = 0.2;
    const Walked w = walk(s, stage);
    ASSERT_EQ(w.result.special_points.size(), 3u);
    for (int q = 1; q <= 3; ++q) {
      const SpecialPoint& p = w.result.special_points[static_cast<std::size_t>(q - 1)];
      EXPECT_EQ(p.kind, PointKind::bifurcation);
      EXPECT_EQ(p.unstable_before, q - 1);
      EXPECT_EQ(p.unstable_after, q);
      // the eigenvalue is met to 1e-10 of its change over the step
      EXPECT_NEAR(p.load_factor, critical_shortening(q) / 0.2, 1e-9) << "mode " << q;
    }
    EXPECT_EQ(w.result.unstable, 3);
    EXPECT_NEAR(w.last().r[ParticleId{4}].x, 4 * (9 - 0.2 * 0.2) / 9, 1e-9);
    EXPECT_EQ(w.last().r[ParticleId{4}].y, 0.0);
  }
}

// In a step over a critical load eigenvalues are looked for next to singular: Lanczos's method failed there
// with 80 bonds and this first step. The exact load is that of the closed form, P (1 - P / EA) for the pinned
// rod.
TEST(StraightRod, IsFollowedOverItsCriticalLoadsWhateverTheFirstStep) {
  const double euler = M_PI * M_PI;
  for (const std::size_t N : {40u, 60u, 80u, 120u})
    for (const double first_step : {0.03, 0.1, 0.25, 0.5, 1.0}) {
      const Specimen s = testing::rod50(N);
      StaticStage stage = static_stage(
          StageKind::path,
          {fixed(everybody(s), in_plane), fixed({ParticleId{0}}, {true, true, false, false, false, false}),
           fixed({ParticleId{N}}, {false, true, false, false, false, false})},
          {pushed(N, {-euler, 0, 0})});
      stage.path.first_step = first_step;
      stage.path.above = 5.0;
      const Walked w = walk(s, stage);
      ASSERT_EQ(w.result.special_points.size(), 2u) << N << ", " << first_step;
      for (const int q : {1, 2}) {  // the discrete rod is off by some (q pi / N)^2 / 12, and EA = 4e4
        const double off = std::pow(q * M_PI / static_cast<double>(N), 2) / 6 + 2 * q * q * euler / 4e4;
        EXPECT_NEAR(w.result.special_points[static_cast<std::size_t>(q - 1)].load_factor / (q * q), 1.0, off);
      }
    }
}

TEST(StraightRod, TurnsOffAlongTheModeAndTheWayThatWereAskedFor) {
  const Specimen s = testing::straight_rod(10);
  for (const int mode : {1, 2, 3})
    for (const double sense : {1.0, -1.0}) {
      StaticStage stage = pinned_stage(s, -1.0);
      stage.path.first_step = 1e-3;
      stage.path.above = 0.5;
      stage.path.branch = BranchSwitch{mode, 1, sense};
      const Walked w = walk(s, stage);
      EXPECT_EQ(w.result.load_factor, 0.5);
      EXPECT_EQ(w.result.unstable, mode - 1);
      int crossings = 0;  // of the line between the ends
      for (std::size_t k = 2; k < 9; ++k)
        crossings += w.last().r[ParticleId{k}].y * w.last().r[ParticleId{k - 1}].y < 0;
      EXPECT_EQ(crossings, mode - 1);
      // the ends turn most, and the first of them decides the sense
      EXPECT_GT(sense * rotation_vector(w.last().q[ParticleId{0}]).z, 0.1);
    }
}

// The first step off moves the rod aside by 0.18, which shortens it by (pi 0.18 / 2)^2 / 9, some 0.01: from
// 0.0028 on the stop is within that step.
TEST(StraightRod, MeetsAStopWithinTheFirstStepOfABranch) {
  const Specimen s = testing::straight_rod(10);
  for (const double beyond : {1e-6, 1e-4, 1e-3}) {
    StaticStage stage = pinned_stage(s, -1.0);
    stage.path.first_step = 1e-3;
    stage.path.above = critical_shortening(1) + beyond;
    stage.path.branch = BranchSwitch{};
    const Walked w = walk(s, stage);
    EXPECT_EQ(w.result.ended, "load factor");
    EXPECT_EQ(w.result.load_factor, *stage.path.above);
    EXPECT_EQ(w.result.unstable, 0);
    EXPECT_EQ(w.result.special_points.size(), 1u);
    // aside like a sine, 9 long: its shortening is (pi A / 2)^2 / 9, to some ten per cent (9 bonds, no
    // force that is constant along the branch)
    EXPECT_NEAR(std::abs(w.last().r[ParticleId{4}].y), 2 / M_PI * 3 * std::sqrt(beyond),
                0.1 * 2 / M_PI * 3 * std::sqrt(beyond));
  }
}

// Free in space, both planes become unstable at once.
TEST(StraightRod, HasABranchInEachPlaneWhereTwoModesVanishTogether) {
  const Specimen s = testing::straight_rod(10);
  constexpr HeldDofs pin{true, true, true, false, false, false};
  for (const int mode : {1, 2}) {
    StaticStage stage =
        static_stage(StageKind::path, {fixed({ParticleId{0}}, {true, true, true, true, false, false}),
                                       fixed({ParticleId{9}}, pin, {-1, 0, 0})});
    stage.path.first_step = 1e-3;
    stage.path.above = 0.1;
    stage.path.branch = BranchSwitch{1, mode, 1.0};
    const Walked w = walk(s, stage);
    ASSERT_GE(w.result.special_points.size(), 1u);
    EXPECT_EQ(w.result.special_points[0].unstable_before, 0);
    EXPECT_EQ(w.result.special_points[0].unstable_after, 2);
    EXPECT_NEAR(w.result.special_points[0].load_factor, critical_shortening(1), 1e-9);
    const Vec3d middle = w.last().r[ParticleId{4}];
    EXPECT_NEAR(mode == 1 ? middle.z : middle.y, 0.0, 1e-12);
    EXPECT_GT(mode == 1 ? middle.y : middle.z, 0.5);
    // torsion energy depends on where n_2 points: the rod would rather bend between the two planes
    EXPECT_EQ(w.result.unstable, 1);
  }
  StaticStage stage = pinned_stage(s, -1.0);
  stage.path.above = 0.1;
  stage.path.branch = BranchSwitch{1, 2, 1.0};
  EXPECT_THROW(walk(s, stage), NoEquilibrium);  // in the plane there is one
}

// E3: over the first branch, sideways by the first mode.
TEST(PinnedElastica, OnItsBranchHasTheExactDiscreteForceAndDeflection) {
  const auto& expected = validation_case("E3").at("expected").at("discrete");
  for (const char* shortening : {"0.1", "0.5"})
    for (const auto& row : expected.at("pinned_elastica_" + std::string(shortening)).at("discrete")) {
      const std::size_t N = row.at("N");
      if (N > 40) continue;
      const Specimen s = testing::rod50(N);
      StaticStage stage = pinned_stage(s, -std::stod(shortening));
      stage.path.first_step = 1e-3;
      stage.path.above = 1.0;
      stage.path.branch = BranchSwitch{};
      const Walked w = walk(s, stage);
      const double P = force_of_bonds(w.last(), N).x, mid = std::abs(w.last().r[ParticleId{N / 2}].y);
      EXPECT_EQ(w.result.load_factor, 1.0);
      EXPECT_NEAR(P / number(row.at("P")), 1.0, 1e-8) << "N = " << N;
      EXPECT_NEAR(mid, number(row.at("mid")), 1e-8) << "N = " << N;
      EXPECT_EQ(w.result.unstable, 0);
      ASSERT_GE(w.result.special_points.size(), 1u);
      EXPECT_EQ(w.result.special_points[0].kind, PointKind::bifurcation);
      EXPECT_EQ(w.result.special_points[0].unstable_after, 1);
    }
}

// Energy, force and end angle of the same energy minimised by mpmath with 34 digits from an arc of a circle.
TEST(PapersRod, IsBentRoundUntilItsEndsAreOneBondApart) {
  const Specimen s = testing::straight_rod(10);
  StaticStage stage = pinned_stage(s, -8.0);
  stage.path.first_step = 1e-5;
  stage.path.above = 1.0;
  stage.path.branch = BranchSwitch{};
  const Walked w = walk(s, stage);
  EXPECT_EQ(w.result.ended, "load factor");
  EXPECT_NEAR(norm(w.last().r[ParticleId{9}] - w.last().r[ParticleId{0}]), 1.0, 1e-14);
  // residual 1e-10 of the largest force, which is ten times the ends'
  EXPECT_NEAR(w.seen.back().energy / 3.952438756360467e-3, 1.0, 1e-9);
  EXPECT_NEAR(force_of_bonds(w.last(), 9).x / 8.119462789052892e-4, 1.0, 1e-9);
  EXPECT_NEAR(rotation_vector(w.last().q[ParticleId{0}]).z, 2.193218953674392, 1e-9);
  ASSERT_EQ(w.result.special_points.size(), 1u);
  EXPECT_NEAR(w.result.special_points[0].load_factor, critical_shortening(1) / 8, 1e-12);
  for (const Seen& p : w.seen) EXPECT_EQ(p.unstable, 0) << "load factor " << p.load_factor;
}

// The torque of a twisted bond peaks at 45 degrees, where the middle particle, between two bonds that share
// the twist, becomes unstable; at 90 degrees it is nothing, and beyond the bonds snap.
TEST(Path, EndsWithTheBondThatIsAboutToSnap) {
  const Specimen s = testing::straight_rod(3);
  StaticStage stage = static_stage(
      StageKind::path,
      {fixed({ParticleId{0}}, testing::clamped), fixed({ParticleId{2}}, testing::clamped, {}, {M_PI, 0, 0})});
  stage.path.above = 2.0;
  std::vector<double> critical;
  double reached = 0.0;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) {
    reached = p.load_factor;
    if (p.kind == PointKind::bifurcation) critical.push_back(p.load_factor);
  };
  try {
    run_static_stage(s.model, stage, s.state, hooks);
    FAIL();
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("snaps"), std::string::npos) << e.what();
  }
  ASSERT_FALSE(critical.empty());
  EXPECT_NEAR(critical[0], 0.5, 1e-9);
  EXPECT_LT(reached, 1.0);
  EXPECT_NEAR(reached, 1.0, 1e-6);
}

/// Clamped at one end, a moment at the other about the rod's own line.
StaticStage torque_stage(const Specimen& s) {
  return static_stage(StageKind::path, {fixed({ParticleId{0}}, testing::clamped)},
                      {pushed(s.model.particles() - 1, {}, {1e-3, 0, 0})});
}

TEST(Path, DoesNotTellStabilityUnderMomentsOfFixedDirection) {
  const Specimen s = testing::straight_rod(4);
  StaticStage stage = torque_stage(s);
  stage.path.first_step = 0.1;
  stage.path.above = 0.5;
  const Walked w = walk(s, stage);
  EXPECT_EQ(w.result.ended, "load factor");
  ASSERT_GT(w.seen.size(), 2u);
  for (const Seen& p : w.seen)  // at load factor 0 there is no moment yet
    EXPECT_EQ(p.unstable.has_value(), p.load_factor == 0.0) << "load factor " << p.load_factor;
  EXPECT_TRUE(w.result.special_points.empty());
  EXPECT_FALSE(w.result.unstable);
  EXPECT_FALSE(w.result.smallest_eigenvalue);
}

TEST(Path, RefusesToTurnOffUnderMomentsOfFixedDirection) {
  const Specimen s = testing::straight_rod(4);
  StaticStage stage = torque_stage(s);
  stage.path.branch = BranchSwitch{};
  const std::string text = refusal(s, stage);
  EXPECT_NE(text.find("bifurcations under it are not found"), std::string::npos) << text;
}

// E2: in space, the moment fixed in direction: the tangent is not symmetric.
TEST(Cantilever, IsFollowedToAPolygonUnderTheClosingEndMoment) {
  for (const auto& row : validation_case("E2").at("expected")) {
    const std::size_t N = row.at("N");
    if (N > 20) continue;
    const Specimen s = testing::rod50(N);
    const double M = number(row.at("M_to_close_polygon"));
    StaticStage stage =
        static_stage(StageKind::path, {fixed({ParticleId{0}}, testing::clamped)}, {pushed(N, {}, {0, 0, M})});
    stage.path.above = 1.0;
    stage.path.first_step = 0.05;
    const Walked w = walk(s, stage);
    EXPECT_LE(norm(w.last().r[ParticleId{N}]), 1e-8) << "N = " << N;
  }
}

}  // namespace
}  // namespace vbond::rod_path_test
