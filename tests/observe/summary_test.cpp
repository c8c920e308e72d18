#include "vbond/observe/summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/dispersion_table.hpp"

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
  s.stages = {{"relax", StopReason::duration, 500, 0.01, 5.0, {}, {}, {}, {}},
              {"squeeze", StopReason::peak, 3000000, 0.0628, 188405.0, 3.18e-4, 188300.0, {}, {}}};
  s.energy_balance_error = 1.5e-5;
  s.strained = 2, s.snapped = 1, s.ever_strained = 4, s.ever_snapped = 3;
  s.ever_overlapping = 7, s.ever_stretched = 6, s.too_fast = 1.5;
  s.bond_steps = 27000000;
  s.stepping_seconds = 2.0;
  s.wall_time = {{"build", 0.25}, {"steps", 2.0}};
  return s;
}

TEST(RunSummary, ComesBackWithTheReasonOfAFailure) {
  const Folder folder;
  RunSummary written = buckling();
  written.stages[1].stop = StopReason::diverged;
  written.stages[1].failure = "step 7: particle 2: not finite\n  use a smaller step";
  write_summary(folder / "run.json", written);
  const RunSummary read = read_summary(folder / "run.json");
  EXPECT_EQ(read.stages, written.stages);
  EXPECT_EQ(read.title, written.title);
  EXPECT_EQ(read.bonds, written.bonds);
  EXPECT_EQ(read.ever_snapped, written.ever_snapped);
  EXPECT_EQ(read.ever_overlapping, 7);
  EXPECT_EQ(read.ever_stretched, 6);
  EXPECT_EQ(read.too_fast, 1.5);
  EXPECT_EQ(read.energy_balance_error, written.energy_balance_error);
  put_content(folder / "run.json", "{}");
  EXPECT_THROW(read_summary(folder / "run.json"), IoError);
}

/// A run.json with one stage of each kind, in which `edit` forges something; what reading it says.
template <class Edit>
std::string refusal(Edit edit) {
  const Folder folder;
  RunSummary s = buckling();
  StaticResult r;
  r.ended = "found";
  r.critical_loads.resize(2);
  r.critical_loads[0].force = 1.0;
  r.modes.resize(2);
  r.modes[0].rigid = true;
  for (const StageKind kind : {StageKind::buckling, StageKind::modes}) {
    StageSummary stage;
    stage.name = to_text(kind);
    stage.statics = StaticSummary{kind, r, ""};
    s.stages.push_back(stage);
  }
  auto j = nlohmann::json::parse(to_json(s));
  edit(j, j["stages"]);
  put_content(folder / "run.json", j.dump());
  try {
    read_summary(folder / "run.json");
  } catch (const IoError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(RunSummary, NumbersThatContradictEachOtherAreRefused) {
  using Json = nlohmann::json;
  const auto refused = [](const std::string& text) {
    return text.find("run.json: is not a run.json of vbond: ") != std::string::npos;
  };
  EXPECT_EQ(refusal([](Json&, Json&) {}), "accepted");
  for (const char* list : {"critical_kinds", "critical_gaps", "linear_estimates", "critical_forces"})
    EXPECT_TRUE(refused(refusal([list](Json&, Json& stages) { stages[2][list].push_back(1.0); }))) << list;
  EXPECT_TRUE(refused(refusal([](Json&, Json& stages) { stages[3]["omega_squared"].push_back(1.0); })));
  EXPECT_TRUE(refused(refusal([](Json&, Json& stages) { stages[3]["rigid_modes"] = 4000000000000; })));
  EXPECT_TRUE(refused(refusal([](Json&, Json& stages) { stages[3]["kind"] = "mode"; })));
  EXPECT_TRUE(refused(refusal([](Json&, Json& stages) { stages[3]["points"] = 1e300; })));
  EXPECT_TRUE(refused(refusal([](Json&, Json& stages) { stages[3]["points"] = 3000000000; })));
  EXPECT_TRUE(refused(refusal([](Json&, Json& stages) { stages[0]["steps"] = -1; })));
  EXPECT_TRUE(refused(refusal([](Json&, Json& stages) { stages[0]["stop"] = "peace"; })));
  EXPECT_TRUE(refused(refusal([](Json& j, Json&) { j["particles"] = -1; })));
}

TEST(RunSummary, BreaksAreToldWhereBondsMayBreak) {
  const Folder folder;
  RunSummary s = buckling();
  write_summary(folder / "run.json", s);
  for (const char* key : {"broken", "first_break_time", "first_break_load", "peak_load"})
    EXPECT_EQ(content_of(folder / "run.json").find(key), std::string::npos) << key;
  EXPECT_FALSE(read_summary(folder / "run.json").breaks);
  s.breaks = BreakSummary{3, {0.25, 7.5, 8.0}, 9.5};
  s.stages[1].stop = StopReason::breaks;
  write_summary(folder / "run.json", s);
  const auto j = nlohmann::json::parse(content_of(folder / "run.json"));
  EXPECT_EQ(j["broken"], 3);
  EXPECT_EQ(j["first_break_time"], 0.25);
  EXPECT_EQ(j["first_break_load"], 7.5);
  EXPECT_EQ(j["peak_load"], 9.5);
  EXPECT_EQ(j["stages"][1]["stop"], "breaks");
  const RunSummary read = read_summary(folder / "run.json");
  ASSERT_TRUE(read.breaks);
  EXPECT_EQ(read.breaks->broken, 3);
  EXPECT_EQ(read.breaks->first.first_load, 7.5);
  EXPECT_EQ(read.breaks->peak_load, 9.5);
  EXPECT_EQ(read.stages, s.stages);
}

TEST(RunSummary, WallsAreToldWhereThereAreAny) {
  const Folder folder;
  RunSummary s = buckling();
  EXPECT_FALSE(nlohmann::json::parse(to_json(s)).contains("walls"));
  s.walls = {{"lid", {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 0.5, 10.0}, {"floor", {}, {}, {}, 0, 0}};
  write_summary(folder / "run.json", s);
  const auto j = nlohmann::json::parse(content_of(folder / "run.json"));
  ASSERT_EQ(j["walls"].size(), 2u);
  EXPECT_EQ(j["walls"][0]["moment"], (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(j["walls"][0]["largest_force"], 10.0);
  EXPECT_EQ(read_summary(folder / "run.json").walls, s.walls);
}

TEST(RunSummary, TheCellIsToldOfPeriodicBodies) {
  const Folder folder;
  RunSummary s = buckling();
  EXPECT_FALSE(nlohmann::json::parse(to_json(s)).contains("cell"));
  s.cell = CellSummary{{Vec3d{2, 0, 0}, {1, 3, 0}, {0, 0, 4}},
                       {24.0, 0.5, {1, 2, 3, 4, 5, 6}, {7, 8, 9, 10, 11, 12}}};
  write_summary(folder / "run.json", s);
  const auto j = nlohmann::json::parse(content_of(folder / "run.json"));
  EXPECT_EQ(j["cell"]["b"], (std::vector<double>{1, 3, 0}));
  EXPECT_EQ(j["cell"]["strain"]["xz"], 5.0);
  EXPECT_EQ(j["cell"]["stress"]["xy"], 12.0);
  EXPECT_EQ(read_summary(folder / "run.json").cell, s.cell);
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
  EXPECT_EQ(j["ever_overlapping"], 7);
  EXPECT_EQ(j["ever_stretched"], 6);
  EXPECT_EQ(j["too_fast"], 1.5);
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

TEST(WallTime, SettingUpAnewIsNoneOfTheSteps) {
  const auto phases = split_steps(9.0, {.bonds = 3.0, .contacts = 0.0, .integrate = 1.0, .anew = 1.0});
  ASSERT_EQ(phases.size(), 4u);
  EXPECT_EQ(phases[0].seconds, 6.0);
  EXPECT_EQ(phases[2].seconds, 2.0);
  EXPECT_EQ(phases[3].name, "set_up_anew");
  EXPECT_EQ(phases[3].seconds, 1.0);
  const auto short_run = split_steps(1.0, {.anew = 0.25});
  ASSERT_EQ(short_run.size(), 2u);
  EXPECT_EQ(short_run[0].seconds, 0.75);
  EXPECT_EQ(short_run[1].seconds, 0.25);
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

StaticSummary statics(StageKind kind) {
  StaticSummary s;
  s.kind = kind;
  s.result.ended = "converged";
  s.result.load_factor = 0.75;
  s.result.points = 12;
  s.result.iterations = 34;
  s.result.solver = "direct";
  s.result.unstable = 1;
  s.result.smallest_eigenvalue = -1.0 / 3.0;
  return s;
}

RunSummary all_kinds() {
  RunSummary s = buckling();
  s.stages.clear();
  StaticSummary equilibrium = statics(StageKind::equilibrium), path = statics(StageKind::path),
                critical = statics(StageKind::buckling), modes = statics(StageKind::modes),
                failed = statics(StageKind::modes), fracture = statics(StageKind::fracture);
  equilibrium.result.left_saddle = equilibrium.result.jumped = equilibrium.result.neutral = true;
  equilibrium.result.free_turns = 6;
  path.result.special_points = {{PointKind::bifurcation, 0.25, 3, 0, 1, 1e-7},
                                {PointKind::limit_point, 0.5, 4, 1, 2, 0.0},
                                {PointKind::bifurcation, 0.3, 7, 2, 1, 0.0}};
  critical.result.critical_loads = {{PointKind::bifurcation, 3.1e-4, 3.0e-4, 6.2e-4, {}, 1e-9},
                                    {PointKind::limit_point, 1.2e-3, {}, 2.4e-3, {}, 0.0}};
  for (CriticalLoad& c : critical.result.critical_loads)
    c.displacement = 0.5 * c.load_factor, c.reaction = 2.0 * c.load_factor;
  critical.result.searched_to = 1.2e-3;
  modes.result.modes = {{0, 0, true, {}}, {0, -4.0, false, {}}, {1.5, 2.25, false, {}}};
  path.result.most_used = BondUse{BondId{7}, ParticleId{3}, ParticleId{4}, 1.25, 0.5};
  BrokenBond broken{3,
                    1,
                    *path.result.most_used,
                    {0.1, 0.2, 0.3, 0.4, 0.5},
                    {1, 2, 3, 4},
                    {5, 6, 7},
                    {0, 0, 1},
                    8.5,
                    0.5,
                    7.5,
                    0.05,
                    0.1,
                    0.2,
                    0.3};
  FractureResult& f = fracture.result.fracture;
  f.breaks = {broken, broken};
  f.breaks[1].load_factor_after.reset();
  f.breaks[1].load_after.reset();
  f.reason = "it has parted";
  f.avalanches = 1, f.largest_avalanche = 2, f.peak_load = 8.5, f.peak_load_factor = 0.5,
  f.released_parts = 1;
  f.books = {0.1, 0.2, 0.3, 0.05, 0.0, 0.4};
  failed.result = {};
  failed.result.ended = "failed";
  failed.failure = "stage \"shake\": nothing to shake";
  for (const StaticSummary& x : {equilibrium, path, critical, modes, failed, fracture}) {
    StageSummary stage;
    stage.name = "stage " + std::to_string(s.stages.size());
    stage.time = 7.5;
    stage.statics = x;
    s.stages.push_back(stage);
  }
  return s;
}

TEST(RunSummary, WavesComeBackWithTheirModes) {
  const Folder folder;
  RunSummary s = buckling();
  s.stages.clear();
  StaticResult r;
  r.ended = "converged";
  r.waves = {{{0, 0, 0}, {0, 0, 0}}, {{0.5, 0, 1}, {0.25, 0, 0.125}}};
  r.modes = {
      {0, 0, true, {}, 1}, {0.5, 0.25, false, {}, 1}, {0, -1.0, false, {}, 2}, {2.0, 4.0, false, {}, 2}};
  StageSummary modes;
  modes.name = "free, or not";
  modes.statics = StaticSummary{StageKind::modes, r, ""};
  StageSummary critical = modes;
  critical.statics->kind = StageKind::buckling;
  critical.statics->result.modes.clear();
  critical.statics->result.critical_loads.resize(1);
  critical.statics->result.critical_loads[0].wave = 2;
  s.stages = {modes, critical};
  write_summary(folder / "run.json", s);
  const RunSummary back = read_summary(folder / "run.json");
  ASSERT_EQ(back.stages.size(), 2u);
  EXPECT_EQ(back.stages[0].statics->result.waves, r.waves);
  EXPECT_EQ(back.stages[0].statics->result.modes, r.modes);
  EXPECT_EQ(back.stages[1].statics->result.critical_loads[0].wave, 2);
  EXPECT_EQ(back.stages[1].statics->result.waves, r.waves);
  const std::string table = dispersion_table(s);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
  EXPECT_NE(table.find("\n\"free, or not\",2,0.5,0,1,0.25,0,0.125,2,0,2,"), std::string::npos) << table;
  critical.statics->result.critical_loads[0].wave = 3;
  s.stages = {critical};
  write_summary(folder / "run.json", s);
  EXPECT_THROW(read_summary(folder / "run.json"), IoError);
}

TEST(RunSummary, StaticStagesHoldTheirResultsByKind) {
  const auto j = nlohmann::json::parse(to_json(all_kinds()));
  const auto& equilibrium = j["stages"][0];
  EXPECT_EQ(equilibrium["name"], "stage 0");
  EXPECT_EQ(equilibrium["kind"], "equilibrium");
  EXPECT_EQ(equilibrium["ended"], "converged");
  EXPECT_EQ(equilibrium["load_factor"], 0.75);
  EXPECT_EQ(equilibrium["points"], 12);
  EXPECT_EQ(equilibrium["iterations"], 34);
  EXPECT_EQ(equilibrium["solver"], "direct");
  EXPECT_EQ(equilibrium["unstable"], 1);
  EXPECT_EQ(equilibrium["left_saddle"], true);
  EXPECT_EQ(equilibrium["free_turns"], 6);
  EXPECT_EQ(equilibrium["smallest_eigenvalue"], -1.0 / 3.0);
  EXPECT_EQ(equilibrium["time"], 7.5);
  EXPECT_FALSE(equilibrium.contains("stop"));
  EXPECT_FALSE(equilibrium.contains("frequencies"));
  const auto& path = j["stages"][1];
  ASSERT_EQ(path["bifurcations"].size(), 2u);
  EXPECT_EQ(path["bifurcations"][1]["load_factor"], 0.3);
  EXPECT_EQ(path["bifurcations"][1]["point"], 7);
  EXPECT_EQ(path["limit_points"][0]["unstable_before"], 1);
  EXPECT_EQ(path["limit_points"][0]["unstable_after"], 2);
  const auto& critical = j["stages"][2];
  EXPECT_EQ(critical["critical_load_factors"], (std::vector<double>{3.1e-4, 1.2e-3}));
  EXPECT_EQ(critical["critical_kinds"], (std::vector<std::string>{"bifurcation", "limit point"}));
  EXPECT_EQ(critical["linear_estimates"][0], 3.0e-4);
  EXPECT_TRUE(critical["linear_estimates"][1].is_null());
  EXPECT_EQ(critical["critical_gaps"], (std::vector<double>{1e-9, 0.0}));
  EXPECT_EQ(critical["searched_to"], 1.2e-3);
  EXPECT_EQ(critical["critical_forces"], (std::vector<double>{6.2e-4, 2.4e-3}));
  const auto& modes = j["stages"][3];
  EXPECT_EQ(modes["rigid_modes"], 1);
  EXPECT_EQ(modes["omega"], (std::vector<double>{0.0, 1.5}));
  EXPECT_EQ(modes["omega_squared"], (std::vector<double>{-4.0, 2.25}));
  EXPECT_EQ(modes["frequencies"][1].get<double>(), 1.5 / (2 * std::numbers::pi));
  EXPECT_EQ(j["stages"][4]["failure"], "stage \"shake\": nothing to shake");
  // of the run: what the last stage that has any found, not the one that failed
  EXPECT_EQ(j["critical_forces"], critical["critical_forces"]);
  EXPECT_EQ(j["frequencies"], modes["frequencies"]);
}

TEST(RunSummary, CriticalLoadsWithoutAForceAreFactorsOnly) {
  RunSummary s = all_kinds();
  for (CriticalLoad& c : s.stages[2].statics->result.critical_loads) c.force = 0.0;
  const auto j = nlohmann::json::parse(to_json(s));
  EXPECT_FALSE(j["stages"][2].contains("critical_forces"));
  EXPECT_FALSE(j.contains("critical_forces"));
}

TEST(RunSummary, StaticStagesReadBack) {
  const Folder folder;
  const RunSummary s = all_kinds();
  write_summary(folder / "run.json", s);
  EXPECT_EQ(read_stages_before(folder / "run.json", 6), s.stages);
}

}  // namespace
}  // namespace vbond
