// Steps along a path where the tangent stiffness is singular to the last bit.
#include "vbond/statics/detail/arc_length.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bodies.hpp"
#include "vbond/statics/statics.hpp"

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

/// A pinned column in a plane, pressed to this part of its critical load, and a part of the force to the
/// side.
struct Pressed {
  static constexpr std::size_t N = 41;
  testing::Specimen s;
  StaticStage stage;
  explicit Pressed(double aside) : s(column()) {
    stage = static_stage(
        StageKind::path,
        {fixed({ParticleId{0}}, {true, true, true, true, true, false}), fixed(between(), testing::in_plane),
         fixed({ParticleId{N - 1}}, {false, true, true, true, true, false})},
        {pushed(N - 1, {-1, 0, 0}), pushed(N / 2, {0, aside, 0})});
  }
  static testing::Specimen column() {
    std::vector<Vec3d> r;
    for (std::size_t k = 0; k < N; ++k) r.push_back({static_cast<double>(k), 0, 0});
    testing::Specimen s = testing::particles_at(r);
    for (std::size_t k = 0; k + 1 < N; ++k) testing::bond(s, k, k + 1, testing::papers_bond());
    return s;
  }
  static std::vector<ParticleId> between() {
    std::vector<ParticleId> all;
    for (std::size_t k = 1; k + 1 < N; ++k) all.emplace_back(k);
    return all;
  }
};

struct Outcome {
  StepOutcome step;
  double aside = 0;  // of the middle
};

/// One step from load factor 0 to the critical load but for a part of 1e-9, beside the softest mode there.
Outcome step_next_to_critical(double aside) {
  Pressed straight(0.0), p(aside);
  straight.stage.kind = StageKind::buckling;
  straight.stage.count = 1;
  const double critical = run_static_stage(straight.s.model, straight.stage, straight.s.state, {})
                              .result.critical_loads.at(0)
                              .load_factor;
  StaticBody body(p.s.model, p.stage, p.s.state);
  TangentSolver solver(LinearSolver::direct);
  ArcLength arc(body, solver, p.stage.newton);
  const PathPoint start = arc.point_here({Vector::Zero(body.unknowns().size()), 1.0}).value();
  Vector mode = Vector::Zero(body.unknowns().size());  // half a sine
  for (std::size_t k = 1; k + 1 < Pressed::N; ++k)
    mode[body.unknowns().of(ParticleId{k}, 1)] = std::sin(M_PI * static_cast<double>(k) / (Pressed::N - 1));
  const double s = (1 - 1e-9) * critical / start.tangent.f;
  Outcome o{arc.step_beside(mode.normalized(), start.at, start.tangent, s)};
  o.aside = body.state().r[ParticleId{Pressed::N / 2}].y;
  return o;
}

// Of the straight column all that a step next to the critical load has to do is shorten it.
TEST(StepsBesideAMode, LeaveTheColumnStraight) {
  const Outcome o = step_next_to_critical(0.0);
  ASSERT_TRUE(o.step.point) << o.step.why;
  EXPECT_FALSE(o.step.driven);
  EXPECT_LT(std::abs(o.aside), 1e-12);
  EXPECT_LE(o.step.iterations, 3);
}

// A force to the side of 1e-7 of the load drives the mode by 0.22 times that, forty times rounding (6e-10),
// and is told. Without being held the column would go aside by some 1e-7 over 1e-9 of its length. One of 1e-3
// is no column that is nearly straight.
TEST(StepsBesideAMode, TellWhatDrivesIt) {
  const Outcome a_little = step_next_to_critical(1e-7);
  ASSERT_TRUE(a_little.step.point) << a_little.step.why;
  EXPECT_TRUE(a_little.step.driven);
  EXPECT_LT(std::abs(a_little.aside), 1e-5);
  EXPECT_FALSE(step_next_to_critical(1e-3).step.point);
}

}  // namespace
}  // namespace vbond
