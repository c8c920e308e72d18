#include "vbond/fit/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vbond::fit {
namespace {

bool goes_down(const Curve& c) {
  return c.x.back() < c.x.front();
}

/// y'' by the divided differences of three rows; 0 where two of them have one x, or one of them no y.
double second_derivative(const Curve& c, std::size_t k) {
  const double a = c.x[k + 1] - c.x[k], b = c.x[k + 2] - c.x[k + 1];
  if (a == 0 || b == 0) return 0;
  const double second = 2 * ((c.y[k + 2] - c.y[k + 1]) / b - (c.y[k + 1] - c.y[k]) / a) / (a + b);
  return std::isfinite(second) ? second : 0;
}

}  // namespace

std::optional<std::size_t> goes_back(const Curve& c) {
  if (c.x.empty()) return std::nullopt;
  const double way = goes_down(c) ? -1 : 1;
  for (std::size_t k = 1; k < c.x.size(); ++k)
    if (way * (c.x[k] - c.x[k - 1]) < 0) return k;
  return std::nullopt;
}

namespace {

/// Between which rows an x lies: part of the way from one to the other, which may be the same.
struct Place {
  std::size_t from, to;
  double part;
};

std::optional<Place> place_of(const Curve& c, double x) {
  if (c.x.empty()) return std::nullopt;
  const double first = c.x.front(), last = c.x.back(), beyond = 1e-9 * std::abs(last - first);
  if (x < std::min(first, last) - beyond || x > std::max(first, last) + beyond) return std::nullopt;
  const double way = goes_down(c) ? -1 : 1;
  std::size_t k = 1;  // the first row that has reached x
  while (k + 1 < c.x.size() && way * (c.x[k] - x) < 0) ++k;
  const auto row = [&](std::size_t r) {
    return std::isfinite(c.y[r]) ? std::optional(Place{r, r, 0}) : std::nullopt;
  };
  if (c.x.size() == 1 || way * (c.x[0] - x) >= 0) return row(0);
  const double step = c.x[k] - c.x[k - 1];
  if (step == 0) return row(k - 1);
  if (!std::isfinite(c.y[k - 1] + c.y[k])) {  // a gap: its ends alone
    if (std::abs(c.x[k] - x) <= beyond) return row(k);
    return std::abs(x - c.x[k - 1]) <= beyond ? row(k - 1) : std::nullopt;
  }
  return Place{k - 1, k, std::clamp((x - c.x[k - 1]) / step, 0.0, 1.0)};
}

}  // namespace

std::optional<Between> at(const Curve& c, double x) {
  const auto place = place_of(c, x);
  if (!place) return std::nullopt;
  const auto [from, to, part] = *place;
  if (from == to) return Between{c.y[from], 0};
  const double step = c.x[to] - c.x[from];
  double bend = 0;
  if (to >= 2) bend = std::abs(second_derivative(c, to - 2));
  if (to + 1 < c.x.size()) bend = std::max(bend, std::abs(second_derivative(c, to - 1)));
  return Between{c.y[from] + part * (c.y[to] - c.y[from]), 0.5 * bend * step * step * part * (1 - part)};
}

// Where a row stands at x it is at() there as long as it does; as it moves the line beside it counts, and of
// the two the one that at() takes.
double rate_at(const Curve& c, const Curve& rates, double x) {
  const auto place = place_of(c, x);
  if (!place) return std::numeric_limits<double>::quiet_NaN();
  const auto [from, to, part] = *place;
  if (from == to) {
    const std::size_t other = from + 1 < c.x.size() ? from + 1 : from > 0 ? from - 1 : from;
    const double step = c.x[other] - c.x[from], slope = step == 0 ? 0.0 : (c.y[other] - c.y[from]) / step;
    return rates.y[from] - (rates.x[from] == 0 ? 0.0 : slope * rates.x[from]);
  }
  const double slope = (c.y[to] - c.y[from]) / (c.x[to] - c.x[from]);
  const auto of_row = [&](std::size_t r) { return rates.y[r] - slope * rates.x[r]; };
  return of_row(from) + part * (of_row(to) - of_row(from));
}

}  // namespace vbond::fit
