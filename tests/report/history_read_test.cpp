#include "vbond/report/history_read.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "specimen.hpp"
#include "vbond/core/error.hpp"

namespace vbond::page {
namespace {

using test::Folder;
using test::put_content;

TEST(PageHistory, ColumnsComeBackAndEmptyCellsAreNoNumbers) {
  const Folder folder;
  put_content(folder / "h.csv", "step,\"a,\"\"b\",load_factor\n0,1.5,\n7,-2e-300,0.25\n8,1");
  const History h = read_history(folder / "h.csv");
  ASSERT_EQ(h.columns.size(), 3U);
  EXPECT_EQ(h.rows(), 2U);  // the last line is still being written
  EXPECT_EQ(h.columns[1].name, "a,\"b");
  EXPECT_EQ(h.columns[1].values, (std::vector<double>{1.5, -2e-300}));
  EXPECT_TRUE(std::isnan(h.find("load_factor")->values[0]));
  EXPECT_EQ(h.find("load_factor")->values[1], 0.25);
  EXPECT_EQ(h.find("none"), nullptr);
}

TEST(PageHistory, DamagedRowsAreRefused) {
  const Folder folder;
  for (const char* row : {"0,1\n", "0,1,2,3\n", "0,x,1\n", "0,1,2 \n"}) {
    put_content(folder / "h.csv", std::string("a,b,c\n") + row);
    EXPECT_THROW(read_history(folder / "h.csv"), IoError) << row;
  }
}

TEST(PageHistory, WithoutAWholeHeaderThereAreNoRows) {
  const Folder folder;
  for (const char* begun : {"", "step,ti", "step,\"a", "step,"}) {
    put_content(folder / "h.csv", begun);
    EXPECT_TRUE(read_history(folder / "h.csv").columns.empty()) << begun;
  }
  for (const char* bad : {"step,\"a\n", "\"a\nb\","}) {
    put_content(folder / "h.csv", bad);
    EXPECT_THROW(read_history(folder / "h.csv"), IoError) << bad;
  }
}

TEST(PageHistory, BalancesGoOnByStepAndMotionByTime) {
  EXPECT_EQ(clock_of({}), "time");
  EXPECT_EQ(clock_of({{{"step", {0, 1}}, {"load_factor", {0.0, 1.0}}}}), "step");
  EXPECT_EQ(clock_of({{{"step", {0, 1}}, {"load_factor", {0.0, std::nan("")}}}}), "time");
}

History long_history(std::size_t n) {
  History h{{{"step", {}}, {"time", {}}, {"wave", {}}, {"flat", {}}}};
  for (std::size_t k = 0; k < n; ++k) {
    const auto x = static_cast<double>(k);
    h.columns[0].values.push_back(10.0 * x);
    h.columns[1].values.push_back(0.1 * x);
    h.columns[2].values.push_back(k == 31234 ? 50.0 : std::sin(0.01 * x));
    h.columns[3].values.push_back(3.0);
  }
  return h;
}

TEST(PageHistory, ThinningKeepsFirstLastFramesAndExtremes) {
  const History h = long_history(100'000);
  const std::vector<std::size_t> rows = rows_to_keep(h, {123450, 777770}, 4000);
  EXPECT_LE(rows.size(), 4000U);
  EXPECT_GT(rows.size(), 3000U);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  for (const std::size_t row : {0, 12345, 31234, 77777, 99999})
    EXPECT_TRUE(std::binary_search(rows.begin(), rows.end(), row)) << row;
}

TEST(PageHistory, ShortOnesStayWhole) {
  EXPECT_EQ(rows_to_keep(long_history(4000), {}, 4000).size(), 4000U);
}

TEST(PageHistory, PresetsFollowTheColumns) {
  History h{{{"time", {0, 1, 2}},
             {"axial_force.all", {0, 1, 1}},
             {"displacement.4.x", {0, 1, 2}},
             {"displacement.4.y", {0, 5, 9}},
             {"reaction.ends.fx", {0, 2, 3}},
             {"reaction.ends.mx", {0, 9, 99}}}};
  const std::vector<Plot> plots = preset_plots(h);
  ASSERT_EQ(plots.size(), 4U);
  EXPECT_EQ(plots[1].x, "time");
  EXPECT_EQ(plots[0].x, "displacement.4.x");  // along the reaction, though it moves more along y
  EXPECT_EQ(plots[0].y, std::vector<std::string>{"axial_force.all"});
  EXPECT_EQ(plots[2].y, std::vector<std::string>{"reaction.ends.fx"});
  h.columns.erase(h.columns.begin() + 1);
  EXPECT_EQ(preset_plots(h)[0].y, std::vector<std::string>{"reaction.ends.fx"});  // a force, not a moment
  h.columns.push_back({"load_factor", {0, 0.5, 1}});
  EXPECT_EQ(preset_plots(h)[0].y, std::vector<std::string>{"load_factor"});
  EXPECT_EQ(preset_plots(h).back().x, "load_factor");  // balances only
  h.columns.back().values = {0, 1, 0.5};
  EXPECT_EQ(axis_of(h), "displacement.4.x");  // a path goes on where its load factor falls
  h.columns[1].values = {0, 2, 1};
  EXPECT_EQ(axis_of(h), "step");
  EXPECT_TRUE(preset_plots({{{"time", {0, 1}}, {"total", {1, 1}}}}).empty());
}

TEST(PageHistory, ColumnsHaveTheirUnits) {
  EXPECT_EQ(unit_of_column("displacement.7.z"), "m");
  EXPECT_EQ(unit_of_column("displacement.7"), "");  // no column of a history
}

TEST(PageHistory, ForcesOnWallsAreOffered) {
  const History h{{{"time", {0, 1, 2}},
                   {"wall.a.b.Fx", {0, 0, 0}},
                   {"wall.a.b.Fy", {0, 1, 1}},
                   {"wall.a.b.Fz", {0, 5, 9}},
                   {"wall.a.b.Mx", {0, 50, 90}},
                   {"wall.a.b.z", {0, -1, -2}},
                   {"wall.floor.Fx", {0, 0, 0}}}};
  const std::vector<Plot> plots = preset_plots(h);
  ASSERT_EQ(plots.size(), 2U);  // nothing ever presses on the floor
  EXPECT_EQ(plots[0].x, "wall.a.b.z");
  EXPECT_EQ(plots[0].y, std::vector<std::string>{"wall.a.b.Fz"});
  EXPECT_EQ(plots[1].x, "time");
  EXPECT_EQ(plots[1].y, (std::vector<std::string>{"wall.a.b.Fy", "wall.a.b.Fz"}));
}

TEST(PageHistory, StressesOfACellAreOffered) {
  const History h{{{"time", {0, 1, 2}},
                   {"cell_strain_xx", {0, -0.1, -0.2}},
                   {"cell_strain_yy", {0, 0.1, 0.1}},
                   {"cell_strain_zz", {0, 0, 0}},
                   {"cell_stress_xx", {0, -3, -5}},
                   {"cell_stress_zz", {0, 0, 0}}}};
  const std::vector<Plot> plots = preset_plots(h);
  ASSERT_EQ(plots.size(), 3U);
  EXPECT_EQ(plots[0].x, "cell_strain_xx");  // changes most
  EXPECT_EQ(plots[0].y, std::vector<std::string>{"cell_stress_xx"});
  EXPECT_EQ(plots[1].x, "time");
  EXPECT_EQ(plots[1].y, std::vector<std::string>{"cell_stress_xx"});
  EXPECT_EQ(plots[2].y, (std::vector<std::string>{"cell_strain_xx", "cell_strain_yy"}));
}

}  // namespace
}  // namespace vbond::page
