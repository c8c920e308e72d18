#include "vbond/dynamics/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "vbond/core/near_pairs.hpp"

namespace vbond {
NeighbourList::NeighbourList(double max_reach, double skin, Reach reach, Excluded excluded)
    : max_reach_(max_reach), skin_(skin), reach_(std::move(reach)), excluded_(std::move(excluded)) {}

void NeighbourList::refresh(const PerParticle<Vec3d>& r) {
  if (stale(r)) rebuild(r);
}

bool NeighbourList::stale(const PerParticle<Vec3d>& r) const {
  if (r.size() != r_built_.size() || start_.empty()) return true;
  const double limit = sq(0.5 * skin_);
  for (const ParticleId p : r.ids())
    if (!(norm2(r[p] - r_built_[p]) <= limit)) return true;
  return false;
}

void NeighbourList::rebuild(const PerParticle<Vec3d>& r) {
  ++rebuilds_;
  r_built_ = r;
  start_.assign(r.size() + 1, 0);
  neighbours_.clear();
  // No cell for a point at infinity: the load check refuses the step that made it.
  if (!std::all_of(r.begin(), r.end(), [](const Vec3d& p) { return is_finite(p); })) return;

  std::vector<std::pair<ParticleId, ParticleId>> pairs;
  for_near_pairs(r.values(), max_reach_ + skin_, [&](std::size_t i, std::size_t j, double distance2) {
    const ParticleId p{i}, o{j};
    if (std::sqrt(distance2) < reach_(p, o) + skin_ && !excluded_(p, o)) {
      pairs.emplace_back(p, o);
      pairs.emplace_back(o, p);
    }
  });
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [p, o] : pairs) {
    ++start_[p.value + 1];
    neighbours_.push_back(o);
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
}

}  // namespace vbond
