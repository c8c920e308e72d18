#include "vbond/fit/search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

/// The search, with formulas in place of runs.
namespace vbond::fit_search_test {
namespace {

using fit::Found;
using fit::Searched;
using fit::SearchEnd;

const std::vector<double> places{0.1, 0.4, 0.7, 1.1, 1.6, 2.2};

std::vector<double> decay(const std::vector<double>& p) {
  std::vector<double> y;
  for (const double x : places) y.push_back(p[0] * std::exp(-p[1] * x));
  return y;
}

/// Curves of decay(), none where `fails` says so.
fit::Curves curves(std::function<bool(const std::vector<double>&)> fails = {}) {
  return [fails](const std::vector<std::vector<double>>& all) {
    std::vector<fit::Trial> trials;
    for (const auto& p : all)
      trials.push_back(fails && fails(p) ? fit::Trial{{}, "it fails"} : fit::Trial{decay(p), ""});
    return trials;
  };
}

const std::vector<double> truth{1.3, 0.9}, sigma(6, 1.0);

TEST(FitSearch, FindsTheTruthOnEitherScale) {
  for (const bool logarithmic : {false, true})
    for (const double factor : {0.5, 2.0}) {
      const std::vector<Searched> values{{.start = factor * truth[0], .logarithmic = logarithmic},
                                         {.start = factor * truth[1], .logarithmic = logarithmic}};
      const Found found = fit::search(values, decay(truth), sigma, curves(), {});
      EXPECT_EQ(found.end, SearchEnd::converged) << found.why;
      for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(found.values[j] / truth[j], 1, 1e-9);
    }
}

// d y / d (p_0 / scale) = y scale / p_0; d y / d p_1 = -x y. By central differences to h^2/6 of the third
// derivative.
TEST(FitSearch, JacobianIsThatOfTheUnknowns) {
  const std::vector<Searched> values{{.start = 2.6}, {.start = 0.9, .logarithmic = true}};
  const Found found = fit::search(values, decay(truth), {2, 2, 2, 2, 2, 2}, curves(), {});
  ASSERT_EQ(found.jacobian.size(), 12u);
  for (std::size_t i = 0; i < 6; ++i) {
    const double y = decay(truth)[i];
    EXPECT_NEAR(found.jacobian[2 * i] / (y * 2.6 / 1.3 / 2), 1, 1e-6);
    EXPECT_NEAR(found.jacobian[2 * i + 1] / (-places[i] * y * 0.9 / 2), 1, 1e-6);
  }
}

TEST(FitSearch, StaysWithinBoundsAndEndsOnThem) {
  std::vector<Searched> values{{.start = 1}, {.start = 2, .low = 1.5, .high = 3}};
  const auto within = [](const std::vector<double>& p) {
    EXPECT_GE(p[1], 1.5);
    EXPECT_LE(p[1], 3.0);
    return false;
  };
  const Found found = fit::search(values, decay(truth), sigma, curves(within), {});
  EXPECT_EQ(found.values[1], 1.5);  // to the bit
  double y2 = 0, yd = 0;            // the other one is then linear least squares
  for (std::size_t i = 0; i < 6; ++i) {
    const double e = std::exp(-1.5 * places[i]);
    y2 += e * e, yd += e * decay(truth)[i];
  }
  EXPECT_NEAR(found.values[0], yd / y2, 1e-6 * yd / y2);
}

// The first steps from a decay much too quick go far below zero, where there is no curve: the search turns
// back.
TEST(FitSearch, GoesAroundValuesThatFail) {
  int failed = 0;
  const auto fails = [&failed](const std::vector<double>& p) { return p[1] < 0.3 && ++failed > 0; };
  const Found found = fit::search({{.start = 1.3}, {.start = 3}}, decay(truth), sigma, curves(fails), {});
  EXPECT_EQ(found.end, SearchEnd::converged) << found.why;
  EXPECT_NEAR(found.values[0], 1.3, 1e-8);
  EXPECT_GT(failed, 1);  // not the step of a difference alone
  EXPECT_TRUE(found.one_sided.empty() && found.held.empty());
  const auto near = [](const std::vector<double>& p) { return p[0] > 1.3005; };  // within the step of 1e-3
  const Found beside = fit::search({{.start = 1.2}, {.start = 0.9}}, decay(truth), sigma, curves(near), {});
  EXPECT_EQ(beside.one_sided.size(), 1u);
  EXPECT_EQ(beside.end, SearchEnd::converged);
  EXPECT_NEAR(beside.values[0], 1.3, 1e-8);
}

// Negative values on a logarithmic scale, of which u = ln(value / start) falls as the value rises: open
// bounds lie on the other side, and the truth of -1.3 is found or the bound that is in its way.
TEST(FitSearch, NegativeValuesOnALogarithmicScaleKeepTheirBounds) {
  constexpr double open = std::numeric_limits<double>::infinity();
  const std::vector<double> below{-1.3, 0.9};
  const auto found = [&](double start, double low, double high) {
    const auto within = [&](const std::vector<double>& p) {
      EXPECT_TRUE(low <= p[0] && p[0] <= high) << p[0] << " is not from " << low << " to " << high;
      return false;
    };
    const Found all =
        fit::search({{.start = start, .low = low, .high = high, .logarithmic = true}, {.start = 0.9}},
                    decay(below), sigma, curves(within), {});
    EXPECT_EQ(all.end, SearchEnd::converged) << all.why;
    return all.values[0];
  };
  EXPECT_NEAR(found(-2, -3, open), -1.3, 1e-8);
  EXPECT_NEAR(found(-0.5, -3, open), -1.3, 1e-8);
  EXPECT_EQ(found(-0.5, -1, open), -1);
  EXPECT_NEAR(found(-2, -open, -1), -1.3, 1e-8);
  EXPECT_NEAR(found(-5, -open, -1), -1.3, 1e-8);
  EXPECT_EQ(found(-5, -open, -2), -2);
}

/// The same with the slopes of decay(), of the second value wrong by this factor, where one set is asked for.
fit::Curves curves_with_slopes(double factor, std::size_t& sets) {
  return [factor, &sets](const std::vector<std::vector<double>>& all) {
    std::vector<fit::Trial> trials;
    sets += all.size();
    for (const auto& p : all) {
      fit::Trial& t = trials.emplace_back(fit::Trial{decay(p), ""});
      if (all.size() > 1) continue;
      t.slopes.resize(2), t.no_slope.resize(2);
      for (const double x : places) {
        t.slopes[0].push_back(std::exp(-p[1] * x));
        t.slopes[1].push_back(-factor * x * p[0] * std::exp(-p[1] * x));
      }
    }
    return trials;
  };
}

// Four runs beside the start compare them; then none is beside. They lead to the same values and the same
// Jacobian, to what central differences are off: h^2/6 of the third derivative, 1e-6.
TEST(FitSearch, TakesSlopesThatDifferencesConfirm) {
  for (const bool logarithmic : {false, true}) {
    const std::vector<Searched> values{{.start = 2.6}, {.start = 0.6, .logarithmic = logarithmic}};
    std::size_t with = 0, without = 0;
    fit::SearchOptions by_differences;
    by_differences.exact = false;
    const Found exact = fit::search(values, decay(truth), sigma, curves_with_slopes(1, with), {}),
                other =
                    fit::search(values, decay(truth), sigma, curves_with_slopes(1, without), by_differences);
    for (const fit::Derivative& d : exact.derivatives) {
      EXPECT_TRUE(d.exact) << d.why_not;
      EXPECT_LT(d.off, 1e-5);
    }
    for (const fit::Derivative& d : other.derivatives) EXPECT_EQ(d.why_not, "differences are asked for");
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(exact.values[k] / truth[k], 1, 1e-9);
    double size = 0;
    for (const double x : other.jacobian) size = std::max(size, std::abs(x));
    for (std::size_t k = 0; k < other.jacobian.size(); ++k)
      EXPECT_NEAR(exact.jacobian[k], other.jacobian[k], 1e-5 * size);
    EXPECT_LT(2 * with, without);
  }
}

// One in a hundred off is more than differences are: that value goes by differences, the other one does not.
TEST(FitSearch, PassesOverSlopesThatAreWrong) {
  std::size_t sets = 0;
  const Found found =
      fit::search({{.start = 2.6}, {.start = 0.6}}, decay(truth), sigma, curves_with_slopes(1.01, sets), {});
  EXPECT_TRUE(found.derivatives[0].exact);
  EXPECT_FALSE(found.derivatives[1].exact);
  EXPECT_NEAR(found.derivatives[1].off, 0.01, 1e-5);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(found.values[k] / truth[k], 1, 1e-9);
}

// exp(200 p) by central differences of 1e-3 is 0.2^2 / 6 off, a hundredth of that with a tenth of the step:
// the slopes are right, and are taken.
TEST(FitSearch, ComparesAgainWithAShorterStep) {
  const auto curve = [](const std::vector<std::vector<double>>& all) {
    std::vector<fit::Trial> trials;
    for (const auto& p : all) {
      fit::Trial& t = trials.emplace_back();
      t.slopes.resize(1), t.no_slope.resize(1);
      for (const double x : places)
        t.curve.push_back(x * std::exp(200 * (p[0] - 1))), t.slopes[0].push_back(200 * t.curve.back());
    }
    return trials;
  };
  const Found found = fit::search({{.start = 1}}, places, sigma, curve, {});
  EXPECT_TRUE(found.derivatives[0].exact) << found.derivatives[0].why_not;
  EXPECT_NEAR(found.derivatives[0].off, 0.02 * 0.02 / 6, 1e-7);
}

// Away from the start the first value has no slope: its derivatives are differences, and are told as such.
TEST(FitSearch, SaysWhereSlopesWereNotThere) {
  std::size_t sets = 0;
  const auto with = curves_with_slopes(1, sets);
  const auto fewer = [&](const std::vector<std::vector<double>>& all) {
    auto trials = with(all);
    if (all.size() == 1 && all[0][0] != 2.6)
      trials[0].slopes[0].clear(), trials[0].no_slope[0] = "it is late";
    return trials;
  };
  const Found found = fit::search({{.start = 2.6}, {.start = 0.6}}, decay(truth), sigma, fewer, {});
  const fit::Derivative &one = found.derivatives[0], &other = found.derivatives[1];
  EXPECT_TRUE(one.exact && other.exact && other.last_exact);
  EXPECT_FALSE(one.last_exact);
  EXPECT_EQ(one.fell_back_why, "it is late");
  EXPECT_GT(one.fell_back, 1u);
  EXPECT_LT(one.fell_back, one.times);
  EXPECT_EQ(other.fell_back, 0u);
}

// The curve moves by rounding that is a thousandth of it and changes 1000 times within a step of differences:
// what differences say is none of its derivatives, and differs with their step.
TEST(FitSearch, TellsWhereDifferencesContradictEachOther) {
  std::size_t sets = 0;
  const auto with = curves_with_slopes(1, sets);
  for (const double rough : {0.0, 1e-3}) {
    const auto moving = [&](const std::vector<std::vector<double>>& all) {
      auto trials = with(all);
      for (std::size_t k = 0; k < all.size(); ++k)
        for (double& y : trials[k].curve) y += rough * std::sin(1e6 * all[k][0]);
      return trials;
    };
    const Found found = fit::search({{.start = 2.6}, {.start = 0.6}}, decay(truth), sigma, moving, {});
    EXPECT_EQ(found.derivatives[0].contradicted, rough > 0);
    EXPECT_EQ(fit::any_contradicted(found), rough > 0);
    EXPECT_FALSE(found.derivatives[1].contradicted);
  }
}

// A value without effect has nothing to compare: 1e-9 of the curve over the step is the error of runs.
TEST(FitSearch, ComparesNoSlopesWithoutEffect) {
  const auto curve = [](const std::vector<std::vector<double>>& all) {
    std::vector<fit::Trial> trials;
    for (const auto& p : all) {
      fit::Trial& t = trials.emplace_back(fit::Trial{decay(truth), ""});
      t.curve[0] += 1e-13 * p[0];
      t.slopes.resize(1, std::vector<double>(places.size(), 1e-20)), t.no_slope.resize(1);
    }
    return trials;
  };
  const Found found = fit::search({{.start = 1}}, decay(truth), sigma, curve, {});
  EXPECT_TRUE(found.derivatives[0].exact);
  EXPECT_TRUE(std::isnan(found.derivatives[0].off));
}

TEST(FitSearch, RefusesAStartOutsideItsBounds) {
  for (const Searched& outside : {Searched{.start = 1, .low = 2}, Searched{.start = 1, .high = 0.5}})
    EXPECT_THROW(fit::search({outside, {.start = 1}}, decay(truth), sigma, curves(), {}),
                 std::invalid_argument);
}

// The truth of 1.3 lies where every run fails: the search comes to the edge of it, and may not pass it for a
// minimum. The other value goes to its own least squares beside it.
TEST(FitSearch, SaysThatRunsThatFailHoldIt) {
  for (const bool logarithmic : {false, true}) {
    const auto beyond = [](const std::vector<double>& p) { return p[0] > 1.1; };
    const Found found = fit::search({{.start = 0.8, .logarithmic = logarithmic}, {.start = 0.9}},
                                    decay(truth), sigma, curves(beyond), {});
    EXPECT_EQ(found.end, SearchEnd::held) << found.why;
    EXPECT_NE(found.why.find("it fails"), std::string::npos);
    ASSERT_EQ(found.held.size(), 2u);
    EXPECT_TRUE(found.held[0]);
    EXPECT_LE(found.values[0], 1.1);
  }
}

TEST(FitSearch, SaysWhereThereIsNoDerivative) {
  const auto fails = [](const std::vector<double>& p) { return p[1] != 0.9; };
  const Found found = fit::search({{.start = 1}, {.start = 0.9}}, decay(truth), sigma, curves(fails), {});
  EXPECT_EQ(found.end, SearchEnd::no_derivative);
  EXPECT_NE(found.why.find("it fails"), std::string::npos) << found.why;
  EXPECT_TRUE(found.jacobian.empty());
}

TEST(FitSearch, StopsWhenAskedAndAfterTheIterationsGiven) {
  int asked = 0;
  const Found stopped = fit::search({{.start = 5}, {.start = 5}}, decay(truth), sigma, curves(),
                                    {.interrupted = [&asked] { return ++asked > 6; }});
  EXPECT_EQ(stopped.end, SearchEnd::interrupted);
  const Found one =
      fit::search({{.start = 5}, {.start = 5}}, decay(truth), sigma, curves(), {.most_iterations = 1});
  EXPECT_EQ(one.end, SearchEnd::iterations);
}

TEST(FitSearch, PassesOnWhatCurvesThrow) {
  const fit::Curves broken = [n = 0](const auto& all) mutable -> std::vector<fit::Trial> {
    if (++n > 1) throw std::runtime_error("disk");
    return std::vector<fit::Trial>(all.size(), fit::Trial{decay({1, 1}), ""});
  };
  EXPECT_THROW(fit::search({{.start = 1}, {.start = 1}}, decay(truth), sigma, broken, {}),
               std::runtime_error);
}

}  // namespace
}  // namespace vbond::fit_search_test
