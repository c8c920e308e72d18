#pragma once
#include <algorithm>
#include <cstddef>
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

/// The integral of a time function from 0, exact: its trapezia are added up once.
class TimeIntegral {
 public:
  /// Keeps a reference.
  explicit TimeIntegral(const TimeFunction& f) : f_(&f) {
    double sum = 0.0;
    for (std::size_t k = 0; k < f.points.size(); ++k) {
      if (k > 0)
        sum += 0.5 * (f.points[k].t - f.points[k - 1].t) * (f.points[k].factor + f.points[k - 1].factor);
      until_.push_back(sum);
    }
    at_0_ = from_first_point(0.0);
  }
  double operator()(double t) const { return f_->points.empty() ? t : from_first_point(t) - at_0_; }

 private:
  double from_first_point(double t) const {
    const std::vector<TimeFunction::Point>& points = f_->points;
    if (points.empty()) return 0.0;
    const auto after = std::upper_bound(points.begin(), points.end(), t,
                                        [](double x, const TimeFunction::Point& p) { return x < p.t; });
    if (after == points.begin()) return (t - points.front().t) * points.front().factor;
    const TimeFunction::Point& before = *(after - 1);
    return until_[static_cast<std::size_t>(after - points.begin()) - 1] +
           0.5 * (t - before.t) * (before.factor + (*f_)(t));
  }

  const TimeFunction* f_;
  std::vector<double> until_;  // each point, from the first
  double at_0_ = 0.0;
};

}  // namespace vbond
