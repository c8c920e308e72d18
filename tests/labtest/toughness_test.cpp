#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "vbond/labtest/search_strengths.hpp"
#include "vbond/labtest/toughness_unit.hpp"

namespace vbond::labtest::toughness_test {
namespace {

// ---- its unit ---------------------------------------------------------------------------------------------

TEST(ToughnessUnit, IsReadInItsSpellings) {
  for (const char* text :
       {"1.5 MPa m^0.5", "1.5 MPa*m^0.5", "1.5 MPa*sqrt(m)", "1.5 MPa sqrt(m)", "1.5MPa * sqrt(m)",
        "1.5 MPa m^(1/2)", "1500 kPa m^0.5", "1.5 N/mm^2*m^0.5", "1.5e6 N/m^1.5", "1.5 MN/m^1.5", "1.5e6"}) {
    const auto K = parse_toughness(text);
    ASSERT_TRUE(std::holds_alternative<double>(K)) << text;
    EXPECT_NEAR(std::get<double>(K) / 1.5e6, 1.0, 4e-16) << text;
  }
  EXPECT_DOUBLE_EQ(std::get<double>(parse_toughness("10 MPa mm^0.5")), 10e6 * std::sqrt(1e-3));
}

TEST(ToughnessUnit, RefusesWhatIsNone) {
  for (const char* text :
       {"", "1.5 MPa", "1.5 m^0.5", "MPa m^0.5", "1.5 MPa s^0.5", "1.5 MPa m", "1.5 N/m^2.5", "1.5 J/m^1.5",
        "1.5 MPa sqrt()", "nan", "1.5 MPa m^0.5 x", "^0.5", "sqrt(m)", "1e400 MPa m^0.5"})
    EXPECT_TRUE(std::holds_alternative<keys::UnitMistake>(parse_toughness(text))) << text;
}

// ---- the search -------------------------------------------------------------------------------------------

/// A body that is similar to itself: T = 20 t, K = 3 t whatever shear does, and C/T = 7 s.
struct Similar {
  int toughness_tests = 0;
  StrengthTests tests() {
    return [this](const StrengthFactors& k, const Strengths& asked) {
      StrengthsFound found;
      if (asked.tensile) found.strengths.tensile = 20.0 * k.tension;
      if (asked.compressive) found.strengths.compressive = 140.0 * k.shear;
      if (asked.toughness) found.strengths.toughness = 3.0 * k.tension, ++toughness_tests;
      return found;
    };
  }
};

TEST(ToughnessSearch, AloneIsOneCommonFactor) {
  Similar body;
  const StrengthSearch found = search_strengths({{{}, {}, 0.7}, 0.01}, body.tests());
  ASSERT_EQ(found.end, StrengthSearchEnd::reached);
  EXPECT_EQ(body.toughness_tests, 2);
  EXPECT_NEAR(found.all.back().factors.tension, 0.7 / 3.0, 1e-12);
  EXPECT_EQ(found.all.back().factors.tension, found.all.back().factors.shear);
}

TEST(ToughnessSearch, WithAStrengthBothAreMetOrRefusedByGrains) {
  // K/T = 0.15: 0.3 asks for grains four times as large
  Similar body;
  const StrengthGoal goal{{10.0, {}, 3.0}, 0.01};
  const StrengthSearch refused = search_strengths(goal, body.tests());
  ASSERT_EQ(refused.end, StrengthSearchEnd::grains);
  ASSERT_TRUE(refused.nearest);
  const Strengths& at = refused.all[*refused.nearest].found.strengths;
  EXPECT_NEAR(*at.tensile, 10.0, 0.1);
  EXPECT_NEAR(larger_grains(goal.asked, at), 4.0, 1e-12);
  EXPECT_EQ(body.toughness_tests, 1) << "a beam is broken only once the strengths are there";
  // a strength and a toughness that the body has, and ones that a common factor meets in between: 1.8 % apart
  for (const double K : {1.5, 1.527}) {
    const StrengthGoal met{{10.0, {}, K}, 0.01};
    const StrengthSearch found = search_strengths(met, body.tests());
    ASSERT_EQ(found.end, StrengthSearchEnd::reached) << K;
    EXPECT_TRUE(meets(met, found.all[*found.nearest].found.strengths));
  }
  EXPECT_EQ(search_strengths({{10.0, {}, 1.54}, 0.01}, body.tests()).end, StrengthSearchEnd::grains);
}

TEST(ToughnessSearch, WithBothStrengthsTheirRatioIsFoundFirst) {
  Similar body;
  const StrengthSearch found = search_strengths({{10.0, 100.0, 1.5}, 0.01}, body.tests());
  ASSERT_EQ(found.end, StrengthSearchEnd::reached);
  const StrengthFactors& k = found.all[*found.nearest].factors;
  EXPECT_NEAR(k.shear / k.tension, 100.0 / 70.0, 0.03);
  EXPECT_LE(body.toughness_tests, 2);
  EXPECT_EQ(search_strengths({{10.0, 100.0, 3.0}, 0.01}, body.tests()).end, StrengthSearchEnd::grains);
}

TEST(ToughnessSearch, BeamsWithoutAPeakEndIt) {
  const StrengthTests tests = [](const StrengthFactors& k, const Strengths& asked) {
    StrengthsFound found;
    if (asked.tensile) found.strengths.tensile = 20.0 * k.tension;
    if (asked.toughness) found.why = "bend3: no peak";
    return found;
  };
  const StrengthSearch found = search_strengths({{10.0, {}, 1.5}, 0.01}, tests);
  EXPECT_EQ(found.end, StrengthSearchEnd::no_strength);
  EXPECT_FALSE(found.nearest);
}

}  // namespace
}  // namespace vbond::labtest::toughness_test
