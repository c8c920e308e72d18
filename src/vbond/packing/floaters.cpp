#include "vbond/packing/floaters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/images.hpp"
#include "vbond/core/near_pairs.hpp"

namespace vbond::packing {
namespace {

void remove_floaters(const Request& q, Packing& p) {
  for (;;) {
    const std::vector<int> neighbours = count_neighbours(q.vessel, p.r, p.radius, q.gap);
    std::size_t n = 0;
    for (std::size_t i = 0; i < p.r.size(); ++i)
      if (neighbours[i] >= q.neighbours) {
        p.r[n] = p.r[i], p.radius[n] = p.radius[i], p.kind[n] = p.kind[i];
        ++n;
      }
    if (n == p.r.size()) return;
    if (n == 0)
      throw Refused("all grains are floaters", "no grain has so many neighbours",
                    "ask for fewer, or within a wider gap");
    p.removed += p.r.size() - n;
    p.r.resize(n), p.radius.resize(n), p.kind.resize(n);
  }
}

/// What stands around one grain.
class Hole {
 public:
  Hole(const Request& q, const Packing& p, std::size_t i, double reach) : q_(q) {
    const CellEdges& cell = q.vessel.cell;
    for (std::size_t j = 0; j < p.r.size(); ++j) {
      Image n{};
      if (!cell.empty()) n = nearest_image(cell, q.vessel.periodic, p.r[i], p.r[j]);
      if (i == j && n.is_itself()) continue;
      const Vec3d at = p.r[j] + to_image(cell, n);
      if (norm(between(p.r[i], at)) < reach + p.radius[j]) at_.push_back(at), radius_.push_back(p.radius[j]);
    }
  }

  /// The largest sphere around a place, and which way is out of what limits it.
  double room(const Vec3d& r, double soft, Vec3d* out) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < at_.size(); ++k)
      least = std::min(least, norm(between(at_[k], r)) - radius_[k]);
    least = std::min(least, q_.vessel.depth(r));
    if (!out) return least;
    *out = {};
    for (std::size_t k = 0; k < at_.size(); ++k) {
      const Vec3d d = between(at_[k], r);
      const double length = norm(d);
      if (length - radius_[k] < least + soft && length > 0.0) *out += (1.0 / length) * d;
    }
    std::vector<Feel> feels;
    q_.vessel.feel(r, least + soft, feels);
    for (const Feel& f : feels) *out += f.inward;
    return least;
  }

 private:
  const Request& q_;
  std::vector<Vec3d> at_;
  std::vector<double> radius_;
};

void grow_floaters(const Request& q, Packing& p) {
  const std::vector<int> neighbours = count_neighbours(q.vessel, p.r, p.radius, q.gap);
  for (std::size_t i = 0; i < p.r.size(); ++i) {
    if (neighbours[i] >= q.neighbours) continue;
    const double largest = q.kinds[p.kind[i]].sizes.largest() * p.size_factor;
    const Hole hole(q, p, i, 4.0 * p.radius[i] + largest);
    Vec3d r = p.r[i], out;
    double best = hole.room(r, 0.0, nullptr), step = 0.3 * p.radius[i];
    while (step > 1e-5 * p.radius[i] && best < largest) {  // uphill to where the room is largest
      hole.room(r, 0.5 * step, &out);
      const Vec3d next = norm(out) > 1e-12 ? r + step * normalised(out) : r;
      const double there = hole.room(next, 0.0, nullptr);
      if (there > best)
        best = there, r = next;
      else
        step *= 0.7;
    }
    const double radius = std::min(best, largest);
    if (radius <= p.radius[i]) continue;
    ++p.grown;
    p.largest_growth = std::max(p.largest_growth, radius / p.radius[i]);
    p.r[i] = r, p.radius[i] = radius;
  }
}

}  // namespace

void settle_floaters(const Request& q, Packing& p) {
  switch (q.floaters) {
    case Floaters::keep: return;
    case Floaters::remove: return remove_floaters(q, p);
    case Floaters::grow: return grow_floaters(q, p);
  }
}

}  // namespace vbond::packing
