#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "vbond/case/read.hpp"
#include "vbond/run/run.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/setup/build.hpp"

/// What a run tells of all stages of a case before the first begins.
namespace vbond {
namespace {

/// A rod of five; each test adds its stages. Lines are counted from the first of this text.
const std::string rod = R"(
[[specimen]]
kind = "rod"
particles = 5
radius = 0.4
mass = 1
[[bonds]]
distance = 1.1
stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}
[[stage]]
name = "first"
duration = "1 T0"
)";

std::string static_stage(const std::string& name, const std::string& fix, const std::string& more = "") {
  return "[[stage]]\nname = \"" + name +
         "\"\nkind = \"equilibrium\"\nsupports = [{group = \"first\", fix = [" + fix + "]}]\n" + more;
}

const std::string clamped = R"("x", "y", "z", "rx", "ry", "rz")", pinned = R"("x", "y", "z")";

std::vector<StageRefusal> refusals(const std::string& text) {
  const Case c = parse_case(text, "case.toml");
  Built b = build(c);
  return vbond::Run(std::move(b.model), std::move(b.state), stages_of(c)).refusals();
}

std::string text_of(const std::vector<StageRefusal>& refusals) {
  std::vector<Problem> problems;
  for (const StageRefusal& r : refusals) problems.push_back(r.problem);
  return to_text(problems);
}

void expect_refused(const std::string& text, const std::vector<std::string>& parts) {
  const std::vector<StageRefusal> found = refusals(text);
  EXPECT_EQ(found.size(), parts.size()) << text_of(found);
  for (const std::string& part : parts)
    EXPECT_NE(text_of(found).find(part), std::string::npos) << text_of(found);
}

void expect_silence(const std::string& text) {
  EXPECT_TRUE(refusals(text).empty()) << text_of(refusals(text));
}

TEST(Bonds, ThatAStageDoesNotFindAreToldOnce) {
  const Case c = parse_case(rod + R"([[stage]]
name = "second"
duration = "1 T0"
[[bonds]]
name = "glue"
distance = 1.5
when = "stage"
stages = ["first", "second"]
stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}
[[bonds]]
name = "far"
distance = 2.1
when = "stage"
stages = ["second"]
stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}
)",
                            "case.toml");
  Built b = build(c);
  vbond::Run run(std::move(b.model), std::move(b.state), stages_of(c));
  std::vector<std::string> told;
  run.check();
  EXPECT_EQ(run.notes_on_stage().size(), 1u);
  RunHooks hooks;
  hooks.tell = [&told](const std::string& line) { told.push_back(line); };
  run.set_hooks(hooks);
  for (int k = 0; k < 10; ++k) run.step(3);
  run.run();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_NE(told[0].find("stage \"first\": bonds \"glue\""), std::string::npos) << told[0];
  EXPECT_NE(told[1].find("stage \"second\": bonds \"glue\""), std::string::npos) << told[1];
}

/// A rod whose bonds have this, and one stage.
std::string rod_at_rest(const std::string& of_bonds, const std::string& of_stage,
                        const std::string& more = "") {
  return "[[specimen]]\nkind = \"rod\"\nparticles = 5\nradius = 0.3\nmass = 1\n[[bonds]]\ndistance = 1.1\n" +
         ("stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}\n" + of_bonds) + more +
         "[[stage]]\n" + of_stage;
}

// Both would end the run, without a place, once it has begun.
TEST(Check, FindsCapsulesInAStaticStage) {
  if (!has_statics()) GTEST_SKIP();
  const std::string capsules = "capsule_radius = 0.2\n",
                    touch = "[contact]\nlaw = \"paper-hertz\"\nc_H = 1\npairs = \"unbonded\"\n";
  const std::string at_rest = "kind = \"equilibrium\"\n", moves = "duration = \"1 T0\"\n";
  const std::string strength = "strength = {criterion = \"elongation\", elongation = 0.1}\n";
  const std::string told = "stage \"stage-1\": bonds touch as capsules\n  static stages take";
  expect_refused(rod_at_rest(capsules, at_rest, touch), {"case.toml:14:1: " + told});
  expect_silence(rod_at_rest(capsules, moves, touch));
  expect_refused(rod_at_rest(capsules, moves + "[[stage]]\n" + at_rest, touch),
                 {"case.toml:16:1: stage \"stage-2\": bonds touch as capsules"});
  expect_silence(
      rod_at_rest(capsules + strength, moves + "[[stage]]\n" + at_rest, touch));  // may have broken
}

TEST(Check, FindsModesWhereTwoSlopesMeet) {
  if (!has_statics()) GTEST_SKIP();
  const std::string slopes = "stretching = {form = \"two-slopes\", compression = 0.5}\n",
                    modes = "kind = \"modes\"\n";
  const std::string told =
      "case.toml:10:1: stage \"stage-1\": modes of a body whose bond 0 (particles 0, 1) is at rest";
  expect_refused(rod_at_rest(slopes, modes), {told});
  expect_refused(
      rod_at_rest(slopes, modes + "supports = [{group = \"first\", fix = [\"x\", \"y\", \"z\"]}]\n"), {told});
  expect_silence(rod_at_rest("stretching = {form = \"two-slopes\", compression = 1}\n", modes));
  expect_silence(rod_at_rest(slopes + "prestrain = 1e-3\n", modes));
  const std::string held = "supports = [{group = \"first\", fix = [" + clamped + "]}]\n";
  expect_silence(rod_at_rest(slopes, modes + held + "gravity = [1e-6, 0, 0]\n"));
  expect_silence(rod_at_rest(slopes, "kind = \"equilibrium\"\n" + held));
}

TEST(Check, SaysNothingOfACaseThatRuns) {
  expect_silence(rod + "[[stage]]\nname = \"second\"\nduration = \"1 T0\"\n");
}

TEST(Check, FindsALaterStageWithoutBondsForItsPeak) {
  const std::string later =
      "[[stage]]\nname = \"second\"\nduration = \"9 T0\"\n"
      "stop = {peak = {group = \"first\", average_over = \"1 T0\"}}\n";
  expect_refused(rod + later, {"case.toml:16:9: group \"first\" has no bonds"});
}

// The step of a later stage is known if its bonds are: what it does not fit is told.
TEST(Check, FindsATimeOfALaterStageThatIsShorterThanItsStep) {
  const std::string later = "[[stage]]\nname = \"second\"\nduration = 1e-3\n";
  expect_refused("[time]\nstep = 0.1\n" + rod + later,
                 {"case.toml:15:1: duration = 0.001\n  the time step is 0.1"});
  // with contacts the step may be smaller then
  expect_silence("[time]\nfraction = 0.1\n[contact]\nlaw = \"paper-hertz\"\nc_H = 1\n" + rod + later);
}

// A rule that bonds particles more closely lowers the bound of its stage.
TEST(Check, FindsAStepAboveTheBoundOfALaterStage) {
  const std::string approach =
      "[[bonds]]\nname = \"glue\"\nwhen = \"approach\"\nstages = [\"second\"]\ndistance = 1.2\n"
      "stiffness = {c_A = 100, c_D = 3, c_B = 0.25, c_T = 0.2}\n"
      "[[stage]]\nname = \"second\"\nduration = \"1 T0\"\n";
  expect_refused("[time]\nstep = 0.5\n" + rod + approach,
                 {"case.toml:2:1: time.step = 0.5 (0.07958 T0) in stage \"second\"\n  above "});
  expect_silence("[time]\nstep = 0.01\n" + rod + approach);
}

// One step for all stages: it is told once.
TEST(Check, TellsOneMistakeOnce) {
  const std::string text =
      "[time]\nstep = 9.0\n" + rod + "[[stage]]\nname = \"second\"\nduration = \"20 T0\"\n";
  expect_refused(text, {"time.step = 9"});
}

TEST(Check, FindsPairsOfALaterStageThatAreBondedAlready) {
  const std::string glue =
      "[[bonds]]\nname = \"glue\"\nwhen = \"stage\"\nstages = [\"second\"]\npairs = [[1, 2], [0, 4]]\n"
      "stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}\n"
      "[[stage]]\nname = \"second\"\nduration = \"1 T0\"\n";
  expect_refused(rod + glue, {"case.toml:17:1: bonds \"glue\": pair 1, 2\n  the pair is bonded already"});
}

TEST(Check, FindsMistakesOfSeveralStagesAtOnce) {
  const std::string peak = "stop = {peak = {group = \"first\", average_over = \"1 T0\"}}\n";
  expect_refused(
      rod + peak + "[[stage]]\nname = \"second\"\nduration = \"9 T0\"\n" + peak,
      {"case.toml:13:9: group \"first\" has no bonds", "case.toml:17:9: group \"first\" has no bonds"});
}

TEST(Check, WithoutStaticsRefusesStaticStagesByName) {
  const std::string text = rod + static_stage("bend", clamped);
  if (has_statics()) return expect_silence(text);
  try {
    refusals(text);
    ADD_FAILURE() << "not refused";
  } catch (const CaseError& e) {
    EXPECT_NE(std::string(e.what()).find("case.toml:13:1: stage \"bend\" is static"), std::string::npos)
        << e.what();
  }
}

class StaticCheck : public ::testing::Test {
  void SetUp() override {
    if (!has_statics()) GTEST_SKIP() << "built without statics";
  }
};

TEST_F(StaticCheck, FindsFreeBodiesInEveryStage) {
  expect_refused(
      rod + static_stage("one", pinned) + static_stage("two", clamped) + static_stage("three", pinned),
      {"case.toml:13:1: stage \"one\": parts of the body can move freely",
       "case.toml:21:1: stage \"three\": parts of the body can move freely"});
}

// Whatever may hold the body by then keeps it silent: contacts, bonds by distance or on approach.
TEST_F(StaticCheck, IsSilentOfWhatIsNotKnownYet) {
  const std::string loose = static_stage("loose", pinned);
  const std::string bonds = "distance = 1.2\nstiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}\n";
  expect_silence(rod + "[contact]\nlaw = \"paper-hertz\"\nc_H = 1\n" + loose);
  expect_silence(rod + "[[bonds]]\nname = \"b\"\nwhen = \"approach\"\n" + bonds + loose);
  expect_silence(rod + "[[bonds]]\nname = \"b\"\nwhen = \"stage\"\nstages = [\"loose\"]\n" + bonds + loose);
  // a rule of a stage that comes after cannot help
  expect_refused(rod + "[[bonds]]\nname = \"b\"\nwhen = \"stage\"\nstages = [\"last\"]\n" + bonds + loose +
                     static_stage("last", clamped),
                 {"stage \"loose\": parts of the body can move freely"});
}

// A bond through a face of the cell holds a pair that a later stage turns as one body: it may be broken then.
TEST_F(StaticCheck, IsSilentOfTurnsThroughAFaceWhereTheBondMayBreakBefore) {
  const auto pair = [](const std::string& strength) {
    return "[cell]\na = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\n"
           "[[specimen]]\nname = \"pair\"\nkind = \"list\"\npositions = [[0.2, 1, 1], [2.8, 1, 1]]\n"
           "mass = 1\nradius = 0.1\n[[bonds]]\ndistance = 0.5\n" +
           strength +
           "stiffness = {c_A = 1, c_D = 1, c_B = 1, c_T = 1}\n"
           "[[stage]]\nname = \"rest\"\nkind = \"equilibrium\"\n"
           "supports = [{group = \"pair\", rigid = true}]\n"
           "[[stage]]\nname = \"turn\"\nkind = \"equilibrium\"\n"
           "supports = [{group = \"pair\", rigid = true, rotation = [0, 0, 0.1]}]\n";
  };
  expect_silence(pair("strength = {criterion = \"elongation\", elongation = 0.1}\n"));
  expect_refused(pair(""), {"stage \"turn\": the rigid support of group \"pair\" turns it"});
}

// Pairs that are listed are certain: one part of the body hangs on the other.
TEST_F(StaticCheck, KnowsBondsOfListedPairs) {
  const std::string two = R"(
[[specimen]]
kind = "list"
positions = [[0, 0, 0], [1, 0, 0], [5, 0, 0]]
radius = 0.4
mass = 1
[groups]
root = {indices = [0]}
[[bonds]]
name = "early"
pairs = [[0, 1]]
stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}
[[bonds]]
name = "late"
when = "stage"
stages = ["joined"]
pairs = [[1, 2]]
stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}
[[stage]]
name = "first"
duration = "1 T0"
)";
  const std::string hold =
      "kind = \"equilibrium\"\nsupports = [{group = \"root\", fix = [" + clamped + "]}]\n";
  expect_silence(two + "[[stage]]\nname = \"joined\"\n" + hold);
  expect_refused(two + "[[stage]]\nname = \"apart\"\n" + hold + "[[stage]]\nname = \"joined\"\n" + hold,
                 {"stage \"apart\": parts of the body can move freely"});
}

TEST_F(StaticCheck, FindsALaterStageWithNothingElastic) {
  const std::string dust = R"(
[[specimen]]
kind = "list"
positions = [[0, 0, 0], [1, 0, 0]]
radius = 0.4
mass = 1
[time]
step = 0.1
[[stage]]
name = "fly"
duration = 1
)";
  const std::vector<StageRefusal> found =
      refusals(dust + "[[stage]]\nname = \"bend\"\nkind = \"equilibrium\"\n");
  ASSERT_EQ(found.size(), 1u) << text_of(found);
  EXPECT_EQ(found[0].stage, 1u);
  EXPECT_NE(text_of(found).find("case.toml:12:1: stage \"bend\": nothing is elastic"), std::string::npos);
}

TEST_F(StaticCheck, FindsTheExactStepWithBondsToComeInALaterStage) {
  const std::string approach =
      "[[bonds]]\nname = \"glue\"\nwhen = \"approach\"\nstages = [\"second\"]\ndistance = 1.2\n"
      "stiffness = {c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002}\n"
      "[[stage]]\nname = \"second\"\nduration = \"1 T0\"\n";
  expect_refused("[time]\nstep = \"exact\"\n" + rod + approach,
                 {"case.toml:2:1: time.step = \"exact\" in stage \"second\""});
}

// Mistakes of the case outrank a body that is free: status 2 of the program, with both in the text.
TEST_F(StaticCheck, TellsMistakesAndFreeBodiesTogether) {
  const Case c = parse_case(
      rod + "stop = {peak = {group = \"first\", average_over = \"1 T0\"}}\n" + static_stage("loose", pinned),
      "case.toml");
  Built b = build(c);
  vbond::Run run(std::move(b.model), std::move(b.state), stages_of(c));
  try {
    run.check();
    ADD_FAILURE() << "not refused";
  } catch (const CaseError& e) {
    ASSERT_EQ(e.problems().size(), 2u) << e.what();
    EXPECT_EQ(e.problems()[1].place.line, 14u);
  }
  EXPECT_EQ(run.clock().step, 0);
}

}  // namespace
}  // namespace vbond
