#include "vbond/fit/measured.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>
#include <string>

#include "temporary_folder.hpp"
#include "vbond/core/error.hpp"
#include "vbond/fit/key_text.hpp"

/// Measured points, and numbers in the text of a case.
namespace vbond::fit_measured_test {
namespace {

using fit::Measured;
using fit::Points;

/// A CSV file of these lines.
class Data {
 public:
  explicit Data(const std::string& text) : folder_("vbond_fit_data"), path_(folder_ / "data.csv") {
    std::ofstream(path_) << text;
  }
  Points read(const std::vector<Measured>& measured, UnitSystem units = UnitSystem::si,
              std::optional<std::string> stage = {}) const {
    return fit::read_points(path_, {"time", "t"}, measured, stage, {"pull", "bend"}, units);
  }
  std::string refusal(const std::vector<Measured>& measured, UnitSystem units = UnitSystem::si,
                      std::optional<std::string> stage = {}) const {
    try {
      read(measured, units, stage);
    } catch (const CaseError& e) {
      return e.what();
    }
    return "";
  }

 private:
  test::TemporaryFolder folder_;
  std::filesystem::path path_;
};

const Measured force{{"reaction.last.fx", "F [kN]"}, ""};

TEST(FitData, UnitsOfHeadingsBecomeThoseOfTheHistory) {
  const Points read = Data("t,F [kN],sd [N],other\n1,2,3,x\n2,,,y\n").read({{force.y, "sd [N]"}});
  ASSERT_EQ(read.points.size(), 1u);  // an empty field was not measured
  EXPECT_DOUBLE_EQ(read.points[0].x, 1);
  EXPECT_DOUBLE_EQ(read.points[0].y, 2000);
  EXPECT_DOUBLE_EQ(read.points[0].sigma, 3);
  EXPECT_EQ(read.points[0].line, 2u);
  EXPECT_EQ(read.passed_over, std::vector<std::string>{"other"});
}

// The column is that of the field, also where its text stands earlier in the line, and characters count, not
// bytes.
TEST(FitData, WrongNumbersAreToldWithTheirColumn) {
  const auto place = [](const std::string& text) {
    const std::string told = Data(text).refusal({force});
    return told.substr(told.find("data.csv"), told.find(": ") - told.find("data.csv"));
  };
  EXPECT_EQ(place("other,t,F [kN]\nx,1,x\n"), "data.csv:2:5");
  EXPECT_EQ(place("other,t,F [kN]\nx,  ,2\n"), "data.csv:2:5");
  EXPECT_EQ(place("other;t;F [kN]\n\"x;1\"\"\";1;  1,5\n"), "data.csv:2:13");
  EXPECT_EQ(place("other\tt\tF [kN]\n\u00e4\u00e4\t1\tx\n"), "data.csv:2:6");
  EXPECT_EQ(place("other,t,F [kN]\n\"a\nb\",1,x\n"), "data.csv:2:1");  // on a further line of its row
}

TEST(FitData, RowsBelongToStages) {
  const Data data("t,F [kN],stage\n1,2,bend\n");
  EXPECT_EQ(data.read({force}).points[0].stage, 1u);
  EXPECT_TRUE(data.read({force}, UnitSystem::si, "pull").points.empty());  // the row is of another stage
  EXPECT_EQ(data.read({force}, UnitSystem::si, "bend").points.size(), 1u);
  EXPECT_NE(data.refusal({force}, UnitSystem::si, "pul").find("did you mean \"pull\"?"), std::string::npos);
  EXPECT_NE(Data("t,F [kN],stage\n1,2,bent\n").refusal({force}).find("data.csv:2:5: stage \"bent\""),
            std::string::npos);
}

TEST(FitData, RowsWithoutAStageBelongToTheOneThatIsNamed) {
  EXPECT_EQ(Data("t,F [kN]\n1,2\n").read({force}, UnitSystem::si, "pull").points[0].stage, 0u);
}

TEST(FitData, MistakesAreToldWithTheirPlaces) {
  const struct {
    const char *text, *told;
  } cases[] = {{"t,F [kN]\n1,2\n3,1.5N\n", "data.csv:3:3: F [kN] = \"1.5N\""},
               {"t,F [kN]\n1,inf\n", "data.csv:2:3"},
               {"t,F [kN]\n,2\n", "t = \"\""},
               {"t,F [kN]\n", "data.csv:1:1: no row of data"},
               {"", "there is no column \"t\""},
               {"t,F\n1,2\n", "there is no column \"F [kN]\""},
               {"t,F [kN]\n1\n", "data.csv:2:1: 1 fields"}};
  for (const auto& [text, told] : cases)
    EXPECT_NE(Data(text).refusal({force}).find(told), std::string::npos)
        << text << Data(text).refusal({force});
}

TEST(FitData, UnitsThatDoNotFitAreRefused) {
  const auto with = [](const std::string& unit, UnitSystem units) {
    return Data("t,F [" + unit + "]\n1,2\n").refusal({{{"reaction.last.fx", "F [" + unit + "]"}, ""}}, units);
  };
  EXPECT_EQ(with("N", UnitSystem::si), "");
  EXPECT_NE(with("mm", UnitSystem::si).find("data.csv:1:3: column \"F [mm]\""), std::string::npos);
  EXPECT_NE(with("furlong", UnitSystem::si).find("give it in [N]"), std::string::npos);
  EXPECT_NE(with("N", UnitSystem::reduced).find("reduced units"), std::string::npos);
  EXPECT_NE(Data("t,F [N]\n1,2\n").refusal({{{"load_factor", "F [N]"}, ""}}).find("pure number"),
            std::string::npos);
}

TEST(FitData, HeadingsMaySayThatANumberIsPure) {
  for (const char* heading : {"f [-]", "f [1]"}) {
    const Data data(std::string("t,") + heading + "\n1,2\n");
    EXPECT_DOUBLE_EQ(data.read({{{"load_factor", heading}, ""}}).points[0].y, 2);
    EXPECT_NE(data.refusal({{{"reaction.last.fx", heading}, ""}}).find("not a pure number"),
              std::string::npos);
    EXPECT_EQ(data.refusal({{{"reaction.last.fx", heading}, ""}}, UnitSystem::reduced), "");
  }
}

TEST(FitData, StandardDeviationsArePositive) {
  EXPECT_THROW(Data("t,F [kN]\n1,2\n").read({{force.y, "-1"}}), std::invalid_argument);
  EXPECT_NE(Data("t,F [kN],s\n1,2,0\n").refusal({{force.y, "s"}}).find("must be > 0"), std::string::npos);
  EXPECT_DOUBLE_EQ(Data("t,F [kN]\n1,2\n").read({{force.y, "0.5"}}).points[0].sigma, 0.5);
}

// ---- numbers in the text of a case
// -----------------------------------------------------------------------------

const std::string text =
    "title = \"a = 3 µm\"\n[[bonds]]\nname = 'fibre'\nE = \"2.5e9 Pa\"   # = 4\nnu=0.25\r\n"
    "section = {shape = \"circle\", diameter = 2e-3}\nfactors = [1, [2, \"3 mm\"]]\na.\"b\".c = -7 # end\nd "
    "= \"4 T0\"";

TEST(NumberInText, IsFoundAndReplacedAndNothingElse) {
  const struct {
    const char *key, *unit, *as_written;
    double value;
  } cases[] = {{"bonds[0].E", "Pa", "\"2.5e9 Pa\"", 2.5e9},
               {"bonds[fibre].nu", "", "0.25", 0.25},
               {"bonds[0].section.diameter", "", "2e-3", 2e-3},
               {"bonds[0].factors[0]", "", "1", 1},
               {"bonds[0].factors[1][1]", "mm", "\"3 mm\"", 3},
               {"bonds[0].a.b.c", "", "-7", -7},
               {"bonds[0].d", "T0", "\"4 T0\"", 4}};
  for (const auto& [key, unit, as_written, value] : cases) {
    const fit::NumberInText found = fit::number_in(text, "c.toml", key, "--vary");
    EXPECT_EQ(found.value, value) << key;
    EXPECT_EQ(found.unit, unit) << key;
    EXPECT_EQ(text.substr(found.begin, found.end - found.begin), as_written) << key;
  }
  EXPECT_EQ(fit::number_in(text, "c.toml", "bonds[0].E", "--vary").toml(0.1), "\"0.1 Pa\"");
}

TEST(NumberInText, IsRefusedWhereThereIsNone) {
  const auto refusal = [](const std::string& key) -> std::string {
    try {
      fit::number_in(text, "c.toml", key, "--vary");
    } catch (const CaseError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal("bonds[0].name").find("c.toml:3:1: bonds[0].name = \"fibre\""), std::string::npos);
  EXPECT_NE(refusal("bonds[0].section").find("one number"), std::string::npos);
  EXPECT_NE(refusal("bonds[0].G").find("--vary bonds[0].G"), std::string::npos);
  EXPECT_NE(refusal("bonds[0].G").find("the case does not give G"), std::string::npos);
  EXPECT_NE(refusal("bonds[1].E").find("bonds has no item 1"), std::string::npos);
  EXPECT_NE(refusal("bonds.E").find("say which of its items"), std::string::npos);
}

TEST(NumberInText, BoundsComeIntoItsUnit) {
  const fit::NumberInText E = fit::number_in(text, "c.toml", "bonds[0].E", "--vary"),
                          d = fit::number_in(text, "c.toml", "bonds[0].section.diameter", "--vary");
  EXPECT_DOUBLE_EQ(fit::in_unit_of(E, "2 GPa", ""), 2e9);
  EXPECT_DOUBLE_EQ(fit::in_unit_of(E, "2e9", ""), 2e9);
  EXPECT_DOUBLE_EQ(fit::in_unit_of(E, "3 Pa", ""), 3);
  EXPECT_THROW(fit::in_unit_of(E, "2 mm", ""), CaseError);
  EXPECT_THROW(fit::in_unit_of(E, "two", ""), CaseError);
  EXPECT_THROW(fit::in_unit_of(d, "2 mm", ""), CaseError);
}

}  // namespace
}  // namespace vbond::fit_measured_test
