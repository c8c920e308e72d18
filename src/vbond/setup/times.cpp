#include "vbond/setup/times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace vbond {
namespace {

/// Times are products of decimal numbers: how far, as a part of itself, one may be from a number of steps.
constexpr double rounding = 1e-9;
/// How far, in steps, a bend of a factor may be from its step.
constexpr double near_step = 1e-6;

bool is_whole(double time, double dt) {
  return std::abs(time - std::round(time / dt) * dt) <= rounding * time;
}

double steps_at_most(double time, double wanted) {
  return is_whole(time, wanted) ? std::round(time / wanted) : std::ceil(time / wanted);
}

/// Integral of f from a to b.
double integral(const TimeFunction& f, double a, double b) {
  double sum = 0.0, t = a, f_t = f(a);
  const auto add = [&](double next, double f_next) {
    sum += 0.5 * (f_t + f_next) * (next - t);
    t = next, f_t = f_next;
  };
  auto p = std::upper_bound(f.points.begin(), f.points.end(), a,
                            [](double x, const TimeFunction::Point& q) { return x < q.t; });
  for (; p != f.points.end() && p->t < b; ++p) add(p->t, p->factor);
  add(b, f(b));
  return sum;
}

/// A time function as the steps see it: which of the intervals between them have a bend inside.
class Stepped {
 public:
  Stepped(const TimeFunction& f, double dt, std::int64_t last)
      : f_(f), dt_(dt), last_(last), nodes_{0, last} {
    for (const TimeFunction::Point& p : f.points) {
      const double steps = p.t / dt;
      if (!(steps <= static_cast<double>(last) + near_step)) break;
      const auto nearest = static_cast<std::int64_t>(std::round(steps));
      if (std::abs(steps - std::round(steps)) > near_step) {
        bend(static_cast<std::int64_t>(std::floor(steps)));
      } else if (!on_steps_.insert(nearest).second) {  // a second bend on this step: a jump
        bend(nearest - 1);
        bend(nearest);
      }
    }
    nodes_.insert(on_steps_.begin(), on_steps_.end());
  }

  bool any_bend() const { return !bent_.empty(); }

  TimeFunction resampled() const {
    TimeFunction g;
    for (const std::int64_t n : nodes_) g.points.push_back({static_cast<double>(n) * dt_, mean(n)});
    return g;
  }

 private:
  /// There is a bend between steps n and n + 1.
  void bend(std::int64_t n) {
    n = std::clamp<std::int64_t>(n, 0, last_ - 1);
    bent_.insert(n);
    for (std::int64_t k = n - 1; k <= n + 2; ++k)
      if (0 <= k && k <= last_) nodes_.insert(k);
  }

  /// The factor at step n: of a bent interval beside it the mean over the half that is near.
  double mean(std::int64_t n) const {
    const double t = static_cast<double>(n) * dt_, h = 0.5 * dt_;
    const double left = bent_.count(n - 1) > 0 ? integral(f_, t - h, t) / h : f_(t);
    const double right = bent_.count(n) > 0 ? integral(f_, t, t + h) / h : f_(t);
    return n == 0 ? right : n == last_ ? left : 0.5 * (left + right);
  }

  const TimeFunction& f_;
  double dt_;
  std::int64_t last_;
  std::set<std::int64_t> nodes_;     // steps at which the result has a point
  std::set<std::int64_t> bent_;      // intervals, by the step at which they begin
  std::set<std::int64_t> on_steps_;  // steps at which the factor bends
};

}  // namespace

double fitting_step(double wanted, double duration, double every) {
  const bool repeats = every > 0.0;
  if (is_whole(duration, wanted) && (!repeats || is_whole(every, wanted))) return wanted;
  if (!repeats) return duration / steps_at_most(duration, wanted);
  const double fewest = steps_at_most(every, wanted);
  // a ratio p/q of the two needs a multiple of q steps: looked for up to half the step that is wanted
  const double most = std::min(2.0 * fewest, fewest + 1000.0);
  for (double n = fewest; n <= most; ++n)
    if (is_whole(duration, every / n)) return every / n;
  return every / fewest;
}

TimeFunction on_steps(const TimeFunction& f, double dt, std::int64_t last) {
  const Stepped stepped(f, dt, last);
  return stepped.any_bend() ? stepped.resampled() : f;
}

std::vector<std::string> times_not_met(const Stage& stage) {
  std::vector<std::string> lines;
  const auto look = [&](const char* key, double time, double tolerance) {
    const std::int64_t steps = steps_in(time, stage.dt);
    const double is = static_cast<double>(steps) * stage.dt;
    if (std::isfinite(time) && std::abs(is - time) > tolerance * time)
      lines.push_back(fmt::format("stage {}: {} = {:.6g} becomes {:.6g}, {} steps of {:.6g}", stage.name, key,
                                  time, is, steps, stage.dt));
  };
  constexpr double of_an_average = 0.01;  // what is looked at over a time does not hang on the last step
  look("duration", stage.stops.duration, rounding);
  if (stage.strain) look("strain.every", stage.strain->every, rounding);
  if (stage.stops.peak) look("stop.peak.average_over", stage.stops.peak->average_over, of_an_average);
  if (stage.stops.rest) look("stop.rest.during", stage.stops.rest->during, of_an_average);
  return lines;
}

}  // namespace vbond
