#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

/// The search for the least sum of squares: Levenberg and Marquardt's, by Ceres. It knows no runs.
namespace vbond::fit {

/// A value that is searched. low <= start <= high; on a logarithmic scale all of one sign, not zero.
struct Searched {
  double start = 0;
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool logarithmic = false;
  /// What the search counts in: the size of the start, or of the bounds where that is zero; unit of the
  /// value.
  double scale() const;
};

/// The curve at some values: at each of the points, or why there is none.
struct Trial {
  std::vector<double> curve;  ///< empty: there is none
  std::string failure;
  /// Of each value d curve / d value, exact; an empty one, or none: not known, for a reason in no_slope.
  std::vector<std::vector<double>> slopes = {};
  std::vector<std::string> no_slope = {};
  bool failed() const { return curve.empty(); }
};

/// Of each of several sets of values its trial. It may compute them in any order, or know them already.
/// Slopes are of use where it is asked for one set alone.
using Curves = std::function<std::vector<Trial>(const std::vector<std::vector<double>>&)>;

struct Iteration {
  int number = 0;
  double sum_of_squares = 0;  ///< of weighted residuals
  bool accepted = true;
  std::vector<double> values;  ///< the best so far
};

struct SearchOptions {
  int most_iterations = 50;
  /// Step of differences, relative: of ln(value) on a logarithmic scale, else of the value, or of a tenth of
  /// scale() where it is less. Central differences of a curve with a relative error e are best near cbrt(3
  /// e): 1e-3 for the 3e-10 of an equilibrium. They are then wrong by 1e-6 of themselves at most.
  double difference = 1e-3;
  bool exact = true;  ///< slopes of trials are taken where they are given, else differences for all values
  std::function<bool()> interrupted = {};
  std::function<void(const Iteration&)> tell = {};  ///< each iteration as it ends
};

/// What the derivative with a value was.
struct Derivative {
  bool exact = false;  ///< the slopes of trials where there are some, else differences
  /// Of the slopes at the start from differences there, as a part of these; NaN: not compared, or the value
  /// has no effect there beyond the error of runs.
  double off = NAN;
  std::string why_not;  ///< not exact: the reason
  /// Not exact, and differences with a tenth of the step say something else: there is no derivative.
  bool contradicted = false;
  /// How often it was asked for; of these, though exact, by differences, for a reason such as the last.
  std::size_t times = 0, fell_back = 0;
  std::string fell_back_why = {};
  bool last_exact = false;  ///< the last one
};

enum class SearchEnd { converged, held, iterations, no_better, no_derivative, interrupted };

struct Found {
  std::vector<double> values;     ///< within the bounds
  std::vector<double> residuals;  ///< (curve - data) / sigma there
  std::vector<double>
      jacobian;  ///< points x values; of `residuals` by value / scale(), by ln(value) where logarithmic
  std::vector<Derivative> derivatives;  ///< of each value
  /// Of each value, if runs that fail held the search: whether it would go on into them. Else empty.
  std::vector<char> held;
  SearchEnd end = SearchEnd::converged;
  std::string why;  ///< in words
  std::vector<Iteration> iterations;
  std::vector<std::string>
      one_sided;  ///< failures beside an accepted point: there the derivative is one-sided
};

/// Whether there is no derivative with some value, so that no error of any can be told.
inline bool any_contradicted(const Found& found) {
  return std::any_of(found.derivatives.begin(), found.derivatives.end(),
                     [](const Derivative& d) { return d.contradicted; });
}

/// Searches from the starts; `data` and `sigma` as the curve, sigma > 0. Deterministic: the sets of values it
/// asks for depend on the trials alone. Throws what `curves` throws, std::invalid_argument if sizes do not
/// fit, if a start lies outside its bounds, or if there is no curve at the start.
Found search(const std::vector<Searched>& values, const std::vector<double>& data,
             const std::vector<double>& sigma, const Curves& curves, const SearchOptions& options);

}  // namespace vbond::fit
