#include "vbond/statics/detail/path_goal.hpp"

#include <algorithm>
#include <cmath>

namespace vbond {

std::vector<Goal> goals_of(const PathSettings& path) {
  std::vector<Goal> goals;
  // a last correction at the load factor itself makes up for 1e-9
  const auto at_load_factor = [&goals](double f, double sense) {
    goals.push_back({"load factor", [=](const Placement& p) { return sense * (p.load_factor - f); },
                     1e-9 * std::max(std::abs(f), 1e-9), f});
  };
  if (path.above) at_load_factor(*path.above, 1.0);
  if (path.below) at_load_factor(*path.below, -1.0);
  if (path.distance) {
    const auto beyond = [d = *path.distance](const Placement& p) {
      return (d.below ? -1.0 : 1.0) * (norm(between(p.r, d.i, d.j)) - d.value);
    };
    goals.push_back({"distance", beyond, 1e-15 * path.distance->value, {}});
  }
  return goals;
}

}  // namespace vbond
