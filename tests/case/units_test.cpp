#include "vbond/case/dimension.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "vbond/case/node.hpp"
#include "vbond/case/read.hpp"

namespace vbond::keys {
namespace {

struct Row {
  const char* text;
  double value;
  Dimension dimension;
};

// Values are compared bit for bit: a decimal prefix shifts the exponent before the one rounding.
TEST(Quantity, IsReadInBaseUnits) {
  const Row rows[] = {
      {"2 GPa", 2e9, stress},
      {"0.5 mm", 0.5e-3, length},
      {"20 us", 2e-5, duration},
      {"20 \xC2\xB5s", 2e-5, duration},
      {"7800 kg/m^3", 7800, density},
      {"7.8 g/cm^3", 7800, density},
      {"1e-3 N*m", 1e-3, moment},
      {"3mm^4", 3e-12, area_moment},
      {"-1.5e+2 m/s", -150, velocity},
      {"+9.81 m/s^2", 9.81, acceleration},
      {"10 deg", 10 * (std::numbers::pi / 180), angle},
      {"2 rev/s", 4 * std::numbers::pi, angular_velocity},
      {"1e-3 N*m/rad", 1e-3, {2, 1, -2, -1}},
      {"2 min", 120, duration},
      {"1 kPa*mm^2", 1e-3, force},
      {"3 m*s^-1", 3, velocity},
      {"13.56 angstrom", 13.56e-10, length},
      {"50 %", 0.5, pure},
      {"1 kHz", 1e3, {0, 0, -1}},
      {"1 eV", 1.602176634 * 1e-19, {2, 1, -2}},
      {"3 J", 3, {2, 1, -2}},
      {"2 kW", 2e3, {2, 1, -3}},
      {"0.5 h", 1800, duration},
      {"42", 42, pure},
  };
  for (const Row& row : rows) {
    const auto q = parse_quantity(row.text);
    ASSERT_TRUE(std::holds_alternative<Quantity>(q)) << row.text << ": " << std::get<UnitMistake>(q).rule;
    EXPECT_EQ(std::get<Quantity>(q).value, row.value) << row.text;
    EXPECT_TRUE(std::get<Quantity>(q).dimension == row.dimension) << row.text;
    EXPECT_FALSE(std::get<Quantity>(q).in_T_0) << row.text;
  }
}

TEST(Quantity, KnowsThePrefixesOfSi) {
  const std::pair<const char*, double> prefixes[] = {
      {"a", 1e-18}, {"f", 1e-15}, {"p", 1e-12}, {"n", 1e-9},       {"u", 1e-6}, {"m", 1e-3},
      {"c", 1e-2},  {"d", 1e-1},  {"da", 1e1},  {"h", 1e2},        {"k", 1e3},  {"M", 1e6},
      {"G", 1e9},   {"T", 1e12},  {"P", 1e15},  {"\xCE\xBC", 1e-6}};
  for (const auto& [prefix, value] : prefixes) {
    const auto q = parse_quantity(std::string("1 ") + prefix + "m");
    ASSERT_TRUE(std::holds_alternative<Quantity>(q)) << prefix;
    EXPECT_EQ(std::get<Quantity>(q).value, value) << prefix;
  }
}

TEST(Quantity, MayBeAMultipleOfT0) {
  for (const char* text : {"10 T0", "10T0", "10 T_0"}) {
    const auto q = parse_quantity(text);
    ASSERT_TRUE(std::holds_alternative<Quantity>(q)) << text;
    EXPECT_EQ(std::get<Quantity>(q).value, 10.0) << text;
    EXPECT_TRUE(std::get<Quantity>(q).in_T_0) << text;
  }
}

TEST(Quantity, RefusesWhatIsNone) {
  for (const char* text : {"",      "m",         "inf m",   "nan",    "1e400 m", "1e300 Gm^12",
                           "1 m^",  "1 m^99",    "1 m^1.5", "1 kkm",  "1 m//s",  "1 m*",
                           "1 (m)", "1 furlong", "1 kmin",  "0x10 m", "1,5 mm",  "1e99999999999 m",
                           "--1 m", "1 T0^2",    "1 m/T0"})
    EXPECT_TRUE(std::holds_alternative<UnitMistake>(parse_quantity(text))) << text;
}

std::string rod(const std::string& units, const std::string& spacing, const std::string& duration_text) {
  return "[units]\nsystem = \"" + units +
         "\"\n[[specimen]]\nkind = \"rod\"\nparticles = 2\nmass = 1\ninertia = 1\n" + "spacing = " + spacing +
         "\n[[stage]]\nduration = " + duration_text + "\n";
}

TEST(Units, OfSiAreConvertedOnce) {
  const Case c = parse_case(rod("SI", "\"0.5 mm\"", "\"20 us\""), "rod.toml");
  EXPECT_EQ(c.units, UnitSystem::si);
  EXPECT_EQ(std::get<RodSpecimen>(c.specimens[0].shape).spacing, 0.5e-3);
  EXPECT_EQ(c.stages[0].duration.value, 2e-5);
  EXPECT_FALSE(c.stages[0].duration.in_T_0);
}

TEST(Units, OfSiMayBeLeftOut) {
  const Case c = parse_case(rod("SI", "0.0005", "3"), "rod.toml");
  EXPECT_EQ(std::get<RodSpecimen>(c.specimens[0].shape).spacing, 0.0005);
  EXPECT_EQ(c.stages[0].duration.value, 3.0);
}

TEST(Units, MultiplesOfT0AreTimesInBothSystems) {
  for (const char* system : {"reduced", "SI"}) {
    const Case c = parse_case(rod(system, "1.0", "\"10 T0\""), "rod.toml");
    EXPECT_TRUE(c.stages[0].duration.in_T_0);
    EXPECT_EQ(c.stages[0].duration.resolve(2.0), 20.0);
    EXPECT_THROW(parse_case(rod(system, "\"1 T0\"", "1"), "rod.toml"), CaseError);
  }
}

TEST(Units, AreRefusedWithReducedNumbers) {
  EXPECT_THROW(parse_case(rod("reduced", "\"0.5 mm\"", "1"), "rod.toml"), CaseError);
  EXPECT_THROW(parse_case(rod("reduced", "1", "\"20 us\""), "rod.toml"), CaseError);
}

/// What a case with an SI support that turns like this is met with.
std::string turning(const std::string& rate) {
  try {
    const Case c = parse_case(rod("SI", "1", "1") + "supports = [{ group = \"first\", fix = [\"rx\"], " +
                                  "angular_velocity = [" + rate + ", 0, 0] }]\n",
                              "rod.toml");
    return number_text(c.stages[0].supports[0].angular_velocity.x);
  } catch (const CaseError& e) {
    return e.what();
  }
}

// A frequency may count radians or turns.
TEST(Units, OfAngularVelocityNameAnAngle) {
  EXPECT_EQ(turning("\"3 rad/s\""), "3.0");
  EXPECT_EQ(turning("\"2 rev/s\""), number_text(4.0 * std::numbers::pi));
  EXPECT_EQ(turning("3"), "3.0");
  for (const char* frequency : {"\"10 Hz\"", "\"10 s^-1\"", "\"10 1/s\"", "\"10 kHz*m/m\""}) {
    const std::string report = turning(frequency);
    EXPECT_NE(report.find("in rad/s, deg/s or rev/s"), std::string::npos) << frequency << ": " << report;
  }
}

TEST(Units, OfAnAngleAreRefusedForANumber) {
  const auto report = [](const std::string& nu, const std::string& c_B) {
    try {
      parse_case(rod("SI", "1", "1") + "[[bonds]]\ndistance = 1.1\nstiffness = { c_A = 1, c_D = 1, c_B = " +
                     c_B + ", c_T = 1 }\n[contact]\nlaw = \"hertz\"\nE = 1\nnu = " + nu + "\n",
                 "rod.toml");
    } catch (const CaseError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(report("\"20 %\"", "\"1 N*m\""), "");
  EXPECT_EQ(report("0.2", "\"1 N*m/rad\""), "");  // as stiffnesses in bending are given
  EXPECT_NE(report("\"20 deg\"", "1").find("must be a number without a unit; this is an angle (rad)"),
            std::string::npos)
      << report("\"20 deg\"", "1");
  EXPECT_NE(report("0.2", "\"1 N*m*rad\""), "");
}

}  // namespace
}  // namespace vbond::keys
