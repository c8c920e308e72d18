#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "vbond/fit/search.hpp"

/// What the solver of a search sees of it: unknowns, residuals and their derivatives.
namespace vbond::fit {

/// The values as the search counts them: value / scale, or ln(value / start).
class Unknowns {
 public:
  explicit Unknowns(const std::vector<Searched>& values) : values_(values) {}
  std::size_t size() const { return values_.size(); }
  double unknown(std::size_t j, double value) const {
    const Searched& v = values_[j];
    return v.logarithmic ? std::log(value / v.start) : value / v.scale();
  }
  /// The bounds and the start come back to the bit: the case may accept no more.
  double value(std::size_t j, double u) const {
    const Searched& v = values_[j];
    if (u == unknown(j, v.start)) return v.start;
    if (u == unknown(j, v.low)) return v.low;
    if (u == unknown(j, v.high)) return v.high;
    return std::clamp(v.logarithmic ? v.start * std::exp(u) : u * v.scale(), v.low, v.high);
  }
  /// d value / d unknown.
  double rate(std::size_t j, double u) const {
    return values_[j].logarithmic ? value(j, u) : values_[j].scale();
  }
  double low(std::size_t j) const { return std::min(end(j, values_[j].low), end(j, values_[j].high)); }
  double high(std::size_t j) const { return std::max(end(j, values_[j].low), end(j, values_[j].high)); }
  std::vector<double> values(const double* u) const {
    std::vector<double> all;
    for (std::size_t j = 0; j < size(); ++j) all.push_back(value(j, u[j]));
    return all;
  }
  double step(std::size_t j, double u, double difference) const {
    return values_[j].logarithmic ? difference : difference * std::max(std::abs(u), 0.1);
  }

 private:
  double end(std::size_t j, double bound) const {
    if (values_[j].logarithmic && std::isinf(bound)) return values_[j].start > 0 ? bound : -bound;
    return unknown(j, bound);
  }
  const std::vector<Searched>& values_;
};

/// Residuals and their derivatives, by slopes or differences, in the unknowns. Keeps references.
class Residuals {
 public:
  Residuals(const Unknowns& unknowns, const std::vector<double>& data, const std::vector<double>& sigma,
            const Curves& curves, const SearchOptions& options)
      : unknowns_(unknowns), data_(data), sigma_(sigma), curves_(curves), options_(options) {}

  std::size_t points() const { return data_.size(); }
  bool interrupted() const { return options_.interrupted && options_.interrupted(); }

  /// False if there is no curve at u.
  bool at(const std::vector<double>& u, std::vector<double>& r);

  /// d r / d u of these unknowns, where at() has been: points x columns. All of them the first time: slopes
  /// that are given are then compared with differences.
  bool derivatives(const std::vector<double>& u, const std::vector<double>& r,
                   const std::vector<std::size_t>& columns, std::vector<double>& J);

  /// Whether a run failed no farther from u than the step of differences, in each unknown.
  bool failed_near(const std::vector<double>& u) const;
  /// Whether residuals are no more than the error of runs, so that nothing can be read from them.
  bool within_rounding(const std::vector<double>& r) const;

  std::exception_ptr failure;
  std::string why;
  bool no_derivative = false;
  int accepted_since_failure = 0;      ///< steps of the leg since one that led to a run that fails
  std::vector<std::string> one_sided;  ///< failures beside the last point with derivatives
  std::vector<Derivative> used;        ///< of each unknown; empty: none was asked for yet

 private:
  bool has_slope(const std::vector<double>& u, std::size_t j) const {
    return u == here_at_ && j < here_.slopes.size() && !here_.slopes[j].empty();
  }
  std::vector<double> slope_of(const std::vector<double>& u, std::size_t j) const;
  std::string why_no_slope(std::size_t j) const;
  void judge_slope(const std::vector<double>& u, const std::vector<double>& r, std::size_t j,
                   const std::vector<double>& by_difference);
  bool agrees(const std::vector<double>& u, const std::vector<double>& r, std::size_t j,
              const std::vector<double>& by_difference, double& off) const;
  bool compare_again(const std::vector<double>& u, const std::vector<double>& r,
                     const std::vector<std::size_t>& columns, const std::vector<double>& before);
  bool differences(const std::vector<double>& u, const std::vector<double>& r,
                   const std::vector<std::size_t>& columns, double step, std::vector<double>& J);
  std::pair<double, double> steps_at(std::size_t j, double u, double step) const;
  std::vector<double> weighted(const Trial& trial) const;
  double size_of_curve(const std::vector<double>& r) const;

  const Unknowns& unknowns_;
  const std::vector<double>&data_, &sigma_;
  const Curves& curves_;
  const SearchOptions& options_;
  std::vector<std::vector<double>> failed_at_;
  Trial here_;  ///< where at() has been last
  std::vector<double> here_at_;
};

}  // namespace vbond::fit
