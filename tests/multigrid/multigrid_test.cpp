#include "vbond/statics/detail/multigrid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "multigrid/multigrid_bodies.hpp"
#include "statics/matrices.hpp"
#include "vbond/statics/detail/stability.hpp"

namespace vbond {
namespace {

using testing::ids;
using testing::lattice_of;
using testing::pushed;
using testing::static_stage;

/// A block on rollers: all degrees of freedom of a corner are held, of other particles below one or two.
StaticStage on_rollers(std::size_t n) {
  StaticStage stage = static_stage(
      StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped),
                               testing::fixed(ids(1, n * n - 1), {false, false, true, false, false, false}),
                               testing::fixed(ids(1, n - 1), {false, true, true, false, false, false})});
  stage.loads = {pushed(n * n * n - 1, {0.02, 0.01, -0.03})};
  return stage;
}

StaticOutcome solved_by(LinearSolver solver, const testing::Specimen& s, StaticStage stage) {
  stage.newton.solver = solver;
  return run_static_stage(s.model, stage, s.state, {});
}

void expect_the_same(const testing::Specimen& s, const StaticStage& stage) {
  const StaticOutcome direct = solved_by(LinearSolver::direct, s, stage);
  const StaticOutcome multigrid = solved_by(LinearSolver::multigrid, s, stage);
  EXPECT_EQ(multigrid.result.solver, "multigrid");
  EXPECT_EQ(multigrid.result.unstable, direct.result.unstable);
  EXPECT_EQ(multigrid.result.left_saddle, direct.result.left_saddle);
  ASSERT_TRUE(multigrid.result.smallest_eigenvalue.has_value());
  // residuals of 1e-5 of the eigenvalue leave the square of that, over the gap to the next, which may be
  // small
  EXPECT_NEAR(*multigrid.result.smallest_eigenvalue / *direct.result.smallest_eigenvalue, 1.0, 1e-6);
  // what is out of balance, 1e-10 of the largest force, over the softest stiffness, some 1e-2 of a bond's
  for (const ParticleId p : direct.state.r.ids())
    EXPECT_LE(norm(direct.state.r[p] - multigrid.state.r[p]), 1e-8) << p.value;
}

TEST(Multigrid, FindsTheBalanceOfABlockOnRollers) {
  expect_the_same(lattice_of(6, 6, 6), on_rollers(6));
}

TEST(Multigrid, FindsTheBalanceOfAColumnInLoadSteps) {
  StaticStage stage = static_stage(StageKind::equilibrium, {testing::fixed(ids(0, 9), testing::clamped)},
                                   {pushed(9 * 20 - 1, {0.01, 0, 0})});
  stage.steps = 3;
  expect_the_same(lattice_of(3, 3, 20), stage);
}

// With the whole tangent, by GMRES, corrections are as good as those by factors: as many of them do.
TEST(Multigrid, HasTheWholeTangentUnderMomentsOfFixedDirection) {
  StaticStage stage = static_stage(StageKind::equilibrium, {testing::fixed(ids(0, 9), testing::clamped)},
                                   {pushed(9 * 20 - 1, {}, {0.02, 0.01, 0.03})});
  const testing::Specimen s = lattice_of(3, 3, 20);
  stage.newton.tolerance = 1e-11;
  const StaticOutcome direct = solved_by(LinearSolver::direct, s, stage);
  const StaticOutcome multigrid = solved_by(LinearSolver::multigrid, s, stage);
  EXPECT_LE(multigrid.result.iterations, direct.result.iterations + 1);
  EXPECT_EQ(multigrid.result.unstable, direct.result.unstable);
  for (const ParticleId p : direct.state.r.ids())
    EXPECT_LE(norm(direct.state.r[p] - multigrid.state.r[p]), 1e-8) << p.value;
}

/// Pressed by this part of its length along z, which is beyond critical loads.
StaticStage pressed_column(std::size_t n, double by) {
  return static_stage(StageKind::equilibrium, {testing::fixed(ids(0, 4), testing::clamped),
                                               testing::fixed(ids(4 * (n - 1), 4), testing::clamped,
                                                              {0, 0, -by * static_cast<double>(n - 1)})});
}

// The straight column stays where it is; how many ways it could leave is what its eigenvalues say.
TEST(Multigrid, CountsTheNegativeEigenvaluesOfAColumnBeyondItsCriticalLoads) {
  for (const double by : {0.01, 0.03, 0.08}) {
    testing::Specimen s = lattice_of(2, 2, 24);
    StaticStage stage = pressed_column(24, 0.0);
    for (const ParticleId p : s.state.r.ids()) s.state.r[p].z *= 1.0 - by;
    const StaticBody body(s.model, stage, s.state);
    TangentSolver direct(LinearSolver::direct), multigrid(LinearSolver::multigrid);
    const Stability expected = judge_stability(body, direct), found = judge_stability(body, multigrid);
    EXPECT_EQ(found.unstable, expected.unstable) << by;
    EXPECT_EQ(found.definite, expected.definite) << by;
    EXPECT_GT(expected.unstable.value(), by > 0.05 ? 1 : -1);
  }
}

TEST(Multigrid, LeavesAColumnThatIsUnstable) {
  const testing::Specimen s = lattice_of(2, 2, 24);
  StaticStage stage = pressed_column(24, 0.03);
  stage.steps = 2;
  const StaticOutcome direct = solved_by(LinearSolver::direct, s, stage);
  const StaticOutcome multigrid = solved_by(LinearSolver::multigrid, s, stage);
  ASSERT_TRUE(direct.result.left_saddle);
  EXPECT_TRUE(multigrid.result.left_saddle);
  EXPECT_EQ(multigrid.result.unstable, 0);
  // it may leave to another of the sides, which are alike
  const double energy = StaticBody(s.model, stage, direct.state, 1.0).energies().total();
  EXPECT_NEAR(StaticBody(s.model, stage, multigrid.state, 1.0).energies().total() / energy, 1.0, 1e-8);
}

// To rounding of sums over the particles: 1e-12 of the size of the terms.
TEST(Multigrid, IsASymmetricPreconditionerThatIsDefinite) {
  const testing::Specimen s = lattice_of(5, 6, 7);
  const StaticStage stage = on_rollers(5);
  const StaticBody body(s.model, stage, s.state);
  const int n = body.unknowns().size();
  Multigrid m;
  m.make(body.tangent(), 0.01, body.unknowns(), body.state().r);
  for (unsigned seed = 1; seed < 6; ++seed) {
    const Vector x = random_vector(n, seed), y = random_vector(n, seed + 100);
    const Vector Mx = m.solve(x), My = m.solve(y);
    EXPECT_NEAR(y.dot(Mx), x.dot(My), 1e-12 * x.norm() * My.norm());
    EXPECT_GT(x.dot(Mx), 0.0);
  }
}

// One preconditioner serves all; gradients are solved for to the part of b asked for, in the norm of M^-1,
// which the factor 100 turns into that of b here.
TEST(Multigrid, SolvesWithTheShiftedTangent) {
  const testing::Specimen s = lattice_of(5, 5, 5);
  const StaticStage stage = on_rollers(5);
  const StaticBody body(s.model, stage, s.state);
  TangentSolver solver(LinearSolver::multigrid);
  const Vector b = random_vector(body.unknowns().size(), 4);
  for (const double shift : {0.0, 0.01, 1.0}) {
    ASSERT_TRUE(solver.factor_definite(body, shift));
    const Vector x = solver.solve(b);
    ASSERT_EQ(x.size(), b.size());
    EXPECT_LE((body.tangent() * x + shift * x - b).norm(), 1e-10 * b.norm()) << shift;
  }
}

// A cube small enough for a factor that takes no time keeps it; so does fracture.
TEST(Multigrid, IsChosenWhereAFactorWouldTakeLonger) {
  const testing::Specimen small = lattice_of(6, 6, 6), large = lattice_of(24, 24, 24);
  StaticStage stage = on_rollers(6);
  EXPECT_EQ(choose_solver(small.model, stage, small.state).direct, true);
  stage = on_rollers(24);
  EXPECT_EQ(choose_solver(large.model, stage, large.state).direct, false);
  stage.kind = StageKind::path;
  EXPECT_EQ(choose_solver(large.model, stage, large.state).multigrid, true);
  stage.kind = StageKind::fracture;
  EXPECT_EQ(choose_solver(large.model, stage, large.state).direct, true);
}

}  // namespace
}  // namespace vbond
