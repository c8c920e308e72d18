#include "vbond/fit/residuals.hpp"

#include <stdexcept>

namespace vbond::fit {

bool Residuals::at(const std::vector<double>& u, std::vector<double>& r) {
  Trial trial = curves_({unknowns_.values(u.data())}).front();
  if (trial.failed()) {
    why = trial.failure, accepted_since_failure = 0;
    return false;
  }
  r = weighted(trial);
  here_ = std::move(trial), here_at_ = u;
  return true;
}

bool Residuals::derivatives(const std::vector<double>& u, const std::vector<double>& r,
                            const std::vector<std::size_t>& columns, std::vector<double>& J) {
  const bool first = used.empty();
  std::vector<std::size_t> by_differences;
  for (const std::size_t j : columns)
    if (first || !used[j].exact || !has_slope(u, j)) by_differences.push_back(j);
  one_sided.clear();
  std::vector<double> D;
  if (!differences(u, r, by_differences, D)) return false;
  if (first) used.resize(unknowns_.size());
  const std::size_t n = columns.size(), m = r.size(), nd = by_differences.size();
  J.assign(m * n, 0.0);
  for (std::size_t k = 0, d = 0; k < n; ++k) {
    const std::size_t j = columns[k];
    std::vector<double> column(m);
    if (d < nd && by_differences[d] == j) {
      for (std::size_t i = 0; i < m; ++i) column[i] = D[i * nd + d];
      ++d;
      if (first) judge_slope(u, r, j, column);
    }
    if (used[j].exact && has_slope(u, j)) column = slope_of(u, j);
    for (std::size_t i = 0; i < m; ++i) J[i * n + k] = column[i];
  }
  return true;
}

std::vector<double> Residuals::slope_of(const std::vector<double>& u, std::size_t j) const {
  std::vector<double> slope = here_.slopes[j];
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] *= unknowns_.rate(j, u[j]) / sigma_[i];
  return slope;
}

/// Whether the slopes of an unknown are what differences say: to their own error, that of runs, 1e-9 of the
/// curve over the step, and a part in a thousand for the curvature. A slope that leaves out some part of what
/// the value does shows here.
void Residuals::judge_slope(const std::vector<double>& u, const std::vector<double>& r, std::size_t j,
                            const std::vector<double>& by_difference) {
  Derivative& d = used[j];
  if (!has_slope(u, j)) {
    d.why_not = !options_.exact                                           ? "differences are asked for"
                : j < here_.no_slope.size() && !here_.no_slope[j].empty() ? here_.no_slope[j]
                                                                          : "no slope is known";
    return;
  }
  const std::vector<double> slope = slope_of(u, j);
  double apart = 0, size = 0, curve = 0;
  for (std::size_t i = 0; i < slope.size(); ++i) {
    apart += std::pow(slope[i] - by_difference[i], 2);
    size += std::pow(by_difference[i], 2);
    curve += std::pow(r[i] + data_[i] / sigma_[i], 2);
  }
  const double h = options_.difference, part = std::max(1e-3, h * h);
  d.off = size > 0 ? std::sqrt(apart / size) : apart > 0 ? INFINITY : 0;
  d.exact = options_.exact && std::sqrt(apart) <= part * std::sqrt(size) + 1e-9 / h * std::sqrt(curve);
  if (!options_.exact)
    d.why_not = "differences are asked for";
  else if (!d.exact)
    d.why_not = "what follows from the tangent is not what runs beside the start say";
}

/// By runs beside u.
bool Residuals::differences(const std::vector<double>& u, const std::vector<double>& r,
                            const std::vector<std::size_t>& columns, std::vector<double>& J) {
  const std::size_t n = columns.size(), m = r.size();
  if (n == 0) return true;
  std::vector<std::vector<double>> points;
  std::vector<std::pair<double, double>> steps;
  for (const std::size_t j : columns) {
    steps.push_back(steps_at(j, u[j]));
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
std::pair<double, double> Residuals::steps_at(std::size_t j, double u) const {
  const double room = unknowns_.high(j) - unknowns_.low(j),
               h = std::min(unknowns_.step(j, u, options_.difference), 0.25 * room);
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
