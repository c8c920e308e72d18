#include "vbond/fit/fit.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "temporary_folder.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"

/// Fits of runs: points are made by a run with known values.
namespace vbond::fit_test {
namespace {

/// A short rod in SI units: pulled by 46e-6 m in the first stage, bent by some 2e-4 m in the second, of which
/// shear is 2e-6 m.
std::string rod(double k_n, double k_s) {
  return fmt::format(R"(
[units]
system = "SI"
[[specimen]]
kind = "rod"
particles = 4
spacing = "2 mm"
radius = "1 mm"
density = "900 kg/m^3"
[[bonds]]
name = "fibre"
gap = 0
attach = "neck"
theory = "parallel"
k_n = "{} GN/m^3"   # as a published value stands
k_s = {:.1f}
section = {{shape = "circle", diameter = "1.5 mm"}}
[[stage]]
name = "pull"
kind = "equilibrium"
supports = [{{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}}]
loads = [{{group = "last", force = [1, 0, 0]}}]
steps = 4
[[stage]]
name = "bend"
kind = "equilibrium"
supports = [{{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}}]
loads = [{{group = "last", force = [0, 0, 0.05]}}]
steps = 4
[output]
history = {{displacements = ["last"]}}
)",
                     k_n, k_s);
}

/// True values: 36.7 GN/m^3 and 3.42e10 N/m^3.
constexpr double k_n = 36.7, k_s = 3.42e10;

class Fit : public ::testing::Test {
 protected:
  Fit() : folder_("vbond_fit") {}

  /// Points of a run with the true values, at the load factors of its rows and between, with noise.
  void measure(double noise, unsigned seed, int each = 1) {
    const fit::Rows rows =
        fit::run_case({rod(k_n, k_s), "true.toml"}, {},
                      {"load_factor", "displacement.last.x", "displacement.last.z"}, 1, {});
    std::mt19937 dice(seed);
    std::normal_distribution<double> normal;
    std::ofstream data(folder_ / "data.csv");
    data << "stage,load_factor,ux [mm],uz [mm]\n";
    for (std::size_t k = 0; k < rows.stage.size(); ++k)
      for (int n = 0; n < each && rows.columns[0][k] > 0; ++n)
        data << fmt::format("{},{},{},{}\n", rows.stage[k] == 0 ? "pull" : "bend", rows.columns[0][k],
                            1e3 * (rows.columns[1][k] + noise * normal(dice)),
                            1e3 * (rows.columns[2][k] + noise * normal(dice)));
  }
  fit::Task task(double start_k_n, double start_k_s,
                 std::vector<std::string> vary = {"bonds[fibre].k_n", "bonds[0].k_s=log"},
                 const std::string& sigma = "1e-8") {
    std::ofstream(folder_ / "start.toml") << rod(start_k_n, start_k_s);
    return fit::make_task(folder_ / "start.toml", folder_ / "data.csv", vary, "load_factor",
                          {"displacement.last.x=ux [mm]", "displacement.last.z=uz [mm]"}, {sigma, sigma}, {});
  }
  test::TemporaryFolder folder_;
};

// Noise-free points at the rows of the run: found as exactly as equilibria are computed.
TEST_F(Fit, FindsTheValuesOfTensionAndBendingFromTwiceAndHalf) {
  measure(0, 1);
  for (const auto& [a, b] : {std::pair{2.0, 0.5}, std::pair{0.5, 2.0}, std::pair{2.0, 2.0}}) {
    const auto found = fit::fit(task(a * k_n, b * k_s), {});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->found.end, fit::SearchEnd::converged) << found->found.why;
    EXPECT_NEAR(found->values[0].value / k_n, 1, 1e-7);
    EXPECT_NEAR(found->values[1].value / k_s, 1, 1e-6);
    EXPECT_TRUE(found->left_out.empty());
    EXPECT_LE(found->values[0].least_tried, std::min(a * k_n, k_n));
  }
}

TEST_F(Fit, GivesTheSameBitsWithAnyThreadsAndFromKnownRuns) {
  measure(1e-8, 5);
  const fit::Task t = task(2 * k_n, 0.5 * k_s);
  std::vector<fit::Tried> kept;
  fit::Options options;
  options.keep = [&kept](const fit::Tried& run) { kept.push_back(run); };
  const auto one = fit::fit(t, options);
  options.threads = 3, options.keep = {};
  const auto three = fit::fit(t, options);
  EXPECT_EQ(one->runs, kept.size() + 1);  // the last one again, for its rows
  fit::Options again;
  again.known = kept;
  const auto known = fit::fit(t, again);
  EXPECT_EQ(known->runs, 1u);
  for (const auto& other : {three, known}) {
    EXPECT_EQ(one->found.values, other->found.values);
    EXPECT_EQ(one->found.jacobian, other->found.jacobian);
    EXPECT_EQ(one->statistics.standard_error, other->statistics.standard_error);
    EXPECT_EQ(one->fitted, other->fitted);
  }
}

TEST_F(Fit, WritesTheCaseWithItsValuesAndNothingElse) {
  measure(0, 1);
  const fit::Task t = task(20, 4e10);
  EXPECT_EQ(fit::with_values(t, {36.7, 3.42e10}), rod(36.7, 3.42e10));
  const std::vector<std::string> changes{"bonds[fibre].k_n=\"36.7 GN/m^3\"", "bonds[0].k_s=34200000000.0"};
  Case changed = parse_case(t.case_text.text, "a.toml", changes);
  changed.changes.clear();
  EXPECT_EQ(to_toml(parse_case(fit::with_values(t, {36.7, 3.42e10}), "a.toml")), to_toml(changed));
}

// In tension k_n and the area are one number; the diameter goes in as its square.
TEST_F(Fit, NamesWhatTensionCannotTellApart) {
  measure(1e-7, 3);
  std::ofstream(folder_ / "start.toml") << rod(30, k_s);
  const auto found = fit::fit(fit::make_task(folder_ / "start.toml", folder_ / "data.csv",
                                             {"bonds[0].k_n", "bonds[0].section.diameter", "bonds[0].k_s"},
                                             "load_factor", {"displacement.last.x=ux [mm]"}, {}, "pull"),
                              {});
  ASSERT_EQ(found->statistics.not_told_apart.size(), 1u);
  EXPECT_EQ(found->statistics.not_told_apart[0], (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(found->statistics.no_effect, std::vector<std::size_t>{2});
  for (const fit::FoundValue& v : found->values) EXPECT_TRUE(std::isnan(v.standard_error));
  // what they have in common is found: k_n d^2, to five times the noise of 1e-7 m in a stretch of 46e-6 m
  const double product = found->values[0].value * found->values[1].value * found->values[1].value;
  EXPECT_NEAR(product / (k_n * 1.5 * 1.5), 1, 0.011);
}

// The sign of a correlation is that of the values, on either scale: bending goes as force / k_n.
TEST_F(Fit, CorrelationsOfNegativeValuesOnALogarithmicScaleHaveTheirSign) {
  measure(1e-8, 5);
  std::string text = rod(30, k_s);
  text.replace(text.find("0.05]"), 5, "-0.04]");
  std::ofstream(folder_ / "start.toml") << text;
  std::string data = "stage,load_factor,ux [mm],uz [mm]\n";  // bent to the other side
  std::ifstream measured(folder_ / "data.csv");
  std::string line;
  std::getline(measured, line);
  while (std::getline(measured, line)) {
    const std::size_t last = line.rfind(',') + 1;
    data += line.substr(0, last) + fmt::format("{}\n", -std::stod(line.substr(last)));
  }
  measured.close();
  std::ofstream(folder_ / "data.csv") << data;
  const auto correlation = [&](const std::string& scale) {
    const auto found = fit::fit(
        fit::make_task(folder_ / "start.toml", folder_ / "data.csv",
                       {"bonds[0].k_n", "stage[bend].loads[0].force[2]" + scale}, "load_factor",
                       {"displacement.last.x=ux [mm]", "displacement.last.z=uz [mm]"}, {"1e-8", "1e-8"}, {}),
        {});
    EXPECT_NEAR(found->values[1].value, -0.05, 1e-4);
    EXPECT_DOUBLE_EQ(found->statistics.correlation[3], 1);
    return found->statistics.correlation[1];
  };
  const double linear = correlation("");
  EXPECT_LT(linear, -0.3);
  EXPECT_NEAR(correlation("=log"), linear, 1e-5);
}

// Runs of an earlier try with wider bounds: none of them may become the result, nor be told.
TEST_F(Fit, TakesNoKnownRunsOutsideTheBounds) {
  measure(0, 1);
  std::vector<fit::Tried> kept;
  fit::Options options;
  options.keep = [&kept](const fit::Tried& run) { kept.push_back(run); };
  fit::fit(task(2 * k_n, k_s), options);
  fit::Options again;
  again.known = kept;
  again.search.interrupted = [] { return true; };  // as soon as the start is known: the best so far is taken
  const auto found = fit::fit(task(2 * k_n, k_s, {"bonds[0].k_n=range(50, )", "bonds[0].k_s=log"}), again);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->found.end, fit::SearchEnd::interrupted);
  EXPECT_GE(found->values[0].value, 50);
  EXPECT_GE(found->values[0].least_tried, 50);
  EXPECT_LT(found->known, kept.size());
}

TEST_F(Fit, RefusesWhatCannotBeFitted) {
  measure(0, 1);
  const auto refusal = [&](const auto& make) -> std::string {
    try {
      fit::fit(make(), {});
    } catch (const CaseError& e) {
      return e.what();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  const auto vary = [&](std::vector<std::string> keys) { return [=, this] { return task(20, 4e10, keys); }; };
  EXPECT_NE(refusal(vary({"bonds[0].k_n=range(30, 40)"})).find("must lie within the bounds"),
            std::string::npos);
  EXPECT_NE(refusal(vary({"bonds[0].k_n=range(30 mm, 40)"})).find("of another dimension"), std::string::npos);
  EXPECT_NE(refusal(vary({"bonds[0].k_n=range(40, 10)"})).find("below the upper one"), std::string::npos);
  EXPECT_NE(refusal(vary({"bonds[0].k_n=logrange(-1, 40)"})).find("one sign"), std::string::npos);
  EXPECT_NE(refusal(vary({"bonds[0].k_n=wide"})).find("write KEY"), std::string::npos);
  EXPECT_NE(refusal(vary({"bonds[0].k_n", "bonds[fibre].k_n"})).find("varied already"), std::string::npos);
  EXPECT_NE(refusal(vary({"stage[bend].loads[0].force[0]"})).find("a start of 0"), std::string::npos);
  const auto compare = [&](const std::string& x, std::vector<std::string> y,
                           std::optional<std::string> stage) {
    return [=, this] {
      task(20, 4e10);
      return fit::make_task(folder_ / "start.toml", folder_ / "data.csv", {"bonds[0].k_n"}, x, y, {}, stage);
    };
  };
  EXPECT_NE(refusal(compare("load_factor", {"displacement.lst.x=ux [mm]"}, {}))
                .find("did you mean displacement.last.x?"),
            std::string::npos);
  EXPECT_NE(
      refusal(compare("load_factor", {"displacement.last.x=ux [mm]", "displacement.last.z=uz [mm]"}, {}))
          .find("give --sigma for each"),
      std::string::npos);
  EXPECT_NE(refusal(compare("load_factor=stage", {"displacement.last.x=ux [mm]"}, {})).find("data.csv:2:1"),
            std::string::npos);
}

// Two stages of load factors from 0 to 1: along all rows it goes back. And points beyond the run.
TEST_F(Fit, RefusesCurvesThatGoBackAndTellsOfPointsBeyondTheRun) {
  std::ofstream(folder_ / "start.toml") << rod(20, k_s);
  const auto fit_of = [&](const std::string& data, std::optional<std::string> stage) {
    std::ofstream(folder_ / "data.csv") << data;
    return fit::fit(fit::make_task(folder_ / "start.toml", folder_ / "data.csv", {"bonds[0].k_n"},
                                   "load_factor", {"displacement.last.x=ux"}, {}, stage),
                    {});
  };
  EXPECT_THROW(fit_of("load_factor,ux\n0.5,1e-5\n1,2e-5\n", {}), CaseError);
  const auto found = fit_of("load_factor,ux\n0.5,1e-5\n1,2.1e-5\n1.5,3e-5\n", "pull");
  ASSERT_EQ(found->left_out.size(), 1u);
  EXPECT_EQ(found->left_out[0].line, 4u);
  EXPECT_EQ(found->points.size(), 2u);
  EXPECT_THROW(fit_of("load_factor,ux\n1.5,3e-6\n", "pull"), CaseError);
}

// Two stages, two values, noise: the minimum is the same, and so are errors, but for what central differences
// are off, 1e-6. Beside the start there are two runs for each value, and then none.
TEST_F(Fit, DerivativesByTangentsLeadToTheSameValuesWithFewerRuns) {
  std::size_t with = 0, without = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    measure(1e-8, seed);
    const fit::Task t = task(1.5 * k_n, 0.6 * k_s);
    fit::Options by_differences;
    by_differences.search.exact = false;
    const auto exact = fit::fit(t, {}), other = fit::fit(t, by_differences);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_TRUE(exact->found.derivatives[j].exact) << exact->found.derivatives[j].why_not;
      EXPECT_FALSE(other->found.derivatives[j].exact);
      EXPECT_NEAR(exact->values[j].value / other->values[j].value, 1, 1e-7);
      EXPECT_NEAR(exact->values[j].standard_error / other->values[j].standard_error, 1, 1e-5);
    }
    with += exact->runs, without += other->runs;
  }
  EXPECT_LT(2 * with, without);
  std::printf("%zu runs by tangents, %zu by differences\n", with, without);
}

// Of runs, as the statistics alone are judged in statistics_test.cpp. Two hundred repeats scatter by 1.5 %.
TEST_F(Fit, IntervalsContainTheTruth) {
  const char* campaign = std::getenv("VBOND_CAMPAIGN");
  const int repeats = campaign != nullptr ? std::atoi(campaign) : 20;
  int inside[2] = {0, 0};
  for (int seed = 0; seed < repeats; ++seed) {
    measure(1e-8, static_cast<unsigned>(seed));
    const auto found = fit::fit(task(1.2 * k_n, 0.9 * k_s), {});
    ASSERT_EQ(found->found.end, fit::SearchEnd::converged) << seed;
    for (std::size_t j = 0; j < 2; ++j)
      inside[j] +=
          found->values[j].low <= (j == 0 ? k_n : k_s) && (j == 0 ? k_n : k_s) <= found->values[j].high;
  }
  for (const int n : inside) {  // four standard deviations of the count
    const double four = 4 * std::sqrt(0.95 * 0.05 * repeats);
    EXPECT_GE(n, 0.95 * repeats - four);
    EXPECT_LE(n, 0.95 * repeats + four);
    std::printf("%d of %d intervals contain the truth\n", n, repeats);
  }
}

}  // namespace
}  // namespace vbond::fit_test
