#pragma once
#include <concepts>

#include "vbond/core/portable.hpp"

namespace vbond {

/// What the physics is written for: double, a dual number, a pack of doubles, a GPU double.
/// Comparison is deliberately not asked for: a law may not branch on a scalar.
template <class T>
concept Scalar = requires(T x, T y) {
  { x + y } -> std::convertible_to<T>;
  { x - y } -> std::convertible_to<T>;
  { x* y } -> std::convertible_to<T>;
  { x / y } -> std::convertible_to<T>;
  { -x } -> std::convertible_to<T>;
  T(0.5);
};

/// The square of x.
template <Scalar T>
VBOND_HD constexpr T sq(const T& x) {
  return x * x;
}

/// The larger of two, and x or y as a > b or not: what laws may do that need no derivatives. Packs of doubles
/// have the same, lane by lane.
template <std::floating_point T>
VBOND_HD constexpr T larger(T a, T b) {
  return a > b ? a : b;
}
template <std::floating_point T>
VBOND_HD constexpr T where_greater(T a, T b, T x, T y) {
  return a > b ? x : y;
}
/// Whether a > b, in any lane of a pack: to leave out work that would change nothing.
template <std::floating_point T>
VBOND_HD constexpr bool any_greater(T a, T b) {
  return a > b;
}

}  // namespace vbond
