#include "vbond/model/swing_bound.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vbond/model/cell_drive.hpp"

namespace vbond {
namespace {

constexpr double of_the_range = 0.05;  // the least rise or fall that counts: measured tables have noise

/// The times at which a factor has risen and begins to fall, or has fallen and begins to rise.
std::vector<double> turnings(const TimeFunction& f, double duration) {
  const auto last = std::find_if(f.points.begin(), f.points.end(),
                                 [=](const TimeFunction::Point& p) { return p.t > duration; });
  if (last == f.points.begin()) return {};
  const auto [low, high] = std::minmax_element(
      f.points.begin(), last, [](const auto& one, const auto& other) { return one.factor < other.factor; });
  const double least = of_the_range * (high->factor - low->factor);
  std::vector<double> times;
  TimeFunction::Point extreme = f.points.front();
  double way = 0.0;  // +1: it rises, -1: it falls, 0: not known yet
  for (auto p = f.points.begin(); p != last; ++p) {
    const double on = p->factor - extreme.factor;
    if (way == 0.0 ? std::abs(on) > least : way * on < -least) {
      if (way != 0.0) times.push_back(extreme.t);
      way = on > 0.0 ? 1.0 : -1.0;
      extreme = *p;
    } else if (way * on > 0.0) {
      extreme = *p;
    }
  }
  return times;
}

}  // namespace

double shortest_period(const TimeFunction& factor, double duration) {
  const std::vector<double> at = turnings(factor, duration);
  double period = std::numeric_limits<double>::infinity();
  for (std::size_t k = 2; k < at.size(); ++k) period = std::min(period, at[k] - at[k - 2]);
  return period;
}

FastestSwing fastest_swing(const Stage& stage) {
  FastestSwing fastest;
  const auto look = [&](double period, const auto& name) {
    if (period < fastest.period) fastest = {period, name()};
  };
  const auto look_at = [&](const TimeFunction& factor, const char* of, const std::string& name) {
    look(shortest_period(factor, stage.stops.duration),
         [&] { return std::string("the factor over time of ") + of + " \"" + name + '"'; });
  };
  for (const WallDrive& w : stage.walls) {
    if (w.frequency > 0.0 && norm(w.amplitude) > 0.0)
      look(1.0 / w.frequency, [&w] { return "the oscillation of wall \"" + w.wall + '"'; });
    look_at(w.factor, "wall", w.wall);
    if (w.servo) look_at(w.servo->factor, "the servo of wall", w.wall);
  }
  for (const Support& s : stage.supports)
    if (s.velocity != Vec3d{} || s.angular_velocity != Vec3d{})
      look_at(s.factor, "the support of group", s.group);
  for (const PointLoad& l : stage.loads) look_at(l.factor, "the load on group", l.group);
  for (const Pressure& p : stage.pressures) look_at(p.factor, "the pressure on group", p.group);
  for (std::size_t k = 0; k < stage.cell.component.size(); ++k)
    look(shortest_period(stage.cell.component[k].factor, stage.stops.duration),
         [k] { return std::string("the factor over time of cell.") + cell_component_names[k]; });
  for (const Heating& h : stage.heating)
    look(shortest_period(h.factor, stage.stops.duration),
         [] { return std::string("the factor over time of a temperature"); });
  return fastest;
}

}  // namespace vbond
