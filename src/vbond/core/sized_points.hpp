#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/near_pairs.hpp"

namespace vbond {

/// Points of different size, for finding all pairs that are within reach of each other: a grid of cells for
/// each class of sizes, so that large points do not widen the cells of small ones. Sizes of a class differ by
/// less than a factor of two.
class SizedPoints {
 public:
  SizedPoints() = default;
  /// A pair is within reach if its distance is below the sum of its sizes and the margin.  [length]
  explicit SizedPoints(std::span<const double> sizes, double margin = 0.0) : margin_(margin) {
    double largest = 0.0;
    for (const double size : sizes) largest = std::max(largest, size);
    const auto number = [&](double size) {
      constexpr int most = 40;
      if (!(size > 0.0)) return most;
      return std::min(most, std::ilogb(largest / size));
    };
    std::vector<std::vector<std::size_t>> members(41);
    for (std::size_t k = 0; k < sizes.size(); ++k)
      members[static_cast<std::size_t>(number(sizes[k]))].push_back(k);
    class_of_.resize(sizes.size());
    for (std::vector<std::size_t>& m : members) {
      if (m.empty()) continue;
      Class c;
      for (const std::size_t k : m) {
        class_of_[k] = static_cast<std::uint8_t>(classes_.size());
        c.largest = std::max(c.largest, sizes[k]);
      }
      c.members = std::move(m);
      classes_.push_back(std::move(c));
    }
  }

  /// Sorts finite positions, one for each size. The result does not depend on the workers.
  template <class Workers = OneWorker>
  void sort(std::span<const Vec3d> positions, const Workers& workers = {}) {
    r_ = positions;
    for (Class& c : classes_) {
      const double distance = 2.0 * c.largest + margin_;
      if (classes_.size() == 1) {
        c.grid.sort(positions, distance, workers);
        continue;
      }
      c.r.resize(c.members.size());
      for (std::size_t k = 0; k < c.r.size(); ++k) c.r[k] = positions[c.members[k]];
      c.grid.sort(c.r, distance, workers, c.members);
    }
  }

  /// Calls scan(first, last) for ranges of points which together hold every point within reach of point i,
  /// itself among them, each once, and others. The positions must still be there.
  template <class Scan>
  void scan_near(std::size_t i, Scan&& scan) const {
    if (classes_.size() == 1) return classes_[0].grid.scan_near(i, scan);
    for (std::size_t k = 0; k < classes_.size(); ++k) {
      const Class &c = classes_[k], &own = classes_[class_of_[i]];
      if (k <= class_of_[i])
        c.grid.scan_near(r_[i], scan);
      else
        c.grid.scan_within(r_[i], own.largest + c.largest + margin_, scan);
    }
  }

 private:
  struct Class {
    double largest = 0.0;
    std::vector<std::size_t> members;
    std::vector<Vec3d> r;
    CellGrid grid;
  };
  double margin_ = 0.0;
  std::vector<Class> classes_;  // from large to small
  std::vector<std::uint8_t> class_of_;
  std::span<const Vec3d> r_;
};

/// Calls visit(i, j, |r_j - r_i|^2), i < j, once for every pair of finite positions nearer than the sum of
/// their sizes, one each, and the margin >= 0, in increasing order of i.
template <class Visit>
void for_overlapping_pairs(std::span<const Vec3d> positions, std::span<const double> sizes, double margin,
                           Visit&& visit) {
  SizedPoints points(sizes, margin);
  points.sort(positions);
  for (std::size_t i = 0; i < positions.size(); ++i)
    points.scan_near(i, [&](const CellGrid::Point* first, const CellGrid::Point* last) {
      for (const CellGrid::Point* p = first; p != last; ++p) {
        if (p->i <= i) continue;
        const double d2 = norm2(between(positions[i], p->r));
        if (d2 < sq(sizes[i] + sizes[p->i] + margin)) visit(i, p->i, d2);
      }
    });
}
template <class Visit>
void for_overlapping_pairs(std::span<const Vec3d> positions, std::span<const double> sizes, Visit&& visit) {
  for_overlapping_pairs(positions, sizes, 0.0, visit);
}

}  // namespace vbond
