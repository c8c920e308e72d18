#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace vbond {

/// A number that carries its derivatives with respect to N variables: forward differentiation.
/// Feeding it to a law gives gradients exact to rounding.
template <std::size_t N>
struct Dual {
  double value = 0.0;
  std::array<double, N> d{};

  constexpr Dual() = default;
  constexpr Dual(double v) : value(v) {}  // NOLINT: a plain number is a constant
  /// The variable number k, at the value v.
  static constexpr Dual variable(double v, std::size_t k) {
    Dual x(v);
    x.d[k] = 1.0;
    return x;
  }

  friend constexpr Dual operator-(const Dual& a) { return scaled(-a.value, -1.0, a); }
  friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    return combined(a.value + b.value, 1.0, a, 1.0, b);
  }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    return combined(a.value - b.value, 1.0, a, -1.0, b);
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    return combined(a.value * b.value, b.value, a, a.value, b);
  }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const double q = a.value / b.value;
    return combined(q, 1.0 / b.value, a, -q / b.value, b);
  }
  friend Dual sqrt(const Dual& a) {
    const double root = std::sqrt(a.value);
    return scaled(root, 0.5 / root, a);
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double r2 = x.value * x.value + y.value * y.value;
    return combined(std::atan2(y.value, x.value), x.value / r2, y, -y.value / r2, x);
  }
  /// By the values: away from a = b the derivatives of these are those of x or y.
  friend constexpr Dual larger(const Dual& a, const Dual& b) { return a.value > b.value ? a : b; }
  friend constexpr Dual where_greater(const Dual& a, const Dual& b, const Dual& x, const Dual& y) {
    return a.value > b.value ? x : y;
  }
  friend constexpr bool any_greater(const Dual& a, const Dual& b) { return a.value > b.value; }

 private:
  static constexpr Dual scaled(double value, double s, const Dual& a) {
    return combined(value, s, a, 0.0, a);
  }
  static constexpr Dual combined(double value, double s, const Dual& a, double t, const Dual& b) {
    Dual x(value);
    for (std::size_t k = 0; k < N; ++k) x.d[k] = s * a.d[k] + t * b.d[k];
    return x;
  }
};

}  // namespace vbond
