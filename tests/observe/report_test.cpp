#include "vbond/observe/table_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "specimen.hpp"

namespace vbond {
namespace {

TEST(Table, RowsAreAsWideAsTheHeaderForSmallAndLargeValues) {
  test::Chain chain;
  const std::size_t width = table_header().size();
  EXPECT_EQ(table_row(chain.state.clock, {}, {}, 0.0, {}).size(), width);
  EnergyBooks books;
  books.work_loads = -1.23456789e-123;
  const Energies energies{-1e-300, 0, -1e300, 0, 0, 0};
  EXPECT_EQ(table_row(chain.state.clock, books, energies, -1e-100, {99999999, 99999999}).size(), width);
}

TEST(Table, StageGivesAtMost25RowsAndTheEnd) {
  for (const std::int64_t steps : {1, 2, 23, 24, 25, 47, 1000, 1000000007}) {
    const std::int64_t rows = steps / table_interval(steps) + 1;  // the first row and every interval
    EXPECT_LE(rows, 25) << steps;
    EXPECT_GE(rows, std::min<std::int64_t>(steps + 1, 13)) << steps;  // rounding up may halve the number
  }
}

TEST(Progress, RemainingTimeFollowsFromTheSpeed) {
  // 1000 steps in 10 s since the run was resumed at 5000: 4000 left are 40 s
  EXPECT_EQ(progress_line("squeeze", 6000, 5000, 10000, 10.0),
            "stage squeeze: step 6000, 60.0 %, 100 steps/s, at most 40 s left");
  EXPECT_EQ(seconds_left(6000, 5000, 10000, 10.0), 40.0);
  EXPECT_EQ(seconds_left(12000, 5000, 10000, 10.0), 0.0);  // never less than nothing
  EXPECT_EQ(seconds_left(5000, 5000, 10000, 10.0), std::nullopt);
  // with stages to come, whose steps may turn out shorter
  EXPECT_EQ(progress_line("squeeze", 6000, 5000, 10000, 10.0, false),
            "stage squeeze: step 6000, 60.0 %, 100 steps/s, about 40 s left");
  EXPECT_EQ(progress_line("squeeze", 5000, 5000, 10000, 0.0), "stage squeeze: step 5000, 50.0 %");
  EXPECT_EQ(progress_line("squeeze", 6000, 5000, 10000, 0.0),
            "stage squeeze: step 6000, 60.0 %");  // no speed
}

TEST(Progress, ClockIsReadTenTimesASecondAtAnySpeed) {
  for (const double seconds_per_step : {200e-9, 1e-4, 0.03, 0.7}) {
    std::int64_t interval = 1, looks = 0;
    while (looks++ < 100) {
      const double seconds = static_cast<double>(interval) * seconds_per_step;
      const std::int64_t next = progress_interval(interval, seconds);
      EXPECT_GE(next, 1);
      EXPECT_LE(next, 2 * interval);
      if (seconds < 0.05) {
        EXPECT_EQ(next, 2 * interval);
      }
      interval = next;
    }
    // a tenth of a second, or one step where that takes longer; cut to whole steps
    const double seconds = static_cast<double>(interval) * seconds_per_step;
    EXPECT_LE(seconds, std::max(0.1, seconds_per_step) * (1 + 1e-12)) << seconds_per_step;
    EXPECT_GT(seconds, 0.1 - seconds_per_step * (1 + 1e-12)) << seconds_per_step;
  }
  EXPECT_EQ(progress_interval(8, 0.0), 16);      // too fast for the clock
  EXPECT_EQ(progress_interval(1000, 10.0), 10);  // steps have become slower: at once
}

TEST(Progress, HoursAreWrittenOut) {
  EXPECT_EQ(hours(3600 * 25 + 61), "25:01:01");
  EXPECT_EQ(hours(7.26), "7.3 s");
}

TEST(Timing, SharesAddUp) {
  const auto lines = test::lines_of(timing_table({{"build", 1.0}, {"steps", 3.0}}));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_NE(lines[0].find(" 25.0 %"), std::string::npos);
  EXPECT_NE(lines[1].find(" 75.0 %"), std::string::npos);
  EXPECT_NE(lines[2].find("4.000 s"), std::string::npos);
}

TEST(StaticTable, RowsAreAsWideAsTheHeaderForSmallAndLargeValues) {
  const std::size_t width = static_table_header().size();
  EXPECT_EQ(static_table_row(0, {}, {}, {}).size(), width);
  const Energies energies{0, 0, -1.23456789e-123, 0, 0, 0};
  EXPECT_EQ(static_table_row(999999999999, {-1.23456789e-123, PointKind::limit_point, 999999}, energies,
                             {99999999, 99999999})
                .size(),
            width);
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(StaticReport, SaysWhetherTheBalanceIsStable) {
  StaticResult r;
  r.ended = "converged";
  EXPECT_TRUE(has(static_report(StageKind::equilibrium, r, ""), "not known"));
  r.unstable = 0;
  EXPECT_TRUE(has(static_report(StageKind::equilibrium, r, ""), "\nstable"));
  r.unstable = 2;
  r.smallest_eigenvalue = -0.5;
  EXPECT_TRUE(has(static_report(StageKind::equilibrium, r, ""),
                  "UNSTABLE in 2 directions, smallest eigenvalue -0.5"));
}

TEST(StaticReport, SaysHowFarItLookedForCriticalLoads) {
  StaticResult r;
  r.ended = "bond range";
  r.searched_to = 0.25;
  EXPECT_TRUE(has(static_report(StageKind::buckling, r, ""), "none up to load factor 0.25\n"));
  r.critical_loads = {{PointKind::limit_point, 0.125, {}, 0.0, {}, 0.0}};
  const std::string text = static_report(StageKind::buckling, r, "");
  EXPECT_TRUE(has(text, "limit point            0.125                -                -\n")) << text;
  EXPECT_TRUE(has(text, "no others up to load factor 0.25\n")) << text;
}

TEST(StaticReport, RigidAndUnstableModesHaveNoPeriod) {
  StaticResult r;
  r.modes = {{1e-9, 1e-18, true, {}}, {0, -4, false, {}}, {2.0, 4.0, false, {}}};
  const std::string text = static_report(StageKind::modes, r, " s");
  EXPECT_FALSE(has(text, "load factor")) << text;  // all loads are on
  EXPECT_TRUE(has(text, "omega [rad/s]   frequency [Hz]       period [s]\n")) << text;
  EXPECT_TRUE(has(static_report(StageKind::modes, r, ""), "omega        frequency           period\n"));
  EXPECT_TRUE(has(text, "rigid\n")) << text;
  EXPECT_TRUE(has(text, "UNSTABLE  omega^2 = -4\n")) << text;
  EXPECT_TRUE(has(text, "0.31830989        3.1415927\n")) << text;  // 2 / (2 pi), and pi
}

}  // namespace
}  // namespace vbond
