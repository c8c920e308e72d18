#pragma once
#include <cstdint>

#include "vbond/model/bond.hpp"
#include "vbond/model/state.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

/// The shape of a bond as its particles stand now.
inline BondShape bond_shape(const Bond& b, const State& s) {
  return bond_shape(bond_pose(b, s), b.R_i, b.R_j);
}

/// How many bonds stand outside the range of their law now.
struct RangeCounts {
  std::int64_t strained = 0;  ///< past 45 degrees but not past 90
  std::int64_t snapped = 0;   ///< past 90 degrees
  friend bool operator==(const RangeCounts&, const RangeCounts&) = default;
};

inline RangeCounts count_ranges(const State& s) {
  RangeCounts n;
  for (const Bond& b : s.bonds) {
    const BondRange range = bond_range(b, bond_shape(b, s));
    n.strained += range == BondRange::strained;
    n.snapped += range == BondRange::snapped;
  }
  return n;
}

}  // namespace vbond
