#include "vbond/observe/summary.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "specimen.hpp"
#include "vbond/core/error.hpp"

namespace vbond {
namespace {

using test::content_of;
using test::Folder;
using test::put_content;

RunSummary buckling() {
  RunSummary s;
  s.title = "rod";
  s.version = "1.2.3";
  s.instruction_set = "avx2";
  s.threads = 4;
  s.particles = 10;
  s.bonds = 9;
  s.T_0 = 6.283185307179586;
  s.stages = {{"relax", StopReason::duration, 500, 0.01, 5.0, {}, {}},
              {"squeeze", StopReason::peak, 3000000, 0.0628, 188405.0, 3.18e-4, 188300.0}};
  s.energy_balance_error = 1.5e-5;
  s.strained = 2, s.snapped = 1, s.ever_strained = 4, s.ever_snapped = 3;
  s.bond_steps = 27000000;
  s.stepping_seconds = 2.0;
  s.wall_time = {{"build", 0.25}, {"steps", 2.0}};
  return s;
}

TEST(RunSummary, JsonHoldsEveryResultUnderItsName) {
  const Folder folder;
  write_summary(folder / "run.json", buckling());
  const auto j = nlohmann::json::parse(content_of(folder / "run.json"));
  EXPECT_EQ(j["title"], "rod");
  EXPECT_EQ(j["version"], "1.2.3");
  EXPECT_EQ(j["units"], "reduced");
  EXPECT_EQ(j["particles"], 10);
  EXPECT_EQ(j["bonds"], 9);
  EXPECT_EQ(j["T0"].get<double>(), 6.283185307179586);
  ASSERT_EQ(j["stages"].size(), 2u);
  EXPECT_EQ(j["stages"][0]["stop"], "duration");
  EXPECT_FALSE(j["stages"][0].contains("critical_force"));
  EXPECT_EQ(j["stages"][1]["name"], "squeeze");
  EXPECT_EQ(j["stages"][1]["stop"], "peak");
  EXPECT_EQ(j["stages"][1]["steps"], 3000000);
  EXPECT_EQ(j["stages"][1]["dt"], 0.0628);
  EXPECT_EQ(j["stages"][1]["time"], 188405.0);
  EXPECT_EQ(j["stages"][1]["critical_force"], 3.18e-4);
  EXPECT_EQ(j["critical_force"], 3.18e-4);
  EXPECT_EQ(j["peak_time"], 188300.0);
  EXPECT_EQ(j["energy_balance_error"], 1.5e-5);
  EXPECT_EQ(j["strained"], 2);
  EXPECT_EQ(j["snapped"], 1);
  EXPECT_EQ(j["ever_strained"], 4);
  EXPECT_EQ(j["ever_snapped"], 3);
  EXPECT_EQ(j["bond_steps_per_second"], 13500000.0);
  EXPECT_EQ(j["instruction_set"], "avx2");
  EXPECT_EQ(j["threads"], 4);
  EXPECT_EQ(j["wall_time"]["build"], 0.25);
  EXPECT_EQ(j["wall_time"]["steps"], 2.0);
}

TEST(WallTime, StepsAreSplitInTheSharesOfTheirSample) {
  const auto phases = split_steps(8.0, {.bonds = 3.0, .contacts = 0.0, .integrate = 1.0});
  ASSERT_EQ(phases.size(), 3u);
  EXPECT_EQ(phases[0].name, "bonds");
  EXPECT_EQ(phases[0].seconds, 6.0);
  EXPECT_EQ(phases[1].name, "contacts");
  EXPECT_EQ(phases[1].seconds, 0.0);
  EXPECT_EQ(phases[2].name, "integrate");
  EXPECT_EQ(phases[2].seconds, 2.0);
}

TEST(WallTime, StepsWithoutASampleStayWhole) {
  const auto phases = split_steps(1e-3, {});
  ASSERT_EQ(phases.size(), 1u);
  EXPECT_EQ(phases[0].name, "steps");
  EXPECT_EQ(phases[0].seconds, 1e-3);
}

TEST(RunSummary, RunWithoutAPeakHasNoCriticalForce) {
  RunSummary s = buckling();
  s.stages.pop_back();
  EXPECT_FALSE(nlohmann::json::parse(to_json(s)).contains("critical_force"));
}

TEST(RunSummary, TitleThatIsNotUtf8IsStillValidJson) {
  RunSummary s = buckling();
  s.title = "caf\xe9";
  EXPECT_EQ(nlohmann::json::parse(to_json(s))["title"], "caf\xef\xbf\xbd");
}

TEST(RunSummary, StagesBeforeTheResumedOneReadBack) {
  const Folder folder;
  const RunSummary s = buckling();
  write_summary(folder / "run.json", s);
  EXPECT_TRUE(read_stages_before(folder / "run.json", 0).empty());
  EXPECT_EQ(read_stages_before(folder / "run.json", 1), std::vector<StageSummary>{s.stages[0]});
  EXPECT_EQ(read_stages_before(folder / "run.json", 2), s.stages);
}

TEST(RunSummary, DamagedFileIsAnError) {
  const Folder folder;
  for (const char* text : {"", "{", "[1]", "{\"stages\": [{\"name\": 3}]}"}) {
    put_content(folder / "run.json", text);
    EXPECT_THROW(read_stages_before(folder / "run.json", 1), IoError) << text;
  }
}

}  // namespace
}  // namespace vbond
