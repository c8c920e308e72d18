#include "vbond/observe/history.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/statics/point_view.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::lines_of;
using test::put_content;

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> out;
  std::stringstream in(line + ',');  // or an empty cell at the end would be lost
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
  return out;
}

/// Its cell under that name.
std::string cell(const std::vector<std::string>& lines, std::size_t row, const std::string& name) {
  const auto names = cells(lines.at(0)), values = cells(lines.at(row));
  EXPECT_EQ(names.size(), values.size());
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return values.at(k);
  return "no column " + name;
}

OutputPlan plan_in(const Folder& folder) {
  OutputPlan plan;
  plan.folder = folder.path();
  plan.history_every = 1.0;
  plan.reactions = {{"left", {ParticleId{0}}}};
  plan.axial_force = {{"all", {ParticleId{0}, ParticleId{1}, ParticleId{2}}}};
  plan.displacements = {{"2", {ParticleId{2}}}};
  return plan;
}

HistoryValues some_values() {
  HistoryValues v;
  v.clock.dt = 0.1;  // not a binary number: times are not round
  v.books = {.at_start = 9, .dissipated = 0.7, .work_loads = 0.8, .work_supports = 0.9, .largest = 9};
  v.energies = {1.0 / 3.0, 0.25, 1e-5, 2e-6, 3e-300, 0.125};
  v.balance_error = -2e-4;
  v.bonds = 12;
  v.ranges = {4, 1};
  v.peak_average = 3.0e-4 / 7.0;
  v.reactions = {{{1.5, 2.5, 3.5}, {4.5, 5.5, 6.5}}};
  v.axial_force = {-3.19e-4};
  v.displacements = {Vec3d{0.1, 0.2, 0.3}};
  return v;
}

void write_rows(HistoryWriter& writer, const std::vector<std::int64_t>& steps) {
  HistoryValues v = some_values();
  for (const std::int64_t step : steps) {
    v.clock.step = v.clock.stage_step = step;
    writer.write(v);
  }
}

TEST(History, HasStressesStrainsAndLossesThatThePlanAsksFor) {
  const Folder folder;
  OutputPlan plan = plan_in(folder);
  plan.stresses = {{{"core", {ParticleId{1}}}, 2.0}};
  plan.losses = {Loss::yield_bending, Loss::friction};
  HistoryValues v = some_values();
  v.stresses = {{1, 2, 3, 4, 5, 6}};
  v.strains = {{7, 8, 9, 10, std::nan(""), 12}};
  v.losses = {0.25, 0.5};
  HistoryWriter(plan, {}).write(v);
  const auto lines = lines_of(content_of(folder / "history.csv"));
  EXPECT_EQ(cell(lines, 1, "stress.core.xx"), "1");
  EXPECT_EQ(cell(lines, 1, "stress.core.xy"), "6");
  EXPECT_EQ(cell(lines, 1, "strain.core.yy"), "8");
  EXPECT_EQ(cell(lines, 1, "strain.core.zx"), "");  // a body in one plane has none
  EXPECT_EQ(cell(lines, 1, "dissipated.yield_bending"), "0.25");
  EXPECT_EQ(cell(lines, 1, "dissipated.friction"), "0.5");
}

TEST(History, WallsHaveColumnsAndTheirLargestForceGoesOn) {
  const Folder folder;
  OutputPlan plan = plan_in(folder);
  plan.walls = {"lid", "floor"};
  HistoryValues v = some_values();
  v.walls.resize(2);
  v.walls[0].force = {3, 0, -4}, v.walls[0].moment = {5, 6, 7}, v.walls[0].displacement = {8, 9, 10};
  v.walls[0].work = 0.25, v.walls[1].force = {0, 0, -1};
  {
    HistoryWriter writer(plan, {});
    writer.write(v);
    v.clock.step = v.clock.stage_step = 1, v.walls[0].force = {0, 0, -1};
    writer.write(v);
    v.clock.step = v.clock.stage_step = 2, v.walls.clear();  // not known
    writer.write(v);
    EXPECT_EQ(writer.largest_on_walls(), (std::vector<double>{5, 1}));
  }
  const auto lines = lines_of(content_of(folder / "history.csv"));
  ASSERT_EQ(lines.size(), 4u);
  const std::string names =
      "wall.lid.Fx,wall.lid.Fy,wall.lid.Fz,wall.lid.Mx,wall.lid.My,wall.lid.Mz,"
      "wall.lid.x,wall.lid.y,wall.lid.z,wall.lid.work,wall.floor.Fx";
  EXPECT_NE(lines[0].find(names), std::string::npos) << lines[0];
  const auto row = cells(lines[1]);
  EXPECT_EQ(std::vector<std::string>(row.end() - 20, row.end() - 10),
            (std::vector<std::string>{"3", "0", "-4", "5", "6", "7", "8", "9", "10", "0.25"}));
  EXPECT_EQ(cell(lines, 3, "wall.floor.work"), "");
  const HistoryWriter resumed(plan, 2);
  EXPECT_EQ(resumed.largest_on_walls(), (std::vector<double>{5, 1}));
}

TEST(History, GripsHaveColumnsThatAreEmptyWhereTheyAreNot) {
  const Folder folder;
  OutputPlan plan = plan_in(folder);
  plan.grips = {"upper", "lower"};
  HistoryValues v = some_values();
  v.grips = {GripView{"upper", {1, 2, 3}, {4, 5, 6}, 7, 8}, std::nullopt};
  {
    HistoryWriter writer(plan, {});
    writer.write(v);
    v.clock.step = v.clock.stage_step = 1;
    v.grips = {std::nullopt, GripView{"lower", {}, {0, 0, -1}, 0.5, {}}};  // at rest work is not known
    writer.write(v);
  }
  const auto lines = lines_of(content_of(folder / "history.csv"));
  ASSERT_EQ(lines.size(), 3u);
  const auto row = cells(lines[1]);
  EXPECT_EQ(
      std::vector<std::string>(row.end() - 16, row.end()),
      (std::vector<std::string>{"1", "2", "3", "4", "5", "6", "7", "8", "", "", "", "", "", "", "", ""}));
  EXPECT_EQ(cell(lines, 1, "grip.upper.angle"), "7");
  EXPECT_EQ(cell(lines, 2, "grip.upper.Fx"), "");
  EXPECT_EQ(cell(lines, 2, "grip.lower.Mz"), "-1");
  EXPECT_EQ(cell(lines, 2, "grip.lower.work"), "");
}

TEST(History, EveryValueStandsUnderItsNameAndReadsBackBitForBit) {
  const Folder folder;
  HistoryWriter writer(plan_in(folder), {});
  write_rows(writer, {1200});

  const auto lines = lines_of(content_of(folder / "history.csv"));
  ASSERT_EQ(lines.size(), 2u);
  const auto names = cells(lines[0]), row = cells(lines[1]);
  ASSERT_EQ(names.size(), row.size());
  const auto value = [&](const std::string& name) {
    for (std::size_t k = 0; k < names.size(); ++k)
      if (names[k] == name) return std::strtod(row[k].c_str(), nullptr);
    ADD_FAILURE() << "no column " << name;
    return 0.0;
  };
  const HistoryValues v = some_values();
  EXPECT_EQ(value("step"), 1200);
  EXPECT_EQ(value("time"), 1200 * 0.1);
  EXPECT_EQ(value("kinetic_translation"), v.energies.kinetic_translation);
  EXPECT_EQ(value("kinetic_rotation"), v.energies.kinetic_rotation);
  EXPECT_EQ(value("U_L"), v.energies.U_L);
  EXPECT_EQ(value("U_B"), v.energies.U_B);
  EXPECT_EQ(value("U_T"), v.energies.U_T);
  EXPECT_EQ(value("contact"), v.energies.contact);
  EXPECT_EQ(value("dissipated"), 0.7);
  EXPECT_EQ(value("work_loads"), 0.8);
  EXPECT_EQ(value("work_supports"), 0.9);
  EXPECT_EQ(value("total"), v.energies.total());
  EXPECT_EQ(value("balance_error"), v.balance_error);
  EXPECT_EQ(value("bonds"), 12);
  EXPECT_EQ(value("strained"), 4);
  EXPECT_EQ(value("snapped"), 1);
  EXPECT_EQ(value("peak_average"), 3.0e-4 / 7.0);
  EXPECT_EQ(value("reaction.left.fx"), 1.5);
  EXPECT_EQ(value("reaction.left.mz"), 6.5);
  EXPECT_EQ(value("axial_force.all"), -3.19e-4);
  EXPECT_EQ(value("displacement.2.x"), 0.1);
  EXPECT_EQ(value("displacement.2.y"), 0.2);
  EXPECT_EQ(value("displacement.2.z"), 0.3);
}

TEST(History, ValuesAreThoseOfTheRun) {
  const Folder folder;
  Chain chain;
  chain.state.r[ParticleId{1}] += Vec3d{0.1, 0.2, 0.3};
  chain.turn(2, {1, 0, 0}, 1.8);  // 103 degrees: past the limit of the EVM, the law of the second bond
  chain.state.books.work_loads = 0.8;
  chain.state.peak.last = 0.7;
  OutputPlan plan = plan_in(folder);
  plan.displacements = {{"1 and 2", {ParticleId{1}, ParticleId{2}}}};
  Stage stage;
  stage.dt = 0.1;
  stage.supports = {{"left", {ParticleId{0}}, {true, true, true, true, true, true}, {}, {}, {}}};
  const Simulation run(chain.model, stage, chain.state);
  const HistoryValues v = history_values(plan, run);
  EXPECT_TRUE(v.clock == run.clock());
  EXPECT_TRUE(v.books == chain.state.books);
  EXPECT_EQ(v.energies.total(), run.energies().total());
  EXPECT_EQ(v.balance_error, run.balance_error());
  EXPECT_EQ(v.bonds, 2);
  EXPECT_EQ(v.ranges, (RangeCounts{1, 0}));
  EXPECT_EQ(v.peak_average, 0.7);
  ASSERT_EQ(v.reactions.size(), 1u);
  EXPECT_EQ(v.reactions[0].force, run.reaction({ParticleId{0}}).force);
  EXPECT_NE(v.reactions[0].force.y, 0.0);
  ASSERT_EQ(v.axial_force.size(), 1u);
  EXPECT_EQ(v.axial_force[0], mean_axial_force(run.part(), plan.axial_force[0].particles));
  EXPECT_NE(v.axial_force[0], 0.0);
  ASSERT_EQ(v.displacements.size(), 1u);
  const Vec3d moved = chain.state.r[ParticleId{1}] - chain.model.r_0[ParticleId{1}];  // the other one stays
  EXPECT_EQ(v.displacements[0], moved / 2.0);
}

TEST(History, HasVelocitiesOfGroupsWhereThereAreAny) {
  const Folder folder;
  Chain chain;
  OutputPlan plan = plan_in(folder);
  plan.velocities = {{"1 and 2", {ParticleId{1}, ParticleId{2}}}, {"0", {ParticleId{0}}}};
  Stage stage;
  stage.dt = 0.1;
  const Simulation run(chain.model, stage, chain.state);
  HistoryValues v = history_values(plan, run);
  ASSERT_EQ(v.velocities.size(), 2u);
  EXPECT_EQ(v.velocities[0], (chain.state.v[ParticleId{1}] + chain.state.v[ParticleId{2}]) / 2.0);
  EXPECT_EQ(v.velocities[1], chain.state.v[ParticleId{0}]);
  const StaticPoint point{chain.state, 0.75,       PointKind::limit_point,
                          1,           Energies{}, [](const std::vector<ParticleId>&) { return Reaction{}; }};
  const HistoryValues at_rest = history_values(plan, PointView(chain.model, point));
  EXPECT_TRUE(at_rest.velocities.empty());
  HistoryWriter writer(plan, {});
  writer.write(v);
  HistoryValues next = at_rest;
  next.clock.step = v.clock.step + 1;
  writer.write(next);
  const auto lines = lines_of(content_of(folder / "history.csv"));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(std::stod(cell(lines, 1, "velocity.1 and 2.x")), v.velocities[0]->x);
  EXPECT_EQ(std::stod(cell(lines, 1, "velocity.0.z")), v.velocities[1]->z);
  EXPECT_EQ(cell(lines, 2, "velocity.1 and 2.x"), "");
  EXPECT_EQ(cell(lines, 2, "velocity.0.z"), "");
}

TEST(History, ContinuedFileEqualsTheUninterruptedOne) {
  const Folder folder;
  std::string undisturbed;
  {
    HistoryWriter writer(plan_in(folder), {});
    write_rows(writer, {0, 10, 20, 30, 40});
    undisturbed = content_of(folder / "history.csv");
  }
  {  // killed at step 34, in the middle of a line, with its last checkpoint at step 25
    HistoryWriter writer(plan_in(folder), {});
    write_rows(writer, {0, 10, 20, 30});
  }
  put_content(folder / "history.csv", content_of(folder / "history.csv") + "2");
  HistoryWriter writer(plan_in(folder), 25);
  EXPECT_EQ(writer.last_step(), 20);
  EXPECT_EQ(writer.largest_balance_error(), 2e-4);
  write_rows(writer, {30, 40});
  EXPECT_EQ(content_of(folder / "history.csv"), undisturbed);
}

TEST(History, RowAtTheCheckpointIsKept) {
  const Folder folder;
  {
    HistoryWriter writer(plan_in(folder), {});
    write_rows(writer, {0, 10, 20});
  }
  const std::string before = content_of(folder / "history.csv");
  EXPECT_EQ(HistoryWriter(plan_in(folder), 20).last_step(), 20);
  EXPECT_EQ(content_of(folder / "history.csv"), before);
}

TEST(History, FileOfAnotherKindIsNotContinued) {
  const Folder folder;
  put_content(folder / "history.csv", "step,time\n0,0\n");
  EXPECT_THROW(HistoryWriter(plan_in(folder), 0), IoError);
  put_content(folder / "history.csv", "");
  EXPECT_THROW(HistoryWriter(plan_in(folder), 0), IoError);
  put_content(folder / "history.csv", history_header(plan_in(folder)) + "zero,1\n");
  EXPECT_THROW(HistoryWriter(plan_in(folder), 0), IoError);
}

// Columns of an edited case: what was there stays as it is, cell by cell.
TEST(History, EditedColumnsAreAddedBehindAndLeftEmpty) {
  const Folder folder;
  {
    HistoryWriter writer(plan_in(folder), {});
    write_rows(writer, {0, 10, 20, 30});
  }
  const auto before = lines_of(content_of(folder / "history.csv"));
  OutputPlan other = plan_in(folder);
  other.reactions.clear();
  other.axial_force = {{"a\"b", {ParticleId{0}}}};
  other.statics = true;
  HistoryValues values = some_values();
  values.reactions.clear();
  values.axial_force = {7.5};
  values.load_factor = 0.25;
  values.clock.step = 25;
  {
    HistoryWriter writer(other, 20);
    EXPECT_EQ(writer.last_step(), 20);
    EXPECT_EQ(writer.largest_balance_error(), 2e-4);
    writer.write(values);
  }
  auto lines = lines_of(content_of(folder / "history.csv"));
  ASSERT_EQ(lines.size(), 1u + 3 + 1);
  EXPECT_EQ(lines[0], before[0] + ",load_factor,unstable,\"axial_force.a\"\"b\"");
  for (std::size_t row = 1; row < 4; ++row) EXPECT_EQ(lines[row], before[row] + ",,,");
  EXPECT_EQ(cell(lines, 4, "reaction.left.fx"), "");
  EXPECT_EQ(cell(lines, 4, "axial_force.all"), "");
  EXPECT_EQ(cell(lines, 4, "displacement.2.z"), cell(before, 1, "displacement.2.z"));
  EXPECT_EQ(cell(lines, 4, "load_factor"), "0.25");
  EXPECT_EQ(lines[4].substr(lines[4].size() - 10), ",0.25,,7.5");

  HistoryWriter back(plan_in(folder), 20);  // the first edit undone: nothing is lost, nor added
  values = some_values();
  values.clock.step = 22;
  back.write(values);
  lines = lines_of(content_of(folder / "history.csv"));
  ASSERT_EQ(lines.size(), 1u + 3 + 1);
  EXPECT_EQ(lines[4].substr(lines[4].size() - 3), ",,,");
  EXPECT_EQ(cell(lines, 4, "reaction.left.fx"), "1.5");
}

TEST(History, MissingFileIsBegunAnew) {
  const Folder folder;
  HistoryWriter writer(plan_in(folder), 20);
  EXPECT_TRUE(writer.begun_anew());
  write_rows(writer, {30});
  EXPECT_EQ(lines_of(content_of(folder / "history.csv")).size(), 2u);
  EXPECT_FALSE(HistoryWriter(plan_in(folder), 30).begun_anew());
}

TEST(History, RemovedFileEndsTheRun) {
  const Folder folder;
  HistoryWriter writer(plan_in(folder), {});
  write_rows(writer, {0});
  std::filesystem::remove(folder / "history.csv");
  EXPECT_THROW(write_rows(writer, {10}), IoError);
}

TEST(History, MissingFolderIsAnErrorThatNamesTheFile) {
  const Folder folder;
  OutputPlan plan = plan_in(folder);
  plan.folder = folder / "nowhere";
  try {
    HistoryWriter writer(plan, {});
    FAIL() << "no error";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("nowhere/history.csv"), std::string::npos) << e.what();
  }
}

TEST(History, GroupNameWithACommaDoesNotShiftTheColumns) {
  const Folder folder;
  OutputPlan plan = plan_in(folder);
  plan.axial_force[0].name = "a,\"b\"";
  EXPECT_NE(history_header(plan).find(",\"axial_force.a,\"\"b\"\"\","), std::string::npos)
      << history_header(plan);
}

TEST(History, StaticColumnsStandInCasesWithStaticStagesAlone) {
  const Folder folder;
  OutputPlan plan = plan_in(folder);
  EXPECT_EQ(history_header(plan).find("load_factor"), std::string::npos);
  plan.statics = true;
  HistoryValues dynamics = some_values(), counted = some_values(), uncounted = some_values();
  counted.load_factor = 1.0 / 3.0;
  counted.unstable = 2;
  uncounted.load_factor = -0.5;
  {
    HistoryWriter writer(plan, {});
    for (HistoryValues* v : {&dynamics, &counted, &uncounted}) {
      writer.write(*v);
      v->clock.step = 3;
    }
  }
  const auto lines = lines_of(content_of(folder / "history.csv"));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(cell(lines, 1, "load_factor"), "");
  EXPECT_EQ(cell(lines, 1, "unstable"), "");
  EXPECT_EQ(std::strtod(cell(lines, 2, "load_factor").c_str(), nullptr), 1.0 / 3.0);
  EXPECT_EQ(cell(lines, 2, "unstable"), "2");
  EXPECT_EQ(cell(lines, 3, "load_factor"), "-0.5");
  EXPECT_EQ(cell(lines, 3, "unstable"), "");
  EXPECT_EQ(cell(lines, 3, "reaction.left.fx"), "1.5");  // those behind keep their place
  EXPECT_EQ(HistoryWriter(plan, 0).last_step(), 0);      // and it can be continued
}

TEST(History, ValuesOfAStaticPointAreThoseOfItsState) {
  const Folder folder;
  Chain chain;
  chain.state.r[ParticleId{1}] += Vec3d{0.1, 0.2, 0.3};
  chain.turn(2, {1, 0, 0}, 1.8);  // 103 degrees: past the limit of the EVM, the law of the second bond
  chain.state.books.work_loads = 0.8;
  const OutputPlan plan = plan_in(folder);
  Stage stage;
  stage.dt = 0.1;
  const Simulation same(chain.model, stage, chain.state);
  const Energies energies{0, 0, 0.5, 0.25, 0.125, 0};
  const auto reaction = [](const std::vector<ParticleId>& p) {
    return Reaction{{static_cast<double>(p.size()), 2, 3}, {4, 5, 6}};
  };
  const StaticPoint point{chain.state, 0.75, PointKind::limit_point, 1, energies, reaction};
  const HistoryValues v = history_values(plan, PointView(chain.model, point));
  EXPECT_TRUE(v.clock == chain.state.clock);
  EXPECT_EQ(v.books, (EnergyBooks{.at_start = 0.875}));
  EXPECT_EQ(v.energies.total(), 0.875);
  EXPECT_EQ(v.balance_error, 0.0);
  EXPECT_EQ(v.bonds, 2);
  EXPECT_EQ(v.ranges, (RangeCounts{1, 0}));
  EXPECT_EQ(v.load_factor, 0.75);
  EXPECT_EQ(v.unstable, 1);
  ASSERT_EQ(v.reactions.size(), 1u);
  EXPECT_EQ(v.reactions[0].force, (Vec3d{1, 2, 3}));
  ASSERT_EQ(v.axial_force.size(), 1u);
  EXPECT_EQ(v.axial_force[0], mean_axial_force(same.part(), plan.axial_force[0].particles));
  EXPECT_NE(v.axial_force[0], 0.0);
  ASSERT_EQ(v.displacements.size(), 1u);
  EXPECT_EQ(v.displacements[0], chain.state.r[ParticleId{2}] - chain.model.r_0[ParticleId{2}]);
}

}  // namespace
}  // namespace vbond
