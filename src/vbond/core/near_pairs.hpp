#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Points sorted into cubic cells, for finding all pairs within a distance in a time that grows with
/// the number of points and pairs. Made for single look-ups, not for the time loop.
class CellGrid {
 public:
  /// Positions must be finite; cells are at least `distance` > 0 wide.
  CellGrid(const std::vector<Vec3d>& positions, double distance) : r_(positions), reach_(distance) {
    if (r_.empty()) return;
    Vec3d max = min_ = r_.front();
    for (const Vec3d& p : r_) {
      min_ = {std::min(min_.x, p.x), std::min(min_.y, p.y), std::min(min_.z, p.z)};
      max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
    }
    const Vec3d extent = max - min_;
    // 20 bits per direction are kept for the cell number, so cells never get narrower than this;
    // a little is added so that rounding of the division cannot push a pair two cells apart
    width_ = std::max(distance * (1.0 + 1e-9), std::max({extent.x, extent.y, extent.z}) / 1048576.0);
    if (!(width_ > 0.0)) width_ = 1.0;
    cells_.reserve(r_.size());
    for (std::size_t i = 0; i < r_.size(); ++i) cells_.push_back({key(cell_of(r_[i])), i});
    std::sort(cells_.begin(), cells_.end());
  }

  /// Calls visit(i, j, |r_j - r_i|^2), i < j, once for every pair no farther apart than the distance.
  template <class Visit>
  void for_pairs(Visit&& visit) const {
    for (std::size_t i = 0; i < r_.size(); ++i) {
      const Cell c = cell_of(r_[i]);
      for (std::int64_t dz = -1; dz <= 1; ++dz)
        for (std::int64_t dy = -1; dy <= 1; ++dy) visit_row({c[0] - 1, c[1] + dy, c[2] + dz}, i, visit);
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Entry {
    std::uint64_t key;
    std::size_t i;
    bool operator<(const Entry& o) const { return key != o.key ? key < o.key : i < o.i; }
  };

  /// From 1, so that a neighbour's number is never negative.
  Cell cell_of(const Vec3d& p) const {
    const auto along = [this](double x, double x_min) {
      return 1 + static_cast<std::int64_t>((x - x_min) / width_);
    };
    return {along(p.x, min_.x), along(p.y, min_.y), along(p.z, min_.z)};
  }
  static std::uint64_t key(const Cell& c) {
    return (static_cast<std::uint64_t>(c[2]) << 42) | (static_cast<std::uint64_t>(c[1]) << 21) |
           static_cast<std::uint64_t>(c[0]);
  }

  /// Three cells next to each other along x hold consecutive keys: one search serves them all.
  template <class Visit>
  void visit_row(const Cell& first, std::size_t i, Visit&& visit) const {
    const std::uint64_t from = key(first), to = from + 2;
    auto at = std::lower_bound(cells_.begin(), cells_.end(), Entry{from, 0});
    for (; at != cells_.end() && at->key <= to; ++at) {
      if (at->i <= i) continue;
      const double d2 = norm2(r_[at->i] - r_[i]);
      if (d2 <= reach_ * reach_) visit(i, at->i, d2);
    }
  }

  const std::vector<Vec3d>& r_;
  double reach_, width_ = 1.0;
  Vec3d min_;
  std::vector<Entry> cells_;
};

/// Calls visit(i, j, |r_j - r_i|^2), i < j, once for every pair of positions within `distance` > 0.
template <class Visit>
void for_near_pairs(const std::vector<Vec3d>& positions, double distance, Visit&& visit) {
  CellGrid(positions, distance).for_pairs(visit);
}

}  // namespace vbond
