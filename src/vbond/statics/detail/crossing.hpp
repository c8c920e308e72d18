#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

namespace vbond {

/// A function of the arc-length at one place.
struct Sample {
  double s = 0, value = 0;
};

/// Where a function crosses zero.
struct Crossed {
  double s = 0;
  bool found = true;  ///< false: there is no value between lo and hi, and s is that of lo
  Sample lo, hi;      ///< on either side
};

/// The part between lo and hi, around `middle`, where there is no value: halves of what is left on either
/// side are taken off it as long as they have one.
template <class Value>
Crossed crossing_without_value(Sample lo, Sample hi, double middle, double small, Value&& value);

/// The place between lo and hi, where `value` has opposite signs, at which it crosses zero: regula falsi with
/// the weights of Anderson and Bjorck (BIT 13 (1973) 253), which needs neither a derivative nor a smooth
/// value, and a bisection wherever three looks have not halved the bracket. Ends when |value| <= small or the
/// bracket is down to 1e-13 of what it was. value(s) may return nothing where there is none.
template <class Value>
Crossed crossing(Sample lo, Sample hi, double small, Value&& value) {
  const double narrow = 1e-13 * std::abs(hi.s - lo.s);
  double width = std::abs(hi.s - lo.s);
  double lo_weight = lo.value, hi_weight = hi.value;
  int side = 0;  // which end moved last
  for (int look = 1; std::abs(hi.s - lo.s) > narrow; ++look) {
    double s = (lo.s * hi_weight - hi.s * lo_weight) / (hi_weight - lo_weight);
    if (look % 3 == 0) {
      if (std::abs(hi.s - lo.s) > 0.5 * width) s = 0.5 * (lo.s + hi.s);
      width = std::abs(hi.s - lo.s);
    }
    if (!(s > std::min(lo.s, hi.s) && s < std::max(lo.s, hi.s))) s = 0.5 * (lo.s + hi.s);
    const std::optional<double> found = value(s);
    if (!found) return crossing_without_value(lo, hi, s, small, value);
    if (std::abs(*found) <= small) return {s, true, lo, hi};
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

template <class Value>
Crossed crossing_without_value(Sample lo, Sample hi, double middle, double small, Value&& value) {
  constexpr int halvings = 12;
  double from = middle, to = middle;
  for (int k = 0; k < halvings; ++k)
    for (const bool before : {true, false}) {
      const double s = before ? 0.5 * (lo.s + from) : 0.5 * (to + hi.s);
      const std::optional<double> found = value(s);
      if (!found) {
        (before ? from : to) = s;
        continue;
      }
      const bool as_lo = std::signbit(*found) == std::signbit(lo.value);
      (as_lo ? lo : hi) = Sample{s, *found};
      if (as_lo != before) return crossing(lo, hi, small, value);  // beside the part without a value
    }
  return {lo.s, false, lo, hi};
}

}  // namespace vbond
