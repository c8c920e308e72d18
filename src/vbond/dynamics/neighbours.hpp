#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vbond/core/near_pairs.hpp"
#include "vbond/dynamics/rows.hpp"

namespace vbond {

/// Which particles may come within reach of each other before the next rebuild (a Verlet list from
/// cells). Between rebuilds no pair closer than its reach is missing: every pair closer than reach +
/// skin is listed, and the list is rebuilt once a particle has moved half the skin. Particles that are not at
/// finite places have no neighbours, nor has any other as long as there are such.
class NeighbourList {
 public:
  /// Which of the rows [first, last), all near i and in no order, are to be listed: moves them to the front
  /// and returns their end. Asked at a rebuild only. A pair is kept from both sides or left out from both.
  using Keep = std::function<Row*(Row i, Row* first, Row* last)>;

  /// The reach of a pair is the sum of its two radii, which are >= 0, one per row; skin > 0.  [length]
  NeighbourList(PerRow<double> radius, double skin, Keep keep = {});

  /// Rebuilds if a particle has moved more than half the skin, or after invalidate(). Returns whether it did.
  /// One pose per row.
  bool refresh(std::span<const PoseRow> pose);
  /// The answers of Keep have changed.
  void invalidate() { start_.clear(); }

  /// The neighbours of i in increasing order; every pair is listed from both sides.
  std::span<const Row> of(Row i) const {
    return {neighbours_.data() + start_[i.value], neighbours_.data() + start_[i.value + 1]};
  }
  /// Neighbours of these rows, all together.
  std::size_t count(RowRange rows) const { return start_[rows.last] - start_[rows.first]; }
  std::int64_t rebuilds() const { return rebuilds_; }

 private:
  bool stale(std::span<const PoseRow> pose) const;
  void rebuild(std::span<const PoseRow> pose);
  void find_near(double largest_reach);
  void sort_found();

  PerRow<double> radius_;
  double skin_, max_radius_;
  bool equal_radii_;
  Keep keep_;
  std::vector<Vec3d> r_built_;  // positions at the last rebuild  [length]
  std::vector<std::size_t> start_;
  std::vector<Row> neighbours_;
  std::int64_t rebuilds_ = 0;

  // Used by a rebuild only, kept for its memory.
  CellGrid grid_;
  std::vector<std::size_t> found_start_;
  std::vector<Row> found_;
};

}  // namespace vbond
