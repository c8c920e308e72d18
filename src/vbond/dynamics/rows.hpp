#pragma once
#include <cstddef>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/column.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// A particle's place in the step loop, where neighbours in space are neighbours in memory. Only dynamics
/// knows of rows: all others number particles as the case does.
using Row = Id<struct RowTag>;

template <class T>
using PerRow = Column<Row, T>;

/// What the step loop reads and writes of a particle: a cache line each, which a vector unit takes whole.
struct alignas(64) PoseRow {
  Vec3d r;  ///< position  [length]
  double unused = 0;
  Quatd q;  ///< orientation, body to world
};
/// From one to the other.  [length]
VBOND_HD constexpr Vec3d between(const PoseRow& i, const PoseRow& j) {
  return between(i.r, j.r);
}
struct alignas(64) MotionRow {
  Vec3d v;  ///< [length/time]
  double unused_1 = 0;
  Vec3d omega;  ///< [rad/time]
  double unused_2 = 0;
};
struct alignas(64) LoadRow {
  Vec3d F;  ///< [force]
  double unused_1 = 0;
  Vec3d M;  ///< [force*length]
  double unused_2 = 0;
};

/// 1/m and 1/Theta of a particle.
struct InverseInertia {
  double per_m = 0;      ///< [1/mass]
  double per_Theta = 0;  ///< [1/(mass*length^2)]
};

/// Rows [first, last).
struct RowRange {
  std::size_t first, last;
  bool contains(std::size_t row) const { return row - first < last - first; }
};

/// The vector unit takes rows by eights: every array of rows is filled up to a multiple of it with particles
/// that rest at the origin and feel nothing.
inline constexpr std::size_t rows_at_once = 8;
constexpr std::size_t filled_up(std::size_t rows) {
  return (rows + rows_at_once - 1) / rows_at_once * rows_at_once;
}

/// Rows are worked through in blocks that fit the first-level cache. Sums over particles are made block by
/// block, so that they do not depend on the number of threads.
inline constexpr std::size_t block_rows = 128;

struct Block {
  std::size_t index;
  RowRange rows;
};

}  // namespace vbond
