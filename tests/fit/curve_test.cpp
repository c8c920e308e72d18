#include "vbond/fit/curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

/// A curve between its rows.
namespace vbond::fit_curve_test {
namespace {

using fit::Curve;

TEST(FitCurve, IsAStraightLineBetweenRowsEitherWay) {
  Curve c{{0, 1, 4}, {2, 4, -2}};
  for (int way = 0; way < 2; ++way) {
    EXPECT_DOUBLE_EQ(fit::at(c, 0)->y, 2);
    EXPECT_DOUBLE_EQ(fit::at(c, 0.25)->y, 2.5);
    EXPECT_DOUBLE_EQ(fit::at(c, 1)->y, 4);
    EXPECT_DOUBLE_EQ(fit::at(c, 3)->y, 0);
    EXPECT_DOUBLE_EQ(fit::at(c, 4)->y, -2);
    std::reverse(c.x.begin(), c.x.end()), std::reverse(c.y.begin(), c.y.end());
  }
}

TEST(FitCurve, HasNothingBeyondItsRowsButRounding) {
  const Curve c{{0, 0.1, 1}, {0, 1, 2}};
  EXPECT_FALSE(fit::at(c, 1.001));
  EXPECT_FALSE(fit::at(c, -0.001));
  EXPECT_DOUBLE_EQ(fit::at(c, 1 + 1e-12)->y, 2);
  EXPECT_FALSE(fit::at({}, 0));
  EXPECT_DOUBLE_EQ(fit::at({{3}, {7}}, 3)->y, 7);
}

TEST(FitCurve, TakesTheFirstValueWhereItJumps) {
  EXPECT_DOUBLE_EQ(fit::at({{0, 1, 1, 2}, {0, 5, 1, 2}}, 1)->y, 5);
  EXPECT_DOUBLE_EQ(fit::at({{0, 1, 1, 2}, {0, 5, 1, 2}}, 1.5)->y, 1.5);
}

TEST(FitCurve, TellsWhereItGoesBack) {
  EXPECT_FALSE(fit::goes_back({{0, 1, 1, 2}, {0, 0, 0, 0}}));
  EXPECT_FALSE(fit::goes_back({{0, -1, -2}, {0, 0, 0}}));
  EXPECT_EQ(fit::goes_back({{0, 1, 0.5, 2}, {0, 0, 0, 0}}), 2u);
  EXPECT_EQ(fit::goes_back({{0, -1, -0.5, -2}, {0, 0, 0, 0}}), 2u);
}

// Of a parabola y = x^2 the straight line is off by (x - x_k)(x_k+1 - x), and its second differences say so
// exactly.
TEST(FitCurve, SaysHowFarTheLineIsOff) {
  Curve c;
  for (const double x : {0.0, 0.5, 1.5, 2.0, 4.0}) c.x.push_back(x), c.y.push_back(x * x);
  for (const double x : {0.1, 0.7, 1.6, 3.0}) {
    const fit::Between found = *fit::at(c, x);
    EXPECT_NEAR(found.off, std::abs(found.y - x * x), 1e-14) << x;
    EXPECT_GT(found.off, 0.03) << x;
  }
}

// Against central differences of curves whose rows have moved, which are smooth between rows.
TEST(FitCurve, RatesAreThoseOfMovedRows) {
  const Curve c{{0, 1, 2.5, 4}, {1, 3, 2, 5}}, rates{{0, 0.3, -0.2, 0.5}, {0.4, -1, 0.7, 2}};
  const auto moved = [&](double by) {
    Curve m = c;
    for (std::size_t k = 0; k < c.x.size(); ++k) m.x[k] += by * rates.x[k], m.y[k] += by * rates.y[k];
    return m;
  };
  constexpr double h = 1e-5;
  for (const double x : {0.2, 0.9, 1.7, 2.6, 3.9})
    EXPECT_NEAR(fit::rate_at(c, rates, x), (fit::at(moved(h), x)->y - fit::at(moved(-h), x)->y) / (2 * h),
                1e-8)
        << x;
  EXPECT_DOUBLE_EQ(fit::rate_at(c, rates, 0), 0.4);
  EXPECT_TRUE(std::isnan(fit::rate_at(c, rates, 4.5)));
}

// Rows without a number end a piece of the curve: nothing is drawn across them.
TEST(FitCurve, HasGapsWhereRowsHaveNoNumber) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const fit::Curve c{{0, 1, 2, 3, 4, 5}, {none, 10, 20, none, 40, 50}};
  for (const double x : {0.0, 0.5, 2.5, 3.0, 3.5}) EXPECT_FALSE(fit::at(c, x)) << x;
  for (const double x : {1.0, 1.5, 2.0, 2 + 1e-12, 4 - 1e-12, 4.0, 4.5, 5.0}) {
    const auto between = fit::at(c, x);
    ASSERT_TRUE(between) << x;
    EXPECT_NEAR(between->y, 10 * x, 1e-10);
    EXPECT_NEAR(between->off, 0, 1e-10);
  }
}

}  // namespace
}  // namespace vbond::fit_curve_test
