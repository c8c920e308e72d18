#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "vbond/core/portable.hpp"

namespace vbond {

/// Dual (dual.hpp) for numbers T that are packs of doubles: each lane rounds as a Dual does.
template <std::size_t N, class T>
struct DualOf {
  T value = T(0.0);
  std::array<T, N> d{};

  constexpr DualOf() = default;
  VBOND_HD constexpr DualOf(double v) : value(T(v)) {}  // NOLINT: a plain number is a constant
  VBOND_HD constexpr explicit DualOf(const T& v) : value(v) {}
  /// The variable number k, at the value v.
  static VBOND_HD constexpr DualOf variable(const T& v, std::size_t k) {
    DualOf x(v);
    x.d[k] = T(1.0);
    return x;
  }

  friend VBOND_HD constexpr DualOf operator-(const DualOf& a) { return scaled(-a.value, T(-1.0), a); }
  friend VBOND_HD constexpr DualOf operator+(const DualOf& a, const DualOf& b) {
    return combined(a.value + b.value, T(1.0), a, T(1.0), b);
  }
  friend VBOND_HD constexpr DualOf operator-(const DualOf& a, const DualOf& b) {
    return combined(a.value - b.value, T(1.0), a, T(-1.0), b);
  }
  friend VBOND_HD constexpr DualOf operator*(const DualOf& a, const DualOf& b) {
    return combined(a.value * b.value, b.value, a, a.value, b);
  }
  friend VBOND_HD constexpr DualOf operator/(const DualOf& a, const DualOf& b) {
    const T q = a.value / b.value;
    return combined(q, T(1.0) / b.value, a, -q / b.value, b);
  }
  friend VBOND_HD DualOf sqrt(const DualOf& a) {
    using std::sqrt;
    const T root = sqrt(a.value);
    return scaled(root, T(0.5) / root, a);
  }
  friend VBOND_HD DualOf atan2(const DualOf& y, const DualOf& x) {
    using std::atan2;
    const T r2 = x.value * x.value + y.value * y.value;
    return combined(atan2(y.value, x.value), x.value / r2, y, -y.value / r2, x);
  }

 private:
  static VBOND_HD constexpr DualOf scaled(const T& value, const T& s, const DualOf& a) {
    return combined(value, s, a, T(0.0), a);
  }
  static VBOND_HD constexpr DualOf combined(const T& value, const T& s, const DualOf& a, const T& t,
                                            const DualOf& b) {
    DualOf x(value);
    for (std::size_t k = 0; k < N; ++k) x.d[k] = s * a.d[k] + t * b.d[k];
    return x;
  }
};

}  // namespace vbond
