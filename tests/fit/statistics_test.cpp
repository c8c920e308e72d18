#include "vbond/fit/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "vbond/fit/search.hpp"

/// Errors of values found, against closed forms and by repeats.
namespace vbond::fit_statistics_test {
namespace {

using fit::Statistics;

constexpr double infinite = std::numeric_limits<double>::infinity();

// Closed forms: dof = 1 is tan(pi (p - 1/2)), dof = 2 is 2 (p - 1/2) sqrt(2 / (4 p (1 - p))); the normal one
// by erfc.
TEST(FitStatistics, QuantilesAreThoseOfStudent) {
  const double pi = std::acos(-1.0);
  for (const double p : {0.6, 0.9, 0.975, 0.995}) {
    EXPECT_NEAR(fit::student_quantile(p, 1) / std::tan(pi * (p - 0.5)), 1, 1e-11);
    EXPECT_NEAR(fit::student_quantile(p, 2) / ((2 * p - 1) * std::sqrt(2 / (4 * p * (1 - p)))), 1, 1e-11);
    EXPECT_NEAR(0.5 * std::erfc(-fit::student_quantile(p, infinite) / std::sqrt(2.0)), p, 1e-12);
    EXPECT_DOUBLE_EQ(fit::student_quantile(1 - p, 3), -fit::student_quantile(p, 3));
  }
  EXPECT_NEAR(fit::student_quantile(0.975, 1e7), fit::student_quantile(0.975, infinite), 1e-6);  // as 1/dof
  EXPECT_NEAR(fit::student_quantile(0.975, 10), 2.228138852,
              1e-9);  // Abramowitz and Stegun, table 26.10: 2.228
  EXPECT_THROW(fit::student_quantile(1, 3), std::invalid_argument);
  EXPECT_THROW(fit::student_quantile(0.5, 0), std::invalid_argument);
}

/// A straight line a + b x at x = 0 ... m - 1: rows (1, x).
std::vector<double> line(std::size_t m) {
  std::vector<double> J;
  for (std::size_t i = 0; i < m; ++i) J.push_back(1), J.push_back(static_cast<double>(i));
  return J;
}

// Regression of textbooks: var b = s^2 / S_xx, var a = s^2 (1/m + mean^2 / S_xx), correlation -mean /
// sqrt(S_xx/m + mean^2).
TEST(FitStatistics, OfALineAreThoseOfTextbooks) {
  const std::vector<double> r{0.3, -0.1, 0.2, -0.5, 0.1};
  const Statistics s = fit::statistics(line(5), r, {0, 0}, false);
  const double sum = 0.09 + 0.01 + 0.04 + 0.25 + 0.01, sd = std::sqrt(sum / 3), S_xx = 10;
  EXPECT_DOUBLE_EQ(s.dof, 3);
  EXPECT_NEAR(s.deviation, sd, 1e-15);
  EXPECT_NEAR(s.standard_error[0], sd * std::sqrt(1.0 / 5 + 4 / S_xx), 1e-14);
  EXPECT_NEAR(s.standard_error[1], sd / std::sqrt(S_xx), 1e-14);
  EXPECT_NEAR(s.correlation[1], -2 / std::sqrt(S_xx / 5 + 4), 1e-14);
  EXPECT_NEAR(s.quantile, fit::student_quantile(0.975, 3), 0);
  const Statistics known = fit::statistics(line(5), r, {0, 0}, true);  // then residuals say nothing of errors
  EXPECT_NEAR(known.standard_error[1], 1 / std::sqrt(S_xx), 1e-14);
  EXPECT_NEAR(known.quantile, 1.959963984540054, 1e-11);
}

TEST(FitStatistics, AValueThatIsHeldIsNone) {
  const Statistics s = fit::statistics(line(5), std::vector<double>(5, 0.1), {1, 0}, true);
  EXPECT_DOUBLE_EQ(s.dof, 4);
  EXPECT_TRUE(std::isnan(s.standard_error[0]));
  EXPECT_NEAR(s.standard_error[1], 1 / std::sqrt(30.0), 1e-14);  // sum of x^2
}

// The third column is the sum of the others, but for what differences leave (1e-7); the fourth has no part in
// it.
TEST(FitStatistics, ValuesThatAreNotToldApartAreNamed) {
  std::vector<double> J;
  std::mt19937 dice(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20; ++i) {
    const double a = normal(dice), b = normal(dice), c = normal(dice);
    J.insert(J.end(), {a, b, a + b + 1e-7 * normal(dice), 1e3 * c, 0.0});
  }
  const Statistics s = fit::statistics(J, std::vector<double>(20, 0.1), {0, 0, 0, 0, 0}, true, 1e-5, 1e-12);
  ASSERT_EQ(s.not_told_apart.size(), 1u);
  EXPECT_EQ(s.not_told_apart[0], (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(s.no_effect, std::vector<std::size_t>{4});
  for (const std::size_t j : {0u, 1u, 2u, 4u}) EXPECT_TRUE(std::isnan(s.standard_error[j])) << j;
  EXPECT_TRUE(std::isnan(s.correlation[1]));
  EXPECT_GT(s.standard_error[3], 0);
  ASSERT_EQ(s.singular_values.size(), 4u);
  EXPECT_LT(s.singular_values[3], s.criterion * s.singular_values[0]);
  EXPECT_EQ(s.rank, 3u);  // a + b, c and the difference of a and b
  EXPECT_DOUBLE_EQ(s.dof, 17);
  EXPECT_NEAR(s.deviation, std::sqrt(20 * 0.01 / 17), 1e-14);
  EXPECT_NEAR(fit::statistics(J, std::vector<double>(20, 0.1), {0, 0, 0, 0, 0}, false, 1e-5, 1e-12).quantile,
              fit::student_quantile(0.975, 17), 1e-11);
}

// Two values with the same derivative a of exp(a p) at 0, one exact and one by central differences with steps
// of h, sinh(a h) / h: the columns differ by (a h)^2 / 6 of themselves, which is no effect of either alone.
TEST(FitStatistics, WhatWideStepsSeeIsNotTakenForAnEffect) {
  for (const double h : {1e-3, 0.05, 0.3}) {
    std::vector<double> J;
    for (int i = 0; i < 20; ++i) {
      const double a = 0.3 + 0.1 * i;  // d/dp of exp(a p) at 0, exact and by differences
      J.insert(J.end(), {a, std::sinh(a * h) / h});
    }
    const Statistics s =
        fit::statistics(J, std::vector<double>(20, 0.1), {0, 0}, true, fit::criterion_of(h, false));
    EXPECT_EQ(s.not_told_apart.size(), 1u) << h;
    EXPECT_TRUE(std::isnan(s.standard_error[0])) << h;
  }
  EXPECT_DOUBLE_EQ(fit::criterion_of(1e-3, false), 1e-5);
  EXPECT_DOUBLE_EQ(fit::criterion_of(0.05, false), 0.025);
  EXPECT_DOUBLE_EQ(fit::criterion_of(1e-3, true), 0.01);
}

TEST(FitStatistics, TellFewerPointsThanValues) {
  const Statistics s = fit::statistics(std::vector<double>{1, 2}, std::vector<double>{0.0}, {0, 0}, true);
  EXPECT_EQ(s.not_told_apart.size(), 1u);
  EXPECT_TRUE(std::isnan(s.standard_error[0]) && std::isnan(s.standard_error[1]));
}

/// How often the interval of 95 % of each value contains the truth, of repeats with other noise.
template <class Model>
std::vector<double> coverage(const Model& model, const std::vector<fit::Searched>& searched,
                             const std::vector<double>& truth, const std::vector<double>& x, double noise,
                             int repeats) {
  std::mt19937 dice(42);
  std::normal_distribution<double> normal(0, noise);
  std::vector<double> inside(truth.size(), 0);
  const auto curves = [&](const std::vector<std::vector<double>>& all) {
    std::vector<fit::Trial> trials;
    for (const auto& p : all) {
      fit::Trial& t = trials.emplace_back();
      for (const double at : x) t.curve.push_back(model(p, at));
    }
    return trials;
  };
  for (int k = 0; k < repeats; ++k) {
    std::vector<double> data;
    for (const double at : x) data.push_back(model(truth, at) + normal(dice));
    const fit::Found found = fit::search(searched, data, std::vector<double>(x.size(), 1.0), curves, {});
    EXPECT_EQ(found.end, fit::SearchEnd::converged) << found.why;
    const Statistics s =
        fit::statistics(found.jacobian, found.residuals, std::vector<char>(truth.size(), 0), false);
    for (std::size_t j = 0; j < truth.size(); ++j) {
      const double reach = s.quantile * s.standard_error[j];
      const double off = searched[j].logarithmic ? std::log(truth[j] / found.values[j])
                                                 : (truth[j] - found.values[j]) / searched[j].scale();
      inside[j] += std::abs(off) <= reach ? 1.0 / repeats : 0.0;
    }
  }
  return inside;
}

std::vector<double> points(int m) {
  std::vector<double> x;
  for (int i = 0; i < m; ++i) x.push_back(0.1 + 0.2 * i);
  return x;
}

// Exactly 95 % for a linear model and any number of points; four standard deviations of 4000 repeats are 1.4
// %.
TEST(FitStatistics, IntervalsOfALinearModelContainTheTruthIn95PerCent) {
  const auto linear = [](const std::vector<double>& p, double x) { return p[0] + p[1] * x; };
  for (const double inside : coverage(linear, {{.start = 4}, {.start = 1}}, {2, -3}, points(5), 0.1,
                                      4000))  // three degrees of freedom
    EXPECT_NEAR(inside, 0.95, 0.014);
}

// A nonlinear one, with little noise: what its curvature takes is of the order of noise^2. 200 repeats alone
// would scatter by 1.5 %, so that a right interval would miss 93 to 97 % in one of five tries.
TEST(FitStatistics, IntervalsOfANonlinearModelContainTheTruthIn93To97PerCent) {
  const auto decay = [](const std::vector<double>& p, double x) { return p[0] * std::exp(-p[1] * x); };
  const std::vector<fit::Searched> linear{{.start = 2}, {.start = 0.5}},
      logarithmic{{.start = 2, .logarithmic = true}, {.start = 0.5, .logarithmic = true}};
  for (const auto& searched : {linear, logarithmic})
    for (const double inside : coverage(decay, searched, {1.3, 0.9}, points(12), 0.02, 2000)) {
      EXPECT_GT(inside, 0.93);
      EXPECT_LT(inside, 0.97);
    }
}

}  // namespace
}  // namespace vbond::fit_statistics_test
