#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Which particles may come within reach of each other before the next rebuild (a Verlet list from
/// cells). Between rebuilds no pair closer than its reach is missing: every pair closer than reach +
/// skin is listed, and the list is rebuilt once a particle has moved half the skin.
class NeighbourList {
 public:
  /// The distance within which a pair matters; at most max_reach.  [length]
  using Reach = std::function<double(ParticleId, ParticleId)>;
  /// Pairs to leave out, asked at a rebuild only.
  using Excluded = std::function<bool(ParticleId, ParticleId)>;

  /// max_reach > 0 and skin > 0  [length]
  NeighbourList(double max_reach, double skin, Reach reach, Excluded excluded);

  /// Rebuilds if a particle has moved more than half the skin, or after invalidate().
  void refresh(const PerParticle<Vec3d>& r);
  /// The answers of Reach or Excluded have changed.
  void invalidate() { start_.clear(); }

  /// The neighbours of p in increasing order; every pair is listed from both sides.
  struct Range {
    const ParticleId* first;
    const ParticleId* last;
    const ParticleId* begin() const { return first; }
    const ParticleId* end() const { return last; }
  };
  Range of(ParticleId p) const {
    return {neighbours_.data() + start_[p.value], neighbours_.data() + start_[p.value + 1]};
  }
  std::int64_t rebuilds() const { return rebuilds_; }

 private:
  bool stale(const PerParticle<Vec3d>& r) const;
  void rebuild(const PerParticle<Vec3d>& r);

  double max_reach_, skin_;
  Reach reach_;
  Excluded excluded_;
  PerParticle<Vec3d> r_built_;
  std::vector<std::size_t> start_;
  std::vector<ParticleId> neighbours_;
  std::int64_t rebuilds_ = 0;
};

}  // namespace vbond
