// Steps along a path where the tangent stiffness is singular to the last bit.
#include "vbond/statics/detail/arc_length.hpp"

#include <gtest/gtest.h>

#include "bodies.hpp"

namespace vbond {
namespace {

using testing::fixed;
using testing::pushed;
using testing::static_stage;

/// A bar along x that resists nothing but a change of its length, its far end free in the plane: across the
/// bar there is no stiffness at all. Its stiffness along is 1.
class LooseBar : public ::testing::Test {
 protected:
  static constexpr double F_x = 1.0, F_y = 0.5;
  testing::Specimen s_ = bar();
  StaticStage stage_ = static_stage(StageKind::path,
                                    {fixed({ParticleId{0}}, testing::clamped),
                                     fixed({ParticleId{1}}, {false, false, true, true, true, true})},
                                    {pushed(1, {F_x, F_y, 0})});
  StaticBody body_{s_.model, stage_, s_.state};
  TangentSolver solver_{LinearSolver::direct};
  ArcLength arc_{body_, solver_, stage_.newton};
  int x_ = body_.unknowns().of(ParticleId{1}, 0), y_ = body_.unknowns().of(ParticleId{1}, 1);

  static testing::Specimen bar() {
    testing::Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
    BondRecipe recipe;
    recipe.parameters = GivenCoefficients{{1.0, 0.0, 0.0, 0.0}};
    testing::bond(s, 0, 1, recipe);
    return s;
  }
  PathDirection across() const { return {Vector::Unit(2, y_), 0.0}; }
};

TEST_F(LooseBar, GoesAcrossWhileTheLoadFactorRests) {
  const std::optional<PathPoint> point = arc_.point_here(across());
  ASSERT_TRUE(point);
  EXPECT_TRUE(arc_.is_singular());
  EXPECT_NEAR(point->tangent.u[y_], 1.0, 1e-14);
  EXPECT_NEAR(point->tangent.u[x_], 0.0, 1e-14);
  EXPECT_NEAR(point->tangent.f, 0.0, 1e-14);
}

// At load factor 0.01 the bar as it lies is not in balance: across it no load can be borne. On the plane
// normal to y only the load factor can change, and back to zero; a step of the end along x would be 0.01.
TEST_F(LooseBar, IsCorrectedByTheLoadFactorAlone) {
  body_.move(Vector::Zero(2), 0.01);
  const StepOutcome outcome = arc_.step(body_.placement(), across(), 1e-9, true);
  ASSERT_TRUE(outcome.point) << outcome.why;
  EXPECT_NEAR(outcome.point->at.load_factor, 0.0, 1e-14);
  EXPECT_NEAR(outcome.deviation.u[x_], 0.0, 1e-14);
  EXPECT_LE(outcome.iterations, 2);
}

}  // namespace
}  // namespace vbond
