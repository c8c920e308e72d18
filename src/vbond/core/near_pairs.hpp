#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/cell.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Does work(k) for all k < count(), here one after the other. Others, of the same form, do so at once: each
/// call writes only what is its own.
struct OneWorker {
  std::size_t count() const { return 1; }
  template <class Work>
  void for_each(Work work) const {
    work(std::size_t{0});
  }
};

/// Points sorted into cubic cells, for finding all pairs within a distance in a time that grows with the
/// number of points and pairs. Cells lie in a table of a few entries per point, whatever the extent of the
/// body: cells far from each other may share an entry, which costs a look at a few points too many.
class CellGrid {
 public:
  struct Point {
    Vec3d r;
    std::size_t i;  ///< its place among the positions, or its name
  };

  CellGrid() = default;
  CellGrid(std::span<const Vec3d> positions, double distance) { sort(positions, distance); }

  /// Sorts fewer than 2^28 finite positions; cells are a little wider than `distance` >= 0. The result does
  /// not depend on the workers. Memory is kept from one call to the next. names: of the points, in place of
  /// their numbers; empty or one each.
  template <class Workers = OneWorker>
  void sort(std::span<const Vec3d> positions, double distance, const Workers& workers = {},
            std::span<const std::size_t> names = {}) {
    const std::size_t n = positions.size(), shares = workers.count();
    std::vector<BoundingBox> box(shares);
    workers.for_each([&](std::size_t k) {
      box[k] = box_around(positions.subspan(n * k / shares, n * (k + 1) / shares - n * k / shares));
    });
    lay_out(positions, box, distance);
    entry_.resize(n);
    workers.for_each([&](std::size_t k) {
      for (std::size_t i = n * k / shares; i < n * (k + 1) / shares; ++i)
        entry_[i] = entry(cell_of(positions[i]));
    });

    // Each worker counts and takes up all points of some entries, in order.
    first_.resize(std::size_t{mask_} + 2);
    points_.resize(n);
    std::vector<std::uint32_t> points(shares);  // before each share
    const auto entries = [&](std::size_t k) {
      const auto bound = [&](std::size_t at) { return at == shares ? first_.size() : in_use_ * at / shares; };
      return std::pair(bound(k), bound(k + 1));
    };
    workers.for_each([&](std::size_t k) {
      const auto [begin, end] = entries(k);
      std::fill(first_.begin() + static_cast<std::ptrdiff_t>(begin),
                first_.begin() + static_cast<std::ptrdiff_t>(end), 0u);
      std::uint32_t own = 0;
      for (const std::uint32_t e : entry_)
        if (e - begin < end - begin) ++first_[e], ++own;
      points[k] = own;
    });
    std::exclusive_scan(points.begin(), points.end(), points.begin(), 0u);
    workers.for_each([&](std::size_t k) {
      const auto [begin, end] = entries(k);
      std::uint32_t last = points[k];
      for (std::size_t e = begin; e < end; ++e) first_[e] = last += first_[e];
      for (std::size_t i = n; i-- > 0;)
        if (entry_[i] - begin < end - begin)
          points_[--first_[entry_[i]]] = {positions[i], names.empty() ? i : names[i]};
    });
  }

  /// Calls scan(first, last) for ranges of points which together hold every point within the distance of
  /// position i, itself among them, each once, and others.
  template <class Scan>
  void scan_near(std::size_t i, Scan&& scan) const {
    scan_around(entry_[i], scan);
  }
  /// The same for any finite point in space.
  template <class Scan>
  void scan_near(const Vec3d& r, Scan&& scan) const {
    scan_around(entry(cell_of(r)), scan);
  }
  /// The same for all points within `reach` >= 0 of a finite point in space, which may be many cells.
  template <class Scan>
  void scan_within(const Vec3d& r, double reach, Scan&& scan) const {
    const Vec3d d{reach, reach, reach};
    const Cell low = clamped(cell_of(r - d)), high = clamped(cell_of(r + d));
    const auto cells = [](std::int64_t from, std::int64_t to) { return static_cast<double>(to - from + 1); };
    const double count = cells(low.x, high.x) * cells(low.y, high.y) * cells(low.z, high.z);
    const Point* const p = points_.data();
    if (count > static_cast<double>(in_use_)) return scan(p, p + points_.size());
    for (std::int64_t z = low.z; z <= high.z; ++z)
      for (std::int64_t y = low.y; y <= high.y; ++y) {
        if (own_entries_) {
          const std::uint32_t from = entry({low.x, y, z});
          scan(p + first_[from], p + first_[from + static_cast<std::size_t>(high.x - low.x) + 1]);
          continue;
        }
        for (std::int64_t x = low.x; x <= high.x; ++x) {  // cells may share entries
          const std::uint32_t from = entry({x, y, z});
          for (const Point* q = p + first_[from]; q != p + first_[from + 1]; ++q)
            if (cell_of(q->r) == Cell{x, y, z}) scan(q, q + 1);
        }
      }
  }

 private:
  struct Cell {
    std::int64_t x, y, z;
    friend bool operator==(const Cell&, const Cell&) = default;
  };

  template <class Scan>
  void scan_around(std::uint32_t at, Scan&& scan) const {
    const Point* const p = points_.data();
    for (std::uint32_t z = 0; z < 3; ++z)
      for (std::uint32_t y = 0; y < 3; ++y) {
        const std::size_t from = (at - 1 + stride_y_ * (y - 1) + stride_z_ * (z - 1)) & mask_, to = from + 3;
        if (to < first_.size()) {  // three cells next to each other along x are neighbours in the table
          scan(p + first_[from], p + first_[to]);
        } else {
          scan(p + first_[from], p + points_.size());
          scan(p, p + first_[to & mask_]);
        }
      }
  }

  /// To the cells of the body, if each has its own entry: beside it there are no points.
  Cell clamped(const Cell& c) const {
    if (!own_entries_) return c;
    return {std::clamp<std::int64_t>(c.x, 0, cells_.x - 1), std::clamp<std::int64_t>(c.y, 0, cells_.y - 1),
            std::clamp<std::int64_t>(c.z, 0, cells_.z - 1)};
  }
  /// To either side of the origin; what is farther out shares the last cell.
  static constexpr double most_cells = 0x1p40;

  Cell cell_of(const Vec3d& p) const {
    const auto along = [this](double x, double x_0) {
      return static_cast<std::int64_t>(std::clamp((x - x_0) / width_, -most_cells, most_cells));
    };
    return {along(p.x, origin_.x), along(p.y, origin_.y), along(p.z, origin_.z)};
  }

  /// Cells are wider than the distance by more than rounding may move two points in units of cells: no pair
  /// gets two cells apart.
  void lay_out(std::span<const Vec3d> r, const std::vector<BoundingBox>& parts, double distance) {
    BoundingBox box;
    for (const BoundingBox& part : parts) box.join(part);
    if (r.empty()) box.add({});
    const Vec3d extent = box.high - box.low;
    origin_ = box.low;
    width_ = distance > 0.0 ? distance * (1.0 + 1e-9) : 1.0;
    if (std::max({extent.x, extent.y, extent.z}) > 0x1p20 * width_) {
      origin_ = r[r.size() / 2];  // in the body, from which some part has flown off
      width_ *= 1.001;
    }
    choose_strides(extent, static_cast<double>(r.size()));
  }

  /// The entries of the 27 cells around a point must differ. They do if the strides are at least 5 and 25:
  /// the difference of two such cells then has five values of each digit, -2..2, and stands for one number
  /// only.
  void choose_strides(const Vec3d& extent, double points) {
    const auto cells = [this](double x) { return std::max(std::floor(x / width_) + 2.0, 5.0); };
    const double nx = cells(extent.x), ny = cells(extent.y), nz = cells(extent.z);
    own_entries_ = nx * ny * nz <= 8.0 * points;
    if (own_entries_) {  // a compact body, entries in order
      cells_ = {static_cast<std::int64_t>(nx), static_cast<std::int64_t>(ny), static_cast<std::int64_t>(nz)};
      stride_y_ = static_cast<std::uint32_t>(nx);
      stride_z_ = static_cast<std::uint32_t>(nx * ny);
      in_use_ = static_cast<std::size_t>(nx * ny * nz);
      mask_ = std::bit_ceil(static_cast<std::uint32_t>(in_use_)) - 1;
    } else {  // rows of cells at places as if thrown at random; modulo 64 the strides are 5 and 25
      stride_y_ = 0x9E3779B9u / 64 * 64 + 5;
      stride_z_ = 0x85EBCA6Bu / 64 * 64 + 25;
      mask_ = std::bit_ceil(static_cast<std::uint32_t>(std::max(64.0, 2.0 * points))) - 1;
      in_use_ = std::size_t{mask_} + 1;
    }
  }
  std::uint32_t entry(const Cell& c) const {
    return (static_cast<std::uint32_t>(c.x) + stride_y_ * static_cast<std::uint32_t>(c.y) +
            stride_z_ * static_cast<std::uint32_t>(c.z)) &
           mask_;
  }

  double width_ = 1.0;
  Vec3d origin_;
  std::uint32_t stride_y_ = 0, stride_z_ = 0, mask_ = 0;
  bool own_entries_ = false;          // every cell of the body has one
  Cell cells_{};                      // if so: how many
  std::size_t in_use_ = 0;            // entries below which nearly all points are
  std::vector<std::uint32_t> entry_;  // of each position
  std::vector<std::uint32_t> first_;  // of each entry of the table, into points_
  std::vector<Point> points_;
};

/// Calls visit(i, j, |r_j - r_i|^2), i < j, once for every pair of finite positions within `distance` >= 0,
/// in increasing order of i. A visit that returns false ends it.
template <class Visit>
void for_near_pairs(std::span<const Vec3d> positions, double distance, Visit&& visit) {
  const CellGrid grid(positions, distance);
  bool going_on = true;
  const auto visited = [&](std::size_t i, std::size_t j, double d2) {
    if constexpr (std::is_same_v<decltype(visit(i, j, d2)), bool>)
      going_on = visit(i, j, d2);
    else
      visit(i, j, d2);
  };
  for (std::size_t i = 0; i < positions.size() && going_on; ++i)
    grid.scan_near(i, [&](const CellGrid::Point* first, const CellGrid::Point* last) {
      for (const CellGrid::Point* p = first; p != last && going_on; ++p) {
        if (p->i <= i) continue;
        const double d2 = norm2(between(positions[i], p->r));
        if (d2 <= sq(distance)) visited(i, p->i, d2);
      }
    });
}

}  // namespace vbond
