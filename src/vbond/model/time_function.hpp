#pragma once
#include <algorithm>
#include <vector>

namespace vbond {

/// A factor over the time since the stage began: straight lines between points, constant outside.
/// No points: always 1.
struct TimeFunction {
  struct Point {
    double t;  ///< [time]
    double factor;
  };
  std::vector<Point> points;  ///< in increasing t

  double operator()(double t) const {
    if (points.empty()) return 1.0;
    const auto after =
        std::upper_bound(points.begin(), points.end(), t, [](double x, const Point& p) { return x < p.t; });
    if (after == points.begin()) return points.front().factor;
    if (after == points.end()) return points.back().factor;
    const Point& a = *(after - 1);
    const Point& b = *after;
    return a.factor + (b.factor - a.factor) * (t - a.t) / (b.t - a.t);
  }
};

}  // namespace vbond
