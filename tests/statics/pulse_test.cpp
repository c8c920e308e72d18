#include "vbond/statics/detail/pulse.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bodies.hpp"
#include "matrices.hpp"
#include "vbond/statics/detail/eigen.hpp"

namespace vbond::pulse_test {
namespace {

using testing::fixed;

constexpr HeldDofs clamped{true, true, true, true, true, true};

/// A straight column of bonds, long enough for eigenvalues to be found by iteration: 40 x 6 unknowns.
testing::Specimen column() {
  std::vector<Vec3d> r;
  for (int k = 0; k <= 40; ++k) r.push_back({static_cast<double>(k), 0, 0});
  testing::Specimen s = testing::particles_at(r);
  for (std::size_t k = 0; k < 40; ++k) testing::bond(s, k, k + 1, testing::papers_bond());
  return s;
}

/// Asked so many times whether to stop, it says yes.
struct Impatient {
  int patience = 0, asked = 0;
  StaticHooks hooks() {
    StaticHooks h;
    h.interrupted = [this] { return ++asked > patience; };
    return h;
  }
};

StaticStage stage_of(StageKind kind) {
  StaticStage stage = testing::static_stage(kind, {fixed({ParticleId{0}}, clamped)});
  if (kind != StageKind::modes) stage.loads = {testing::pushed(40, {-1, 0, 0})};
  stage.count = 2;
  return stage;
}

// Without a word from the iterations a stage of modes asks once at most, and one of critical loads between
// the points of its path.
TEST(Interruption, EndsAStageWithinASearchForEigenvalues) {
  for (const StageKind kind : {StageKind::modes, StageKind::buckling}) {
    const testing::Specimen s = column();
    Impatient user{10};
    const StaticOutcome outcome = run_static_stage(s.model, stage_of(kind), s.state, user.hooks());
    EXPECT_EQ(outcome.result.ended, "interrupted");
    EXPECT_EQ(user.asked, 11);  // it does not go on after a yes
    EXPECT_TRUE(outcome.result.modes.empty());
    EXPECT_TRUE(outcome.result.critical_loads.empty());
    EXPECT_EQ(outcome.state.r, s.state.r);
  }
}

// Within the step that follows the third point: the first question comes before it, the second from its
// corrections.
TEST(Interruption, LeavesThePointsUpToThere) {
  const testing::Specimen s = column();
  StaticStage stage = stage_of(StageKind::path);
  stage.path.first_step = 1e-5;
  stage.path.most_points = 20;
  std::vector<double> load_factors;
  int asked = 0;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) { load_factors.push_back(p.load_factor); };
  hooks.interrupted = [&] { return load_factors.size() == 3 && ++asked > 1; };
  const StaticOutcome outcome = run_static_stage(s.model, stage, s.state, hooks);
  ASSERT_EQ(outcome.result.ended, "interrupted");
  EXPECT_EQ(outcome.result.points, 3);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(outcome.result.load_factor, load_factors.back());
  EXPECT_EQ(outcome.state.clock.stage_step, 3);
}

// After the last point of a balance nothing but the search for its smallest eigenvalue asks.
TEST(Interruption, WithinTheSearchAfterABalanceLeavesItsLastPoint) {
  const testing::Specimen s = column();
  StaticStage stage = stage_of(StageKind::equilibrium);
  stage.loads = {testing::pushed(40, {1e-3, 0, 0})};
  stage.steps = 2;
  State last;
  int points = 0;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) { last = p.state, ++points; };
  hooks.interrupted = [&points] { return points == 3; };
  const StaticOutcome outcome = run_static_stage(s.model, stage, s.state, hooks);
  EXPECT_EQ(outcome.result.ended, "interrupted");
  EXPECT_EQ(outcome.result.points, 3);
  EXPECT_EQ(outcome.result.load_factor, 1.0);
  EXPECT_EQ(outcome.state.r, last.r);
  EXPECT_EQ(outcome.state.clock.stage_step, 3);
}

TEST(Pulse, TellsWhatTheStageIsAt) {
  StaticHooks hooks;
  std::vector<std::string> lines;
  hooks.progress = [&lines](const std::string& line) { lines.push_back(line); };
  const StaticStage stage = stage_of(StageKind::buckling);
  {
    const Pulse pulse(stage, hooks, std::chrono::milliseconds(0));
    const Pulse::Work work("looking for something");
    Pulse::place(0.25);
    (void)eigenpairs_near_zero(lattice(400, 1, 1, true), 1);
  }
  ASSERT_GT(lines.size(), 10u);
  EXPECT_NE(lines[0].find("stage \"test\""), std::string::npos);
  EXPECT_NE(lines[0].find("load factor 0.25, looking for something; 1 factors"), std::string::npos)
      << lines[0];
  const std::size_t told = lines.size();
  (void)eigenpairs_near_zero(lattice(400, 1, 1, true), 1);
  EXPECT_EQ(lines.size(), told);  // no stage runs any more
}

}  // namespace
}  // namespace vbond::pulse_test
