#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "vbond/core/large_array.hpp"
#include "vbond/core/sized_points.hpp"
#include "vbond/dynamics/contact_kernel.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/dynamics/team.hpp"

namespace vbond {

/// Which particles may come within reach of each other before the next rebuild (a Verlet list from
/// cells). Between rebuilds no pair closer than its reach is missing: every pair closer than reach +
/// skin is listed, and the list is rebuilt once a particle has moved half the skin. Particles that are not at
/// finite places have no neighbours, nor has any other as long as there are such. What is listed does not
/// depend on the number of threads that look for it.
class NeighbourList {
 public:
  /// Which of the rows [first, last), all near i and in no order, are to be listed: moves them to the front
  /// and returns their end. Asked at a rebuild only, by all threads at once. A pair is kept from both sides
  /// or left out from both.
  using Keep = std::function<Row*(Row i, Row* first, Row* last)>;

  /// The reach of a pair is the sum of its two radii, which are >= 0, one per row; skin > 0.  [length]
  NeighbourList(PerRow<double> radius, double skin, Keep keep = {});

  /// Rebuilds if a particle has moved more than half the skin, or after invalidate(). Returns whether it did.
  /// One pose per row; the team is one for these rows. way: no particle has moved farther since the last
  /// call, by which most calls need not look at them.  [length]
  /// before_rebuild: called while the old list is still there; may be empty.
  bool refresh(std::span<const PoseRow> pose, const Team& team,
               double way = std::numeric_limits<double>::infinity(),
               const std::function<void()>& before_rebuild = {});
  /// The answers of Keep have changed.
  void invalidate() { valid_ = false; }

  /// The neighbours of i in increasing order; every pair is listed from both sides.
  std::span<const Row> of(Row i) const {
    return {neighbours_.data() + start_[i.value], neighbours_.data() + end_[i.value]};
  }
  /// The place of j among the neighbours of i in the list of all, if it is there.
  std::optional<std::size_t> place_of(Row i, Row j) const;
  /// Places in the list of all.
  std::size_t places() const { return neighbours_.size(); }
  /// All of them.
  NearRows rows() const { return {start_.data(), end_.data(), neighbours_.data()}; }
  /// Lists a pair that Keep had left out, as a rebuild would, at the cost of two rows; nothing while the list
  /// is to be rebuilt.
  void add(Row i, Row j);
  std::int64_t rebuilds() const { return rebuilds_; }

 private:
  /// What a thread finds in its part of the rows.
  struct OfPart {
    double moved2 = 0;       // the largest square of a way since the last rebuild  [length^2]
    bool nowhere = false;    // some particle is at no finite place
    std::vector<Row> near;   // row by row, in no order
    std::size_t before = 0;  // neighbours of the rows of parts before
  };

  bool stale(std::span<const PoseRow> pose, const Team& team);
  void rebuild(std::span<const PoseRow> pose, const Team& team);
  void find_near(RowRange rows, std::vector<Row>& near);
  void sort_found(const Team& team, const Part& part);
  RowRange rows_of(const Part& part) const;
  void add_to(Row i, Row j);

  PerRow<double> radius_;
  double skin_, max_radius_;
  bool equal_radii_;
  Keep keep_;
  bool valid_ = false;
  double room_ = 0;             // no particle has moved half the skin before one has moved so far  [length]
  std::vector<Vec3d> r_built_;  // positions at the last rebuild  [length]
  std::vector<std::size_t> start_, end_;  // of each row, in neighbours_
  LargeArray<Row> neighbours_;
  std::int64_t rebuilds_ = 0;

  // Used by a rebuild only, kept for its memory.
  SizedPoints grid_;
  std::vector<OfPart> of_part_;
  std::vector<std::size_t> near_end_;  // of each row, in what its part has found
};

}  // namespace vbond
