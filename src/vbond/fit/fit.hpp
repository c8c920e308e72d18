#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/fit/case_run.hpp"
#include "vbond/fit/key_text.hpp"
#include "vbond/fit/measured.hpp"
#include "vbond/fit/search.hpp"
#include "vbond/fit/statistics.hpp"

/// Values of a case by which columns of history.csv follow measured points: `vbond fit`, docs/fit.md.
namespace vbond::fit {

/// A key of the case that is varied.
struct Varied {
  std::string key;
  NumberInText start;  ///< in the case file
  Searched searched;   ///< in the unit of the case file
};

/// What is fitted.
struct Task {
  CaseText case_text;
  std::vector<Varied> varied;
  std::filesystem::path data_file;
  Pair x;
  std::vector<Measured> measured;
  std::optional<std::string> stage;
  bool sigma_known() const { return !measured.front().sigma.empty(); }
};

/// "KEY", "KEY=log", "KEY=range(low, high)" or "KEY=logrange(low, high)", where low or high may be left
/// empty. Bounds without a unit are in that of the case. Throws CaseError or std::invalid_argument.
Varied varied_key(const std::string& text, const CaseText& c);

/// The parts put together and looked over: a case file that can be read, at least one value and one column,
/// each value once, standard deviations for all columns or, where there is one column, for none. Throws
/// CaseError, std::invalid_argument, IoError.
Task make_task(const std::filesystem::path& case_file, const std::filesystem::path& data_file,
               const std::vector<std::string>& vary, const std::string& x,
               const std::vector<std::string>& compare, const std::vector<std::string>& sigma,
               std::optional<std::string> stage);

/// The case file with these values, one for each that is varied, and nothing else changed. Throws CaseError
/// where the text does not take them.
std::string with_values(const Task& task, const std::vector<double>& values);

/// The changes of the case (case/read.hpp) that these values are.
std::vector<std::string> changes_to(const Task& task, const std::vector<double>& values);

/// The same for runs with slopes: each value a little more and less, by 2e-4 of itself.
std::vector<Nudge> nudges_of(const Task& task, const std::vector<double>& values);

/// A run of the search, as it is kept.
struct Tried {
  std::vector<double> values;
  Trial trial;
};

struct Options {
  SearchOptions search;
  int threads = 1;
  /// Of an earlier try at the same task: not run again. Those outside the bounds take no part.
  std::vector<Tried> known;
  std::function<void(const Tried&)> keep = {};  ///< each run as it ends, one at a time
};

/// What is found of a value.
struct FoundValue {
  double value = 0;
  double standard_error = 0;  ///< NaN: none; of ln(value) times the value on a logarithmic scale
  double low = 0, high = 0;   ///< of 95 %; NaN: none. Not symmetric on a logarithmic scale
  double least_tried = 0, largest_tried = 0;
  bool at_low = false, at_high = false;  ///< of its bounds
  bool held = false;                     ///< runs beyond it fail: Found::held
};

struct Result {
  std::vector<Point> points;          ///< those that took part
  std::vector<Point> left_out;        ///< beyond the rows of the run at the start
  std::vector<double> start, fitted;  ///< curves at the points, in the units of history.csv
  std::vector<FoundValue> values;
  Found found;
  Statistics statistics;  ///< by values, or their logarithms: Searched::logarithmic
  double deviation =
      0;                ///< of the residuals, in the unit of the column if sigma is not known, else in sigmas
  double runs_off = 0;  ///< the largest error of interpolation between rows, in such deviations
  std::size_t runs_off_at = 0;                  ///< at this point
  std::size_t runs = 0, failed = 0, known = 0;  ///< made now; of them failed; taken from an earlier try
  std::vector<std::string> failures;            ///< why, the first few kinds
  std::vector<std::string> passed_over;         ///< columns of the data
};

/// Fits. Throws what a run throws if there is none at the start, CaseError if the data do not suit the run
/// there (its column goes back, too few points), and what `keep` throws. An interruption before the start has
/// been computed: nothing.
std::optional<Result> fit(const Task& task, const Options& options);

}  // namespace vbond::fit
