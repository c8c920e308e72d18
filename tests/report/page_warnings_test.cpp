#include "vbond/report/warnings.hpp"

#include <gtest/gtest.h>

#include "specimen.hpp"

namespace vbond::page {
namespace {

/// A run of one stage of nine bonds that went well.
struct Known {
  std::optional<RunSummary> summary{RunSummary{}};
  History history{{{"time", {0, 10, 20}},
                   {"balance_error", {0, 1e-5, -2e-5}},
                   {"strained", {0, 0, 0}},
                   {"snapped", {0, 0, 0}}}};
  Body body;
  StepFacts step{0.1, 1.0};
  std::vector<Warning> files;

  Known() {
    summary->bonds = 9;
    summary->stages.resize(1);
    summary->stages[0].name = "push";
    summary->stages[0].stop = StopReason::duration;
    summary->stages[0].time = 20;
  }
  std::vector<Warning> look(std::size_t stages = 1) const {
    return warnings({.summary = summary,
                     .history = history,
                     .body = body,
                     .stages = stages,
                     .resume_command = "vbond resume push.out",
                     .step = step,
                     .files = files});
  }
};

void expect_text(const Warning& w, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_NE(w.text.find(part), std::string::npos) << part << " in: " << w.text;
}

TEST(PageWarnings, ASoundRunHasNone) {
  EXPECT_TRUE(Known().look().empty());
}

TEST(PageWarnings, ADivergedRunSaysWhenAndWhy) {
  Known run;
  run.summary->stages[0].stop = StopReason::diverged;
  run.summary->stages[0].time = 17.5;
  run.summary->stages[0].failure = "step 175: bond 4 (particles 4, 5): energy nan\n  use a smaller time.step";
  const std::vector<Warning> w = run.look(3);
  ASSERT_EQ(w.size(), 1U);
  EXPECT_EQ(w[0].level, Level::error);
  expect_text(w[0], {"became unphysical in stage \"push\"", "t = 17.5", "bond 4 (particles 4, 5)",
                     "smaller time.step"});
}

TEST(PageWarnings, AFailedStaticStageSaysHowFarItCame) {
  Known run;
  run.summary->stages[0].statics =
      StaticSummary{.kind = StageKind::equilibrium, .result = {}, .failure = "too far"};
  run.summary->stages[0].statics->result.ended = "failed";
  run.summary->stages[0].statics->result.load_factor = 0.625;
  const std::vector<Warning> w = run.look();
  ASSERT_EQ(w.size(), 1U);
  EXPECT_EQ(w[0].level, Level::error);
  expect_text(w[0], {"failed after load factor 0.625", "too far"});
}

TEST(PageWarnings, SnappedBondsAreCountedExplainedAndNamed) {
  Known run;
  run.history.columns[3].values = {0, 1, 3};
  run.summary->snapped = 3;
  run.body.first_snapped = {4, 4, 5, 20.0};
  const std::vector<Warning> w = run.look();
  ASSERT_EQ(w.size(), 1U);
  EXPECT_EQ(w[0].level, Level::error);
  expect_text(w[0], {"3 of 9 bonds are snapped at the end", "more than 90 degrees", "passed its peak",
                     "First seen at t = 10.", "bond 4 (particles 4, 5) at t = 20"});
}

TEST(PageWarnings, WhileAStageRunsTheLastRowCounts) {
  Known run;
  run.summary->snapped = 5;  // as the stage before ended
  run.summary->stages[0].time = 10;
  run.history.columns[3].values = {0, 5, 2};
  expect_text(run.look()[0], {"2 of 9 bonds are snapped at the end"});
}

TEST(PageWarnings, BondsThatCameBackWeighLess) {
  Known run;
  run.summary->ever_snapped = 2;
  run.summary->ever_strained = 5;
  const std::vector<Warning> w = run.look();
  ASSERT_EQ(w.size(), 2U);
  EXPECT_EQ(w[0].level, Level::warning);
  expect_text(w[0], {"2 of 9 bonds snapped on the way and came back"});
  expect_text(w[1], {"5 bonds were strained"});
}

TEST(PageWarnings, TellOverlapsOfWhatIsNotBonded) {
  Known run;
  run.summary->ever_overlapping = 3;
  const std::vector<Warning> w = run.look();
  ASSERT_EQ(w.size(), 1U);
  EXPECT_EQ(w[0].level, Level::warning);
  expect_text(w[0], {"3 pairs of particles that are not bonded overlapped"});
}

TEST(PageWarnings, TellStretchedBondsAndParticlesThatAreTooFast) {
  Known run;
  run.summary->ever_stretched = 1;
  run.summary->too_fast = 4.0;
  const std::vector<Warning> w = run.look();
  ASSERT_EQ(w.size(), 2U);
  EXPECT_EQ(w[0].level, Level::warning);
  expect_text(w[0], {"1 bond was longer than twice the length at rest"});
  EXPECT_EQ(w[1].level, Level::warning);
  expect_text(w[1], {"up to 4 times as far in a step"});
}

TEST(PageWarnings, WorseComesFirst) {
  Known run;
  run.summary->stages[0].stop = StopReason::interrupted;
  run.summary->ever_strained = 1;
  run.summary->snapped = 1;
  const std::vector<Warning> w = run.look();
  ASSERT_EQ(w.size(), 3U);
  EXPECT_EQ(w[0].level, Level::error);
  EXPECT_EQ(w[1].level, Level::warning);
  EXPECT_EQ(w[2].level, Level::note);
  expect_text(w[2], {"stopped by a signal", "vbond resume push.out"});
}

TEST(PageWarnings, EnergyAndStepHaveTheirLimits) {
  Known run;
  run.history.columns[1].values = {0, 0, -0.9e-3};
  run.step = {0.9, 1.0};
  EXPECT_TRUE(run.look().empty());
  run.history.columns[1].values = {0, -1.1e-2, 0};
  run.step = {0.91, 1.0};
  const std::vector<Warning> w = run.look();
  ASSERT_EQ(w.size(), 2U);
  expect_text(w[0], {"0.91 of the critical one"});
  expect_text(w[1], {"off by up to 0.011"});
  run.history.columns[1].values = {0, -1.1e-3, 0};
  EXPECT_EQ(run.look()[1].level, Level::note);
  run.step = {1.2, 1.0};
  EXPECT_EQ(run.look()[0].level, Level::error);
}

TEST(PageWarnings, UnstableBalancesAreTold) {
  Known run;
  StaticSummary& statics = run.summary->stages[0].statics.emplace();
  EXPECT_TRUE(run.look().empty());
  statics.result.unstable = 2;
  ASSERT_EQ(run.look().size(), 1U);
  EXPECT_EQ(run.look()[0].level, Level::warning);
  expect_text(run.look()[0], {"is unstable in 2 directions"});
  statics.kind = StageKind::path;  // part of it: no reason not to believe the rest
  ASSERT_EQ(run.look().size(), 1U);
  EXPECT_EQ(run.look()[0].level, Level::note);
  expect_text(run.look()[0], {"ends at an unstable balance"});
  statics.kind = StageKind::equilibrium;
  statics.result.unstable = 0;
  statics.result.jumped = true;
  ASSERT_EQ(run.look().size(), 1U);
  expect_text(run.look()[0], {"lost its balance and jumped"});
}

TEST(PageWarnings, ARunWithoutResultsIsNotComplete) {
  Known run;
  run.summary.reset();
  const std::vector<Warning> w = run.look(2);
  ASSERT_EQ(w.size(), 1U);
  EXPECT_EQ(w[0].level, Level::note);
  expect_text(w[0], {"0 of 2 stages have ended"});
}

TEST(PageWarnings, TroubleWithFilesIsAmongThem) {
  Known run;
  run.files = {{Level::warning, "The last frame is left out."}};
  ASSERT_EQ(run.look().size(), 1U);
  EXPECT_EQ(run.look()[0].text, "The last frame is left out.");
}

}  // namespace
}  // namespace vbond::page
