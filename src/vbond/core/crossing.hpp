#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

namespace vbond {

/// A function at one place.
struct Sample {
  double s = 0, value = 0;
};

/// Where a function crosses zero.
struct Crossed {
  double s = 0;
  bool found = true;  ///< false: there is no value between lo and hi, and s is that of lo
  Sample lo, hi;      ///< on either side
};

/// The place between lo and hi, where `value` has opposite signs, at which it crosses zero: regula falsi with
/// the weights of Anderson and Bjorck (BIT 13 (1973) 253), which needs neither a derivative nor a smooth
/// value, and a bisection wherever three looks have not halved the bracket. Ends when |value| <= small or the
/// bracket is no wider than `narrow`. value(s) may return nothing. Then the bracket is halved from both ends
/// towards that place as long as there are values.
template <class Value>
class CrossingSearch {
 public:
  CrossingSearch(double small, double narrow, Value& value) : small_(small), narrow_(narrow), value_(value) {}

  Crossed between(Sample lo, Sample hi) const {
    double width = std::abs(hi.s - lo.s);
    double lo_weight = lo.value, hi_weight = hi.value;
    int side = 0;  // which end moved last
    for (int look = 1; std::abs(hi.s - lo.s) > narrow_; ++look) {
      double s = (lo.s * hi_weight - hi.s * lo_weight) / (hi_weight - lo_weight);
      if (look % 3 == 0) {
        if (std::abs(hi.s - lo.s) > 0.5 * width) s = 0.5 * (lo.s + hi.s);
        width = std::abs(hi.s - lo.s);
      }
      if (!is_between(s, lo, hi)) s = 0.5 * (lo.s + hi.s);
      if (!is_between(s, lo, hi)) break;  // to the last bit
      const std::optional<double> found = value_(s);
      if (!found) return around(s, lo, hi);
      if (std::abs(*found) <= small_) return {s, true, lo, hi};
      const bool as_lo = std::signbit(*found) == std::signbit(lo.value);
      Sample& moved = as_lo ? lo : hi;
      double& kept_weight = as_lo ? hi_weight : lo_weight;
      const double shrink = 1.0 - *found / moved.value;
      if (side == (as_lo ? -1 : 1)) kept_weight *= shrink > 0.0 ? shrink : 0.5;
      side = as_lo ? -1 : 1;
      moved = {s, *found};
      (as_lo ? lo_weight : hi_weight) = *found;
    }
    return {std::abs(lo.value) < std::abs(hi.value) ? lo.s : hi.s, true, lo, hi};
  }

 private:
  static bool is_between(double s, const Sample& lo, const Sample& hi) {
    return s > std::min(lo.s, hi.s) && s < std::max(lo.s, hi.s);
  }

  /// There is no value at `middle`.
  Crossed around(double middle, Sample lo, Sample hi) const {
    constexpr int halvings = 12;
    double from = middle, to = middle;
    for (int k = 0; k < halvings && std::abs(hi.s - lo.s) > narrow_; ++k)
      for (const bool before : {true, false}) {
        const double s = before ? 0.5 * (lo.s + from) : 0.5 * (to + hi.s);
        const std::optional<double> found = value_(s);
        if (!found) {
          (before ? from : to) = s;
          continue;
        }
        const bool as_lo = std::signbit(*found) == std::signbit(lo.value);
        (as_lo ? lo : hi) = Sample{s, *found};
        if (as_lo != before) return between(lo, hi);  // beside the part without a value
      }
    return {lo.s, false, lo, hi};
  }

  double small_, narrow_;
  Value& value_;
};

template <class Value>
Crossed crossing(Sample lo, Sample hi, double small, Value&& value) {
  return CrossingSearch<std::remove_reference_t<Value>>(small, 1e-13 * std::abs(hi.s - lo.s), value)
      .between(lo, hi);
}

}  // namespace vbond
