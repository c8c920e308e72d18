#include "vbond/observe/history.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "specimen.hpp"
#include "vbond/core/error.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::lines_of;
using test::put_content;

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> out;
  std::stringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
  return out;
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
  v.energies = {1.0 / 3.0, 0.25, 1e-5, 2e-6, 3e-300, 0.125};
  v.balance_error = -2e-4;
  v.ranges = {4, 1};
  v.reactions = {{{1.5, 2.5, 3.5}, {4.5, 5.5, 6.5}}};
  v.axial_force = {-3.19e-4};
  return v;
}

void write_rows(HistoryWriter& writer, Chain& chain, std::vector<std::int64_t> steps) {
  for (const std::int64_t step : steps) {
    chain.at_step(step);
    writer.write(chain.model, chain.state, some_values());
  }
}

TEST(History, EveryValueStandsUnderItsNameAndReadsBackBitForBit) {
  const Folder folder;
  Chain chain;
  chain.state.r[ParticleId{2}] += Vec3d{0.1, 0.2, 0.3};
  chain.state.books = {
      .at_start = 9, .dissipated = 0.7, .work_loads = 0.8, .work_supports = 0.9, .largest = 9};
  chain.state.peak.last = 3.0e-4 / 7.0;
  HistoryWriter writer(plan_in(folder), {});
  write_rows(writer, chain, {1200});

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
  EXPECT_EQ(value("bonds"), 2);
  EXPECT_EQ(value("strained"), 4);
  EXPECT_EQ(value("snapped"), 1);
  EXPECT_EQ(value("peak_average"), 3.0e-4 / 7.0);
  EXPECT_EQ(value("reaction.left.fx"), 1.5);
  EXPECT_EQ(value("reaction.left.mz"), 6.5);
  EXPECT_EQ(value("axial_force.all"), -3.19e-4);
  const Vec3d moved = chain.state.r[ParticleId{2}] - chain.model.r_0[ParticleId{2}];
  EXPECT_EQ(value("displacement.2.x"), moved.x);
  EXPECT_EQ(value("displacement.2.y"), moved.y);
  EXPECT_EQ(value("displacement.2.z"), moved.z);
}

TEST(History, ContinuedFileEqualsTheUninterruptedOne) {
  const Folder folder;
  Chain chain;
  std::string undisturbed;
  {
    HistoryWriter writer(plan_in(folder), {});
    write_rows(writer, chain, {0, 10, 20, 30, 40});
    undisturbed = content_of(folder / "history.csv");
  }
  {  // killed at step 34, in the middle of a line, with its last checkpoint at step 25
    HistoryWriter writer(plan_in(folder), {});
    write_rows(writer, chain, {0, 10, 20, 30});
  }
  put_content(folder / "history.csv", content_of(folder / "history.csv") + "2");
  HistoryWriter writer(plan_in(folder), 25);
  EXPECT_EQ(writer.last_step(), 20);
  EXPECT_EQ(writer.largest_balance_error(), 2e-4);
  write_rows(writer, chain, {30, 40});
  EXPECT_EQ(content_of(folder / "history.csv"), undisturbed);
}

TEST(History, RowAtTheCheckpointIsKept) {
  const Folder folder;
  Chain chain;
  {
    HistoryWriter writer(plan_in(folder), {});
    write_rows(writer, chain, {0, 10, 20});
  }
  const std::string before = content_of(folder / "history.csv");
  EXPECT_EQ(HistoryWriter(plan_in(folder), 20).last_step(), 20);
  EXPECT_EQ(content_of(folder / "history.csv"), before);
}

TEST(History, FileOfAnotherCaseIsNotContinued) {
  const Folder folder;
  { HistoryWriter writer(plan_in(folder), {}); }
  OutputPlan other = plan_in(folder);
  other.displacements.push_back({"1", {ParticleId{1}}});
  EXPECT_THROW(HistoryWriter(other, 0), IoError);
  put_content(folder / "history.csv", history_header(plan_in(folder)) + "zero,1\n");
  EXPECT_THROW(HistoryWriter(plan_in(folder), 0), IoError);
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

}  // namespace
}  // namespace vbond
