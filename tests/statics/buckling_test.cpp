// Validation case K1 and the rods of data/statics.json: critical loads on the nonlinear path.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "critical_loads.hpp"
#include "material_cases.hpp"
#include "validation/cases.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/newton.hpp"

namespace vbond::buckling_test {
namespace {

using testing::fixed;
using testing::number;
using testing::pushed;
using testing::validation_case;

/// One of the rods of statics.json.
testing::Specimen rod_of(const nlohmann::json& rod) {
  const std::size_t N = rod.at("N");
  const double R = rod.at("R"), spacing = rod.at("a").get<double>() + 2 * R;
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < N; ++k) r.push_back({spacing * static_cast<double>(k), 0, 0});
  testing::Specimen s = testing::particles_at(r, R);
  BondRecipe recipe;
  const auto& B = rod.at("B");
  recipe.parameters = GivenCoefficients{{number(B[0]), number(B[1]), number(B[2]), number(B[3])}};
  recipe.attachment = Attachment::given;
  recipe.R_i = recipe.R_j = R;
  for (std::size_t k = 0; k + 1 < N; ++k) testing::bond(s, k, k + 1, recipe);
  return s;
}
// The same column under a force and under a displacement of its end: what the support exerts is the force,
// and its way the displacement. Where the body stands the load is off by 1e-8 of it, as is the eigenvalue.
TEST(CriticalDisplacements, ComeWithTheReactionAtThem) {
  const std::size_t N = 21;
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < N; ++k) r.push_back({static_cast<double>(k), 0, 0});
  testing::Specimen s = testing::particles_at(r);
  for (std::size_t k = 0; k + 1 < N; ++k) testing::bond(s, k, k + 1, testing::papers_bond());
  const StaticResult pressed = critical_loads(s, pinned(N), {pushed(N - 1, {-1, 0, 0})}, 2);
  std::vector<Support> supports = pinned(N);
  supports[1].held[0] = true;
  supports[1].velocity = {-0.5, 0, 0};
  const StaticResult moved = critical_loads(s, supports, {}, 2);
  ASSERT_EQ(pressed.critical_loads.size(), 2u);
  ASSERT_EQ(moved.critical_loads.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_FALSE(pressed.critical_loads[k].reaction);
    const CriticalLoad& c = moved.critical_loads[k];
    ASSERT_TRUE(c.reaction && c.displacement);
    EXPECT_EQ(*c.displacement, 0.5 * c.load_factor);
    EXPECT_NEAR(*c.reaction / pressed.critical_loads[k].force, 1.0, 1e-7);
  }
}

// The paper's rod in its plane: all eight critical loads, however far apart the looks at the path are. What
// is left of the line through the last two of them is below rounding.
TEST(PinnedRods, HaveAllCriticalLoadsToRoundingWhateverTheSteps) {
  const testing::Specimen rod = testing::straight_rod(10);
  const BondStiffness<double> c = rod.state.bonds[BondId{0}].law->stiffness(rod.state.bonds[BondId{0}]);
  StaticStage stage =
      testing::static_stage(StageKind::buckling,
                            {fixed({ParticleId{0}}, {true, true, true, true, true, false}),
                             fixed({ParticleId{1}, ParticleId{2}, ParticleId{3}, ParticleId{4}, ParticleId{5},
                                    ParticleId{6}, ParticleId{7}, ParticleId{8}},
                                   testing::in_plane),
                             fixed({ParticleId{9}}, {false, true, true, true, true, false})},
                            {pushed(9, {-1, 0, 0})});
  stage.count = 8;
  for (const double largest_step : {0.0, 0.01, 0.02, 0.05, 0.1, 0.3, 1.0}) {
    stage.path.largest_step = largest_step;
    const StaticResult found = run_static_stage(rod.model, stage, rod.state, {}).result;
    ASSERT_EQ(found.critical_loads.size(), 8u) << largest_step;
    for (int q = 1; q <= 8; ++q) {
      const double f = exact_force(q, 9, 1.0, c);
      EXPECT_NEAR(found.critical_loads[static_cast<std::size_t>(q) - 1].load_factor / f, 1.0,
                  tolerance(f, q * M_PI / 9, 9.0, 1.0, c) - 1e-11 + 1e-13)
          << "mode " << q << ", largest_step " << largest_step;
    }
  }
}

// TH1: the paper's rod of ten, its ends held, grows in length by a part x of it, as by heat: it buckles where
// its smallest eigenvalue vanishes. Linear between 1e-5 to either side of the exact x, whose square is left.
TEST(PinnedRods, BuckleByAnImposedGrowthAtTheExactOne) {
  const double exact = testing::material_case("TH1")["expected"]["alpha_dT_critical"];
  const auto stiffness_at = [](double x) {
    BondRecipe recipe = testing::papers_bond();
    recipe.parameters = GivenCoefficients{{1.0, -0.005, 0.015, 1.0 / 480}};  // unchanged by the growth
    recipe.prestrain = 1.0 / (1.0 + x) - 1.0;
    const testing::Specimen s = testing::straight_rod(10, recipe);
    EXPECT_NEAR(s.state.bonds[BondId{0}].a, 1.0 + x, 1e-15);
    StaticStage stage = testing::static_stage(StageKind::equilibrium,
                                              {fixed({ParticleId{0}}, {true, true, true, true, false, false}),
                                               fixed({ParticleId{9}}, testing::translations)});
    stage.at_saddle = AtSaddle::keep;
    return run_static_stage(s.model, stage, s.state, {}).result.smallest_eigenvalue.value();
  };
  const double below = exact * (1 - 1e-5), above = exact * (1 + 1e-5);
  const double k_below = stiffness_at(below), k_above = stiffness_at(above);
  EXPECT_GT(k_below, 0.0);
  EXPECT_LT(k_above, 0.0);
  EXPECT_NEAR((below + (above - below) * k_below / (k_below - k_above)) / exact, 1.0, 1e-9);
}

// All 14 rods, among them Timoshenko bonds, short cylinders and bonds fastened at the surfaces. A round
// section buckles in two planes at one load.
TEST(PinnedRods, BuckleInTwoPlanesAtTheirExactStaticForce) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/statics.json");
  const auto rods = nlohmann::json::parse(file).at("rods");
  ASSERT_EQ(rods.size(), 14u);
  for (const auto& rod : rods) {
    const std::size_t N = rod.at("N");
    const double f = number(rod.at("f_crit_exact"));
    const StaticResult result = critical_loads(rod_of(rod), pinned(N), {pushed(N - 1, {-1, 0, 0})}, 2);
    ASSERT_EQ(result.critical_loads.size(), 2u) << rod.at("label");
    const auto M = static_cast<double>(N - 1);
    const double a = rod.at("a"), L = M * (a + 2 * rod.at("R").get<double>()), B1 = number(rod.at("B")[0]);
    const BondStiffness<double> stiffness{B1, 2 * number(rod.at("B")[2]) / (a * a), 0, 0};
    for (const CriticalLoad& c : result.critical_loads) {
      EXPECT_NEAR(c.load_factor / f, 1.0, tolerance(f, M_PI / M, L, a, stiffness)) << rod.at("label");
      EXPECT_EQ(c.force, c.load_factor);
      // linearised, the rod keeps its length: off by some f / c_A, the strain at buckling
      EXPECT_NEAR(c.estimate.value() / f, 1.0, 2 * f) << rod.at("label");
    }
  }
}

constexpr BondStiffness<double> papers_stiffness{1.0, 0.03, 0.0025, 1.0 / 480};

// The paper's rod: four modes, each in two planes. The numbers are the closed form's.
TEST(PinnedRods, BuckleInHigherModesAtTheirExactStaticForces) {
  const testing::Specimen s = testing::straight_rod(10);
  const StaticResult result = critical_loads(s, pinned(10), {pushed(9, {-1, 0, 0})}, 8);
  const double exact[] = {3.07817634631322e-4, 1.270332822625e-3, 3.009054408433e-3, 5.735417372007e-3};
  ASSERT_EQ(result.critical_loads.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) {
    const int q = 1 + static_cast<int>(k / 2);
    const double f = exact_force(q, 9, 1.0, papers_stiffness);
    EXPECT_NEAR(result.critical_loads[k].load_factor / f, 1.0,
                tolerance(f, q * M_PI / 9, 9, 1, papers_stiffness))
        << k;
    EXPECT_NEAR(f / exact[k / 2], 1.0, 1e-12);
  }
}

// Mode 2 is a sine of two half waves, in a plane through the rod.
TEST(PinnedRods, BuckleInSines) {
  const StaticResult result =
      critical_loads(testing::straight_rod(10), pinned(10), {pushed(9, {-1, 0, 0})}, 4);
  for (const std::size_t k : {0u, 2u}) {
    const Shape& mode = result.critical_loads.at(k).mode;
    const double half_waves = k == 0 ? 1 : 2;
    const Vec3d top = mode.translation[ParticleId{k == 0 ? 4u : 2u}];
    for (const ParticleId p : mode.translation.ids()) {
      const double y = std::sin(half_waves * M_PI * p.value / 9),
                   y_top = std::sin(half_waves * M_PI * (k == 0 ? 4 : 2) / 9);
      EXPECT_LT(norm(mode.translation[p] - (y / y_top) * top), 1e-5) << k << " " << p.value;
    }
    EXPECT_NEAR(norm(top), 1.0, 1e-12);
  }
}

// Half of the critical force is there before.
TEST(CriticalLoads, ComeOnTopOfConstantLoads) {
  const double f = exact_force(1, 9, 1.0, papers_stiffness);
  PointLoad before = pushed(9, {-0.5 * f, 0, 0});
  before.constant = true;
  const StaticResult result =
      critical_loads(testing::straight_rod(10), pinned(10), {before, pushed(9, {-1, 0, 0})}, 2);
  for (const CriticalLoad& c : result.critical_loads)
    EXPECT_NEAR(c.load_factor / (0.5 * f), 1.0, 2 * tolerance(f, M_PI / 9, 9, 1, papers_stiffness));
}

// The middle of the first half wave moves most: particles 4 and 5 of ten.
TEST(CriticalLoads, AreRefusedWithTheNameOfWhatGivesWayWhereTheConstantLoadsAreAboveThem) {
  PointLoad before = pushed(9, {-4e-4, 0, 0});
  before.constant = true;
  try {
    critical_loads(testing::straight_rod(10), pinned(10), {before, pushed(9, {-1, 0, 0})}, 1);
    FAIL() << "not refused";
  } catch (const NoEquilibrium& e) {
    const std::string text = e.what();  // a round rod: y and z are alike
    EXPECT_TRUE(std::regex_search(
        text, std::regex("not stable, first of all in: translation along [yz] of particle")))
        << text;
  }
}

TEST(CriticalLoads, AreNotLookedForUnderMomentsOfFixedDirection) {
  EXPECT_THROW(critical_loads(testing::straight_rod(4), {fixed({ParticleId{0}}, testing::clamped)},
                              {pushed(3, {}, {1e-3, 0, 0})}, 1),
               NoEquilibrium);
}

// Askew nothing is zero by symmetry of the arithmetic: rounding pushes the rod off its line all the way.
TEST(CriticalLoads, DoNotDependOnTheDirectionOfTheBody) {
  const std::size_t N = 20;
  testing::Specimen s = testing::rod50(N);
  const Quatd turn = rotation_of({0.3, -1.1, 0.7});
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] = rotate(turn, s.state.r[p]);
    s.state.q[p] = turn;
  }
  const double P = exact_force(1, 2 * N, 1.0 / N, {4e4 * N, 12.0 * N * N * N, N, N / 1.2});
  const StaticResult result = critical_loads(s, {fixed({ParticleId{0}}, testing::clamped)},
                                             {pushed(N, rotate(turn, Vec3d{-1, 0, 0}))}, 2);
  ASSERT_EQ(result.critical_loads.size(), 2u);
  for (const CriticalLoad& c : result.critical_loads)
    EXPECT_NEAR(c.load_factor / P, 1.0, standard_tolerance(P, M_PI / 2, N));
}

TEST(CriticalLoads, AreForcesOnWholeGroups) {
  PointLoad load{"end", {ParticleId{8}, ParticleId{9}}, {-1, 0, 0}};
  const StaticResult result = critical_loads(testing::straight_rod(10), pinned(10), {load}, 1);
  EXPECT_DOUBLE_EQ(result.critical_loads.at(0).force, 2 * result.critical_loads[0].load_factor);
}

// Pulled, not pushed: bonds end at twice their length.
TEST(CriticalLoads, AreNoneUpToALoadFactorThatIsTold) {
  StaticResult result = critical_loads(testing::straight_rod(3), pinned(3), {pushed(2, {1, 0, 0})}, 3);
  EXPECT_EQ(result.critical_loads.size(), 0u);
  EXPECT_EQ(result.ended, "bond range");
  EXPECT_GT(result.searched_to, 0.5);  // c_A = a = 1: twice as long at 1

  StaticStage stage = testing::static_stage(StageKind::buckling, pinned(3), {pushed(2, {1, 0, 0})});
  stage.search_to = 0.25;
  const testing::Specimen s = testing::straight_rod(3);
  result = run_static_stage(s.model, stage, s.state, {}).result;
  EXPECT_EQ(result.ended, "load factor");
  EXPECT_EQ(result.searched_to, 0.25);
}

// The second mode of the paper's rod is at 1.27e-3.
TEST(CriticalLoads, AreThoseUpToTheLoadFactorThatIsAskedFor) {
  const testing::Specimen s = testing::straight_rod(10);
  StaticStage stage = testing::static_stage(StageKind::buckling, pinned(10), {pushed(9, {-1, 0, 0})});
  stage.search_to = 1.2e-3;
  const StaticResult result = run_static_stage(s.model, stage, s.state, {}).result;
  EXPECT_EQ(result.ended, "load factor");
  EXPECT_EQ(result.critical_loads.size(), 2u);  // one in each plane
  EXPECT_EQ(result.searched_to, 1.2e-3);
}

TEST(CriticalLoads, AreShownToObserversAndLeaveTheBodyWhereItWas) {
  const testing::Specimen s = testing::straight_rod(10);
  std::vector<double> critical, all;
  const StaticHooks hooks{[&](const StaticPoint& p) {
                            all.push_back(p.load_factor);
                            if (p.kind == PointKind::bifurcation) critical.push_back(p.load_factor);
                          },
                          {},
                          {}};
  StaticStage stage = testing::static_stage(StageKind::buckling, pinned(10), {pushed(9, {-1, 0, 0})});
  stage.count = 4;
  const StaticOutcome outcome = run_static_stage(s.model, stage, s.state, hooks);
  EXPECT_EQ(outcome.result.ended, "converged");
  EXPECT_EQ(all[0], 0.0);
  ASSERT_EQ(critical.size(), 2u);  // each in two planes
  for (const std::size_t k : {0u, 1u})
    EXPECT_NEAR(critical[k] / outcome.result.critical_loads[2 * k].load_factor, 1.0, 1e-6);
  EXPECT_EQ(outcome.result.searched_to, outcome.result.critical_loads[3].load_factor);
  EXPECT_EQ(outcome.state.r, s.state.r);
  EXPECT_EQ(outcome.state.clock.step, outcome.result.points);
  EXPECT_EQ(all.size(), static_cast<std::size_t>(outcome.result.points));
}

TEST(CriticalLoads, StopWhenInterrupted) {
  const StaticHooks hooks{{}, {}, [] { return true; }};
  EXPECT_EQ(critical_loads(testing::straight_rod(10), pinned(10), {pushed(9, {-1, 0, 0})}, 2, hooks).ended,
            "interrupted");
}

// Before the first point constant loads are brought to balance: a signal there is no failure of any kind.
TEST(ConstantLoads, MayBeInterruptedBeforeTheyAreBalanced) {
  const testing::Specimen rod = testing::straight_rod(10);
  const StaticHooks hooks{{}, {}, [] { return true; }};
  PointLoad weight = pushed(5, {0, 1e-4, 0});
  weight.constant = true;
  for (const StageKind kind : {StageKind::path, StageKind::buckling, StageKind::modes}) {
    const StaticOutcome outcome =
        run_static_stage(rod.model, testing::static_stage(kind, pinned(10), {pushed(9, {-1, 0, 0}), weight}),
                         rod.state, hooks);
    EXPECT_EQ(outcome.result.ended, "interrupted");
    EXPECT_EQ(outcome.result.points, 0);
    EXPECT_EQ(outcome.state.r, rod.state.r);
  }
}

/// A circular arch of 20 bonds, span 1 and rise 0.2, pinned at its ends, its plane held; a unit force down at
/// the crown.
struct Arch {
  testing::Specimen specimen;
  StaticStage stage;
};

Arch pinned_arch() {
  constexpr std::size_t N = 20;
  const double radius = (0.25 + 0.04) / 0.4, half = std::asin(0.5 / radius);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= N; ++k) {
    const double angle = half * (static_cast<double>(k) / (N / 2) - 1);
    r.push_back({radius * std::sin(angle), radius * (std::cos(angle) - 1), 0});
  }
  Arch arch{testing::particles_at(r, 1e-3), {}};
  for (std::size_t k = 0; k < N; ++k) testing::bond(arch.specimen, k, k + 1, testing::rod50_bond());
  arch.stage = testing::static_stage(StageKind::buckling,
                                     {fixed(arch.specimen.model.groups[0].particles, testing::in_plane),
                                      fixed({ParticleId{0}, ParticleId{N}}, testing::translations)},
                                     {pushed(N / 2, {0, -1, 0})});
  arch.stage.count = 1;
  return arch;
}

/// Negative eigenvalues of the tangent on the fundamental path, reached by 50 steps of equal length.
std::optional<int> unstable_at(const Arch& arch, double load_factor) {
  StaticBody body(arch.specimen.model, arch.stage, arch.specimen.state);
  TangentSolver solver(LinearSolver::direct);
  for (int k = 1; k <= 50; ++k) {
    const double next = load_factor * k / 50;
    solver.factor(body);
    body.move((next - body.load_factor()) * solver.solve(body.load_direction()), next);
    EXPECT_TRUE(correct(body, solver, {}).converged);
  }
  return solver.factor(body);
}

// The arch bends long before it sways aside: its path is curved, and the linearised load is far off.
TEST(CriticalLoads, AreFoundOnACurvedPath) {
  const Arch arch = pinned_arch();
  const StaticResult result =
      run_static_stage(arch.specimen.model, arch.stage, arch.specimen.state, {}).result;
  ASSERT_EQ(result.critical_loads.size(), 1u);
  const CriticalLoad& c = result.critical_loads[0];
  EXPECT_FALSE(c.estimate);  // the tangent at the start says nothing about it
  EXPECT_GT(result.iterations, 0);
  // what is left is the square of 3e-6, times the curvature of an eigenvalue over the load: some 10 at most
  EXPECT_EQ(unstable_at(arch, (1 - 1e-10) * c.load_factor), 0);
  EXPECT_EQ(unstable_at(arch, (1 + 1e-10) * c.load_factor), 1);
  // it sways: the crown moves along x, and the shape is odd
  EXPECT_GT(std::abs(c.mode.translation[ParticleId{10}].x), 0.1);
  EXPECT_NEAR(c.mode.translation[ParticleId{10}].y, 0.0, 1e-6);
}

// Ten particles joined by bonds as thick as they are long, and by bonds far thicker: their critical strain is
// beyond what bonds bear, so that the search has to end by itself.
TEST(CriticalLoads, OfThickRodsAreLookedForAsFarAsBondsHold) {
  const testing::Specimen rod = testing::straight_rod(10);
  for (const double d : {2.0, 20.0, 1e8}) {
    testing::Specimen s = rod;
    s.state.bonds = {};
    BondRecipe recipe;
    const double J = M_PI * std::pow(d, 4) / 64;
    recipe.parameters =
        TheoryParameters{BondTheory::bernoulli_euler, {1.0, 0.2}, {M_PI * d * d / 4, J, 2 * J}, 0};
    for (std::size_t k = 0; k + 1 < 10; ++k) testing::bond(s, k, k + 1, recipe);
    try {
      const StaticResult r = critical_loads(s, pinned(10), {pushed(9, {-1, 0, 0})}, 6);
      EXPECT_EQ(r.ended, "bond range") << d;
      EXPECT_GT(r.searched_to, 0.3 * M_PI * d * d / 4) << d;  // EA times the strain
      EXPECT_LE(r.points, 100) << d;
    } catch (const NoEquilibrium& e) {  // stiffnesses that differ by 1e16 leave nothing of the softest
      EXPECT_EQ(d, 1e8) << e.what();
      EXPECT_NE(std::string(e.what()).find("critical load"), std::string::npos) << e.what();
    }
  }
}

// A shallow truss of two bars, span 2, height 0.1, its plane held. The bars keep their pull c_A and have next
// to no bending stiffness: P / 2 = c_A (L - 1 / cos t) sin t has its maximum where cos^3 t = 1 / L. There
// the path turns back, and there is no balance beyond.
TEST(CriticalLoads, EndWithTheLimitPoint) {
  testing::Specimen truss = testing::particles_at({{-1, 0, 0}, {0, 0.1, 0}, {1, 0, 0}});
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 1e-7, 1e-7, 1e-7};
  testing::bond(truss, 0, 1, recipe);
  testing::bond(truss, 1, 2, recipe);
  const double L = std::hypot(1.0, 0.1), t = std::acos(std::cbrt(1 / L));
  const double limit = 2 * (L - 1 / std::cos(t)) * std::sin(t);
  std::string told;
  const StaticResult result = critical_loads(
      truss,
      {fixed({ParticleId{0}, ParticleId{2}}, {true, true, true, true, true, false}),
       fixed({ParticleId{1}}, testing::in_plane)},
      {pushed(1, {0, -1, 0})}, 6, {{}, [&told](const std::string& text) { told += text; }, {}});
  EXPECT_EQ(result.ended, "limit point");
  ASSERT_EQ(result.critical_loads.size(), 1u);
  EXPECT_EQ(result.critical_loads[0].kind, PointKind::limit_point);
  EXPECT_NEAR(result.critical_loads[0].load_factor / limit, 1.0, 5e-5);  // bending: 1e-7 against 1e-2
  EXPECT_EQ(result.searched_to, result.critical_loads[0].load_factor);
  EXPECT_NE(told.find("beyond it are not looked for; kind = \"path\""), std::string::npos) << told;
}

}  // namespace
}  // namespace vbond::buckling_test
