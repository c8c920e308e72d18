#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/crew.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Particles cut into parts, slab by slab along the longest side of the body, so that each part has about as
/// many bonds. What bonds do to particles, or to columns of the tangent, parts add up side by side: a bond
/// between two of them is worked out by both, and each adds to its own particles. So every sum takes its
/// bonds in their order, however many parts there are.
class BondShares {
 public:
  /// One part.
  explicit BondShares(const State& s);
  /// As many as there are threads.
  BondShares(const State& s, std::shared_ptr<Crew> crew);

  std::size_t parts() const { return bonds_.size(); }
  /// Calls work(part) for all of them at once.
  template <class Work>
  void for_parts(Work work) const {
    if (crew_)
      crew_->for_each(work);
    else
      work(0);
  }
  /// Bonds with an end in this part that hold when the shares are made, but for those with an image.
  const std::vector<BondId>& bonds(std::size_t part) const { return bonds_[part]; }
  bool owns(std::size_t part, ParticleId p) const { return part_of_[p] == part; }
  /// Those with an image, which act on the cell as well.
  const std::vector<BondId>& with_images() const { return with_images_; }

 private:
  BondShares(const State& s, std::shared_ptr<Crew> crew, std::size_t parts);

  std::shared_ptr<Crew> crew_;
  PerParticle<std::uint16_t> part_of_;
  std::vector<std::vector<BondId>> bonds_;
  std::vector<BondId> with_images_;
};

}  // namespace vbond
