#pragma once
#include <algorithm>
#include <cmath>

namespace vbond {

/// A function of the arc-length at one place.
struct Sample {
  double s = 0, value = 0;
};

/// The place between lo and hi, where `value` has opposite signs, at which it crosses zero: regula falsi with
/// the weights of Anderson and Bjorck (BIT 13 (1973) 253), which needs neither a derivative nor a smooth
/// value, and a bisection wherever three looks have not halved the bracket. Ends when |value| <= small or the
/// bracket is down to 1e-13 of what it was. value(s) may return nothing at a place where it cannot be told (a
/// singular tangent): that place is then the answer.
template <class Value>
double crossing(Sample lo, Sample hi, double small, Value&& value) {
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
    const auto found = value(s);
    if (!found || std::abs(*found) <= small) return s;
    const bool as_lo = std::signbit(*found) == std::signbit(lo.value);
    Sample& moved = as_lo ? lo : hi;
    double& kept_weight = as_lo ? hi_weight : lo_weight;
    const double shrink = 1.0 - *found / moved.value;
    if (side == (as_lo ? -1 : 1)) kept_weight *= shrink > 0.0 ? shrink : 0.5;
    side = as_lo ? -1 : 1;
    moved = {s, *found};
    (as_lo ? lo_weight : hi_weight) = *found;
  }
  return std::abs(lo.value) < std::abs(hi.value) ? lo.s : hi.s;
}

}  // namespace vbond
