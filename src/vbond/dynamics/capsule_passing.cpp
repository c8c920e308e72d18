// Capsules that are deep in one another, and those that pass through each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "vbond/dynamics/capsule_contacts.hpp"
#include "vbond/dynamics/contact_kernel.hpp"

namespace vbond {

DeepCapsules Capsules::told(std::uint32_t first, std::uint32_t second, double overlap, double radius) const {
  return {fibres_.name_of(first),
          fibres_.name_of(second),
          fibres_.parts()[first].i.particle,
          fibres_.parts()[second].i.particle,
          overlap,
          radius};
}

/// Whether the line between nearest points turns by more than a right angle while the two are deep in one
/// another, which is how particles that pass are told (observe/watch.cpp). Between the ends of the step all
/// points go straight on, so that no distance changes faster than the ends of the parts move apart.
bool Capsules::pass(const FibrePair& pair, double dt) const {
  const FibrePart &x = fibres_.parts()[pair.first], y = carried(fibres_.parts()[pair.second], pair.of_second);
  const std::array<ImageOf, 4> ends{x.i, x.j, y.i, y.j};
  std::array<Vec3d, 4> end, way;
  for (std::size_t k = 0; k < 4; ++k) end[k] = place(ends[k]), way[k] = dt * velocity(ends[k]);
  const double deep = deep_part * (x.R + y.R),
               fastest = std::max({norm(way[2] - way[0]), norm(way[3] - way[0]), norm(way[2] - way[1]),
                                   norm(way[3] - way[1])});
  const auto apart = [&](double left) {  // nearest points, a part `left` of the step before its end
    const auto r = [&](std::size_t k) { return end[k] - left * way[k]; };
    const NearestOnSegments at = nearest_on_segments(r(0), r(1), r(2), r(3));
    return between(on_segment(r(0), r(1), at.s), on_segment(r(2), r(3), at.t));
  };
  constexpr double least_part = 1e-4;  // of the step, at which it is looked at
  bool inside = false;
  Vec3d entered;
  const auto turned = [&](const Vec3d& d) {
    const bool was_inside = std::exchange(inside, norm(d) <= deep);
    if (inside && !was_inside) entered = d;
    return inside && dot(entered, d) < 0.0;
  };
  for (double left = 1.0; left > 0.0;) {
    const Vec3d d = apart(left);
    if (turned(d)) return true;
    if (norm(d) - deep > left * fastest) return false;  // too far away for what is left of the step
    // to where it may become deep, or by a tenth of that: a pass turns the line within two deep distances
    left -= std::max({norm(d) - deep, 0.1 * deep, least_part * fastest}) / fastest;
  }
  return turned(apart(0.0));
}

void Capsules::look_at_drift(double dt, double way, double longest) {
  if (!any_ || passed_) return;
  const auto r = finite_places();
  if (!r) return;  // the check of loads will tell
  std::vector<FibrePair> listed_anew;
  std::span<const FibrePair> near = near_;
  if (longest > 0.0)
    near = listed_anew = fibres_.near_pairs(*r, cell_, 2.0 * longest);
  else if (cell_.empty())  // else images go on with the cell
    near = near.first(may_have_come_nearer_by(2.0 * (gone_ + way)));
  std::optional<std::pair<std::uint32_t, std::uint32_t>> first;  // of all, whatever their order is
  for (const FibrePair& pair : near) {
    const std::pair parts(pair.first, pair.second);
    if (pair.bodies && pair.weight > 0 && (!first || parts < *first) && pass(pair, dt)) first = parts;
  }
  if (!first) return;
  const FibrePart &x = fibres_.parts()[first->first], &y = fibres_.parts()[first->second];
  passed_ = told(first->first, first->second, x.R + y.R, std::min(x.R, y.R));
}

std::vector<DeepCapsules> Capsules::deeper_than(double part) const {
  std::vector<DeepCapsules> deep;
  for (const Contact& c : contacts_) {
    if (!c.body) continue;
    const double overlap = touching(c).overlap;
    const double radius = std::min(c.a.R, c.b.R);
    if (overlap > part * radius) deep.push_back(told(c.first, c.second, overlap, radius));
  }
  return deep;
}

}  // namespace vbond
