#include "vbond/statics/detail/newton.hpp"

#include <gtest/gtest.h>

#include "bodies.hpp"
#include "statics/matrices.hpp"
#include "vbond/core/error.hpp"

namespace vbond {
namespace {

/// A clamped rod of four bonds, stiff in shear and bending: conjugate gradients converge within its 24
/// unknowns.
struct ClampedRod {
  testing::Specimen s;
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)});

  ClampedRod() {
    BondRecipe recipe = testing::papers_bond();
    recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
    s = testing::straight_rod(5, recipe);
  }
};

// With a shift that makes an indefinite tangent definite minimise() goes downhill: of the wrong sign it would
// make it worse. Conjugate gradients end at 1e-12 of the right-hand side, of size 1 to 3 a component; the
// largest shift is of the size of the tangent.
TEST(TangentSolver, SolvesWithTheShiftedTangent) {
  const ClampedRod rod;
  const StaticBody body(rod.s.model, rod.stage, rod.s.state);
  const Vector b = random_vector(body.unknowns().size(), 4);
  TangentSolver solver(LinearSolver::direct);
  for (const double shift : {0.0, 0.01, 1.0}) {
    ASSERT_TRUE(solver.factor_definite(body, shift));
    const Vector x = solver.solve(b);
    ASSERT_EQ(x.size(), b.size());
    EXPECT_LE((body.tangent() * x + shift * x - b).norm(), 2e-12 * b.norm()) << shift;
  }
}

TEST(TangentSolver, RefusesMultigridInABuildWithoutIt) {
  if (has_multigrid()) GTEST_SKIP() << "this build has it";
  const ClampedRod rod;
  const StaticBody body(rod.s.model, rod.stage, rod.s.state);
  TangentSolver solver(LinearSolver::multigrid);
  EXPECT_THROW(solver.prepare(body), NoEquilibrium);
}

// Straight and pressed far beyond its critical load the rod has a tangent that is definite only with a shift.
TEST(TangentSolver, TellsByTheFactorWhetherAShiftIsEnough) {
  ClampedRod rod;
  for (const ParticleId p : rod.s.state.r.ids()) rod.s.state.r[p].x *= 0.8;  // compressed by 0.2 c_A
  const StaticBody body(rod.s.model, rod.stage, rod.s.state);
  TangentSolver solver(LinearSolver::direct);
  EXPECT_FALSE(solver.factor_definite(body));
  EXPECT_TRUE(solver.factor_definite(body, 1.0));
  EXPECT_GT(solver.factor(body).value(), 0);
}

// Pressed step by step beyond its critical load: a kept factor says so where a new one does, and solves
// alike.
TEST(TangentSolver, WithAKeptFactorNoticesWhereTheTangentIsDefiniteNoMore) {
  ClampedRod rod;
  StaticBody body(rod.s.model, rod.stage, rod.s.state);
  TangentSolver kept(LinearSolver::direct, FactorUse::kept), anew(LinearSolver::direct);
  const Vector b = random_vector(body.unknowns().size(), 4);
  const Placement straight = body.placement();
  constexpr int steps = 400;
  int stable = 0, solved_beside = 0;
  for (int k = 0; k < steps; ++k) {
    Placement pressed = straight;
    for (const ParticleId p : pressed.r.ids()) pressed.r[p].x *= 1.0 - 0.2 * k / steps;
    body.restore(pressed);
    const bool definite = anew.factor_definite(body);
    const auto [shown, solution] = kept.judge(body, b, 1e-12);
    ASSERT_EQ(shown, definite) << k;
    if (!definite) break;
    ++stable;
    if (solution) {
      EXPECT_LE((body.tangent() * *solution - b).norm(), 1e-10 * b.norm()) << k;
      ++solved_beside;
    }
    ASSERT_TRUE(kept.take_definite(body));
    const Vector x = kept.solve(b);
    ASSERT_EQ(x.size(), b.size());
    // to 1e-12 of b in the norm of M^-1; the tangent's eigenvalues differ by 1e4 near the critical load
    EXPECT_LE((body.tangent() * x - b).norm(), 1e-10 * b.norm()) << k;
  }
  EXPECT_GT(stable, 5);
  EXPECT_LT(stable, steps);
  EXPECT_GT(solved_beside, stable / 2);
  EXPECT_LT(kept.last_factor().made(), 2 + stable / 2);
}

}  // namespace
}  // namespace vbond
