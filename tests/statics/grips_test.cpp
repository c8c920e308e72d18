#include <gtest/gtest.h>

#include <cmath>

#include "bodies.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond {
namespace {

using testing::Specimen;

Support grip(std::vector<ParticleId> particles, const Vec3d& displacement, const Vec3d& rotation,
             std::optional<Vec3d> pivot = {}) {
  return {"grip", std::move(particles), all_held, displacement, rotation, {}, true, pivot};
}

/// A square bar of 2 x 2 x n particles along x, one apart, bonded along edges and across the faces.
Specimen bar(std::size_t n) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    for (const double y : {0.0, 1.0})
      for (const double z : {0.0, 1.0}) r.push_back({static_cast<double>(k), y, z});
  Specimen s = testing::particles_at(r);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm(r[j] - r[i]) < 1.5) testing::bond(s, i, j, testing::papers_bond());
  return s;
}
std::vector<ParticleId> face(std::size_t k) {
  return {ParticleId{4 * k}, ParticleId{4 * k + 1}, ParticleId{4 * k + 2}, ParticleId{4 * k + 3}};
}

/// What a hook is told: the points of a stage.
struct Points {
  std::vector<GripView> last;  // grips
  std::vector<double> factor, energy, moment;
  StaticHooks hooks() {
    StaticHooks h;
    h.point = [this](const StaticPoint& p) {
      last = p.grips;
      factor.push_back(p.load_factor);
      energy.push_back(p.energies.total());
      moment.push_back(p.grips.back().moment.x);
    };
    return h;
  }
};

constexpr std::size_t n = 6;
const Vec3d pivot{5, 0.5, 0.5}, rotation{2.0, 0, 0}, displacement{0.1, 0, 0};

StaticStage twist(StageKind kind) {
  return testing::static_stage(
      kind, {testing::fixed(face(0), testing::clamped), grip(face(n - 1), displacement, rotation, pivot)});
}

// A face turned by more than a right angle: exactly on its circles, orientations too.
TEST(StaticGrips, CarryPlacesAndOrientationsExactly) {
  const Specimen s = bar(n);
  StaticStage stage = twist(StageKind::equilibrium);
  stage.steps = 10;
  Points points;
  const StaticOutcome outcome = run_static_stage(s.model, stage, s.state, points.hooks());
  EXPECT_EQ(outcome.result.ended, "converged");
  const Quatd turn = rotation_of(rotation);
  for (const ParticleId p : face(n - 1)) {
    const Vec3d there = pivot + displacement + rotate(turn, s.state.r[p] - pivot);
    EXPECT_LE(norm(outcome.state.r[p] - there), 1e-14);
    EXPECT_LE(norm(rotation_vector(outcome.state.q[p] * conjugate(turn))), 1e-14);
  }
  ASSERT_EQ(points.last.size(), 1u);
  EXPECT_NEAR(points.last[0].angle, 2.0, 1e-15);
  EXPECT_FALSE(points.last[0].work.has_value());
}

// Its moment is the slope of the energy with the angle; the axial force is held by a displacement of 0.
TEST(StaticGrips, MomentIsTheSlopeOfTheEnergy) {
  const Specimen s = bar(n);
  StaticStage stage = twist(StageKind::equilibrium);
  stage.supports[1].velocity = {};
  stage.newton.tolerance = 1e-13;
  stage.steps = 40;
  Points points;
  run_static_stage(s.model, stage, s.state, points.hooks());
  ASSERT_EQ(points.energy.size(), 41u);
  for (const std::size_t k : {std::size_t{10}, std::size_t{20}, std::size_t{30}}) {
    // Simpson's rule over two steps of 0.05 rad: the error is h^5 / 90 times the fourth derivative, of order
    // 0.1
    const double work = 0.05 / 3.0 * (points.moment[k - 1] + 4.0 * points.moment[k] + points.moment[k + 1]);
    EXPECT_NEAR(points.energy[k + 1] - points.energy[k - 1], work, 1e-9) << k;
    EXPECT_GT(work, 1e-3) << k;
  }
}

// Loads on free particles change with the load factor as the tangent says, wherever on the circle the grip
// is.
TEST(StaticGrips, TangentKnowsWhereTheyGo) {
  const Specimen s = bar(3);
  const StaticStage stage = testing::static_stage(
      StageKind::equilibrium, {testing::fixed(face(0), testing::clamped),
                               grip(face(2), {0.1, -0.2, 0}, {0.5, 0.3, -0.4}, Vec3d{2, -1, 0})});
  StaticBody body(s.model, stage, s.state);
  const double h = 1e-5;
  for (const double f : {0.0, 0.7}) {
    const auto at = [&](double factor) {
      body.move(Vector::Zero(body.unknowns().size()), factor);
      return Vector(body.unbalanced());
    };
    const Vector slope = (at(f + h) - at(f - h)) / (2.0 * h);
    at(f);
    EXPECT_LE((body.load_direction() - slope).cwiseAbs().maxCoeff(), 1e-8) << f;  // as in tangent_test.cpp
    EXPECT_GT(slope.cwiseAbs().maxCoeff(), 0.01);
  }
}

// By equilibrium, along a path and through a stage of fracture in which nothing breaks: one balance.
TEST(StaticGrips, EveryKindFindsTheSameBalance) {
  const Specimen s = bar(4);
  const auto moment_by = [&](StageKind kind) {
    StaticStage stage = testing::static_stage(kind, {testing::fixed(face(0), testing::clamped),
                                                     grip(face(3), {}, {0.6, 0, 0}, Vec3d{3, 0.5, 0.5})});
    stage.steps = 4;
    stage.path.above = 1.0;
    stage.newton.tolerance = 1e-12;
    Points points;
    run_static_stage(s.model, stage, s.state, points.hooks());
    EXPECT_NEAR(points.last.at(0).angle, 0.6, 1e-12);
    return points.last.at(0).moment;
  };
  const Vec3d M = moment_by(StageKind::equilibrium);
  EXPECT_GT(M.x, 0.01);
  EXPECT_LE(norm(moment_by(StageKind::path) - M), 1e-10);
  EXPECT_LE(norm(moment_by(StageKind::fracture) - M), 1e-10);
}

// A total torque at the end of a clamped bar is borne by the clamp.
TEST(StaticTotalLoads, AreBorneByTheClamp) {
  const Specimen s = bar(4);
  StaticStage stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed(face(0), testing::clamped)});
  const Vec3d F{0.001, 0.002, 0}, T{0.01, 0, 0};
  stage.loads = {{"end", face(3), {}, {}, {}, F / 4.0, T / 4.0}};
  stage.newton.tolerance = 1e-13;
  StaticHooks hooks;
  Reaction r;
  State end;
  hooks.point = [&](const StaticPoint& p) { r = p.reaction(face(0)), end = p.state; };
  run_static_stage(s.model, stage, s.state, hooks);
  Vec3d moment = T;
  for (const ParticleId p : face(3)) moment += cross(end.r[p], F / 4.0);
  EXPECT_LE(norm(r.force + F), 1e-12);
  EXPECT_LE(norm(r.moment + moment), 1e-12);
}

// What two supports hold alike is counted once: the work of a stage of fracture is what the bonds store.
TEST(StaticSupports, MayOverlapWhereTheyAgree) {
  const Specimen s = testing::straight_rod(5);
  const auto run = [&](bool twice) {
    StaticStage stage = testing::static_stage(
        StageKind::fracture, {testing::fixed({ParticleId{0}}, testing::clamped),
                              testing::fixed({ParticleId{4}}, testing::clamped, {0.02, 0, 0})});
    if (twice) stage.supports.push_back(stage.supports[1]);
    return run_static_stage(s.model, stage, s.state, {});
  };
  const StaticOutcome once = run(false), twice = run(true);
  EXPECT_TRUE(once.state == twice.state);
  EXPECT_EQ(once.result.fracture.books, twice.result.fracture.books);
  EXPECT_GT(once.result.fracture.books.work, 0.0);
}

}  // namespace
}  // namespace vbond
