#pragma once
#include <array>
#include <cmath>
#include <optional>

namespace vbond::campaign {

/// Values at six equal distances around zero: x = -2.5, -1.5 ... 2.5.
using Six = std::array<double, 6>;

/// The polynomial through `size` of the values from `first` on, at x (Neville).
inline double polynomial(const Six& v, double x, std::size_t first = 0, std::size_t size = 6) {
  Six p = v;
  for (std::size_t span = 1; span < size; ++span)
    for (std::size_t k = first; k + span < first + size; ++k) {
      const double lo = static_cast<double>(k) - 2.5, hi = static_cast<double>(k + span) - 2.5;
      p[k] = ((hi - x) * p[k] + (x - lo) * p[k + 1]) / (hi - lo);
    }
  return p[first];
}

/// Its zero between the outermost places, if it has different signs there.
inline std::optional<double> zero_of(const Six& v, std::size_t first = 0, std::size_t size = 6) {
  double lo = -2.5, hi = 2.5;
  const bool sign = std::signbit(polynomial(v, lo, first, size));
  if (sign == std::signbit(polynomial(v, hi, first, size))) return {};
  for (int k = 0; k < 60; ++k) {
    const double mid = 0.5 * (lo + hi);
    (std::signbit(polynomial(v, mid, first, size)) == sign ? lo : hi) = mid;
  }
  return 0.5 * (lo + hi);
}

/// Slope of the polynomial of degree 5.
inline double slope(const Six& v, double x) {
  return (polynomial(v, x + 1e-3) - polynomial(v, x - 1e-3)) / 2e-3;
}

}  // namespace vbond::campaign
