#include "vbond/fit/residuals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace vbond::fit {
namespace {

constexpr double error_of_runs = 1e-9;  // of the curve

double apart(const std::vector<double>& one, const std::vector<double>& other) {
  double sum = 0;
  for (std::size_t i = 0; i < one.size(); ++i) sum += std::pow(one[i] - other[i], 2);
  return std::sqrt(sum);
}

/// A column of these derivatives of so many unknowns.
std::vector<double> column_of(const std::vector<double>& J, std::size_t columns, std::size_t k) {
  std::vector<double> column;
  for (std::size_t i = k; i < J.size(); i += columns) column.push_back(J[i]);
  return column;
}

}  // namespace

bool Residuals::at(const std::vector<double>& u, std::vector<double>& r) {
  Trial trial = curves_({unknowns_.values(u.data())}).front();
  if (trial.failed()) {
    why = trial.failure, accepted_since_failure = 0;
    failed_at_.push_back(u);
    return false;
  }
  r = weighted(trial);
  here_ = std::move(trial), here_at_ = u;
  return true;
}

bool Residuals::failed_near(const std::vector<double>& u) const {
  return std::any_of(failed_at_.begin(), failed_at_.end(), [&](const std::vector<double>& failed) {
    for (std::size_t j = 0; j < u.size(); ++j)
      if (std::abs(failed[j] - u[j]) > unknowns_.step(j, u[j], options_.difference)) return false;
    return true;
  });
}

bool Residuals::within_rounding(const std::vector<double>& r) const {
  double rr = 0;
  for (const double x : r) rr += x * x;
  return std::sqrt(rr) <= error_of_runs * size_of_curve(r);
}

double Residuals::size_of_curve(const std::vector<double>& r) const {
  double sum = 0;
  for (std::size_t i = 0; i < r.size(); ++i) sum += std::pow(r[i] + data_[i] / sigma_[i], 2);
  return std::sqrt(sum);
}

bool Residuals::derivatives(const std::vector<double>& u, const std::vector<double>& r,
                            const std::vector<std::size_t>& columns, std::vector<double>& J) {
  const bool first = used.empty();
  std::vector<std::size_t> by_differences;
  for (const std::size_t j : columns)
    if (first || !used[j].exact || !has_slope(u, j)) by_differences.push_back(j);
  one_sided.clear();
  std::vector<double> D;
  if (!differences(u, r, by_differences, options_.difference, D)) return false;
  if (first) used.resize(unknowns_.size());
  const std::size_t n = columns.size(), m = r.size(), nd = by_differences.size();
  J.assign(m * n, 0.0);
  for (std::size_t k = 0, d = 0; k < n; ++k) {
    if (d == nd || by_differences[d] != columns[k]) continue;
    std::vector<double> column(m);
    for (std::size_t i = 0; i < m; ++i) J[i * n + k] = column[i] = D[i * nd + d];
    ++d;
    if (first) judge_slope(u, r, columns[k], column);
  }
  if (first && !compare_again(u, r, columns, J)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t j = columns[k];
    Derivative& d = used[j];
    ++d.times;
    d.last_exact = d.exact && has_slope(u, j);
    if (d.exact && !d.last_exact) ++d.fell_back, d.fell_back_why = why_no_slope(j);
    if (!d.last_exact) continue;
    const std::vector<double> column = slope_of(u, j);
    for (std::size_t i = 0; i < m; ++i) J[i * n + k] = column[i];
  }
  return true;
}

std::vector<double> Residuals::slope_of(const std::vector<double>& u, std::size_t j) const {
  std::vector<double> slope = here_.slopes[j];
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] *= unknowns_.rate(j, u[j]) / sigma_[i];
  return slope;
}

std::string Residuals::why_no_slope(std::size_t j) const {
  if (!options_.exact) return "differences are asked for";
  return j < here_.no_slope.size() && !here_.no_slope[j].empty() ? here_.no_slope[j] : "no slope is known";
}

/// Whether the slopes of an unknown are what differences say: to a part in a thousand for the curvature, or
/// the square of the step if that is more, and to the error of runs, 1e-9 of the curve over the step. All are
/// lengths over sigma of all points together. A slope that leaves out some part of what the value does shows
/// here.
bool Residuals::agrees(const std::vector<double>& u, const std::vector<double>& r, std::size_t j,
                       const std::vector<double>& by_difference, double& off) const {
  const std::vector<double> slope = slope_of(u, j), nothing(slope.size(), 0.0);
  const double size = apart(by_difference, nothing), from_slope = apart(slope, by_difference);
  const double h = options_.difference, part = std::max(1e-3, h * h),
               of_runs = error_of_runs / h * size_of_curve(r);
  const bool no_effect = std::max(size, apart(slope, nothing)) <= of_runs;
  off = no_effect ? NAN : size > 0 ? from_slope / size : INFINITY;
  return from_slope <= part * size + of_runs;
}

void Residuals::judge_slope(const std::vector<double>& u, const std::vector<double>& r, std::size_t j,
                            const std::vector<double>& by_difference) {
  Derivative& d = used[j];
  if (has_slope(u, j)) d.exact = agrees(u, r, j, by_difference, d.off) && options_.exact;
  if (!d.exact) d.why_not = why_no_slope(j);
}

/// Slopes that are not what differences say (`before`: points x columns), with differences of a tenth of the
/// step: those were too long if these agree. Where the two differ from each other, neither is a derivative.
bool Residuals::compare_again(const std::vector<double>& u, const std::vector<double>& r,
                              const std::vector<std::size_t>& columns, const std::vector<double>& before) {
  std::vector<std::size_t> doubtful;
  for (const std::size_t j : columns)
    if (options_.exact && has_slope(u, j) && !used[j].exact) doubtful.push_back(j);
  if (doubtful.empty()) return true;
  const double h = 0.1 * options_.difference;
  const std::vector<std::string> kept = one_sided;
  std::vector<double> D;
  const bool known = differences(u, r, doubtful, h, D);
  one_sided = kept, no_derivative = false;
  if (interrupted()) return false;
  const std::size_t m = r.size(), nd = doubtful.size();
  for (std::size_t k = 0; k < nd; ++k) {
    Derivative& d = used[doubtful[k]];
    const double off_before = d.off;
    std::string again;
    if (known) {
      const std::vector<double> column = column_of(D, nd, k), nothing(m, 0.0);
      d.exact = agrees(u, r, doubtful[k], column, d.off);
      const auto at = std::find(columns.begin(), columns.end(), doubtful[k]) - columns.begin();
      const std::vector<double> wider = column_of(before, columns.size(), static_cast<std::size_t>(at));
      d.contradicted = !d.exact && apart(wider, column) > 0.1 * apart(column, nothing);
      again = fmt::format(", {:.2g} with steps of {:g}", d.off, h);
    }
    d.why_not = d.exact ? ""
                        : fmt::format(
                              "the tangent and runs beside the start do not say the same, {:.2g} "
                              "off with steps of {:g}{}; either may be wrong, as where rows are too "
                              "coarse, or move from run to run",
                              off_before, options_.difference, again);
  }
  return true;
}

/// By runs beside u.
bool Residuals::differences(const std::vector<double>& u, const std::vector<double>& r,
                            const std::vector<std::size_t>& columns, double step, std::vector<double>& J) {
  const std::size_t n = columns.size(), m = r.size();
  if (n == 0) return true;
  std::vector<std::vector<double>> points;
  std::vector<std::pair<double, double>> steps;
  for (const std::size_t j : columns) {
    steps.push_back(steps_at(j, u[j], step));
    for (const double h : {steps.back().first, steps.back().second}) {
      std::vector<double> beside = u;
      beside[j] += h;
      points.push_back(unknowns_.values(beside.data()));
    }
  }
  const std::vector<Trial> trials = curves_(points);
  if (interrupted()) return false;
  J.assign(m * n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const Trial &one = trials[2 * k], &other = trials[2 * k + 1];
    if (one.failed() && other.failed()) {
      why = one.failure, no_derivative = true;
      return false;
    }
    for (const Trial* t : {&one, &other})
      if (t->failed()) one_sided.push_back(t->failure);
    const auto [a, b] = steps[k];
    const std::vector<double> r_a = one.failed() ? r : weighted(one),
                              r_b = other.failed() ? r : weighted(other);
    // the slope at 0 of the parabola through 0, a and b; of a straight line where there is one of them only
    for (std::size_t i = 0; i < m; ++i) {
      const double to_a = (r_a[i] - r[i]) / a, to_b = (r_b[i] - r[i]) / b;
      J[i * n + k] = one.failed() ? to_b : other.failed() ? to_a : (b * to_a - a * to_b) / (b - a);
    }
  }
  return true;
}

/// To both sides, or twice to one where a bound is near.
std::pair<double, double> Residuals::steps_at(std::size_t j, double u, double step) const {
  const double room = unknowns_.high(j) - unknowns_.low(j),
               h = std::min(unknowns_.step(j, u, step), 0.25 * room);
  if (u + h > unknowns_.high(j)) return {-h, -2 * h};
  if (u - h < unknowns_.low(j)) return {h, 2 * h};
  return {-h, h};
}

std::vector<double> Residuals::weighted(const Trial& trial) const {
  if (trial.curve.size() != data_.size()) throw std::invalid_argument("a curve has a number for each point");
  std::vector<double> r(data_.size());
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = (trial.curve[i] - data_[i]) / sigma_[i];
  return r;
}

}  // namespace vbond::fit
