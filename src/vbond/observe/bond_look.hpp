#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/state.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

/// The shape of a bond as its particles stand now.
inline BondShape bond_shape(const Bond& b, const State& s) {
  return bond_shape(bond_pose(b, s), b.R_i, b.R_j);
}

/// Every unbroken bond that is strained or snapped, shorter than half or longer than twice its length at
/// rest, and perhaps a few that are close to it, in increasing order.
inline std::vector<BondId> deformed_bonds(const State& s) {
  std::vector<BondId> deformed;
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (!b.broken && needs_look(bond_tilt(bond_pose(b, s), b.R_i, b.R_j), b.a)) deformed.push_back(k);
  }
  return deformed;
}

/// How many bonds stand outside the range of their law now.
struct RangeCounts {
  std::int64_t strained = 0;  ///< past 45 degrees but not past 90
  std::int64_t snapped = 0;   ///< past 90 degrees
  friend bool operator==(const RangeCounts&, const RangeCounts&) = default;
};

/// Counts among these bonds.
inline RangeCounts count_ranges(const State& s, const std::vector<BondId>& bonds) {
  RangeCounts n;
  for (const BondId k : bonds) {
    const BondRange range = bond_range(s.bonds[k], bond_shape(s.bonds[k], s));
    n.strained += range == BondRange::strained;
    n.snapped += range == BondRange::snapped;
  }
  return n;
}

/// Counts among all bonds.
inline RangeCounts count_ranges(const State& s) {
  return count_ranges(s, deformed_bonds(s));
}

/// Counts among all bonds of a run; only the deformed ones are looked at, so without any this is free.
inline RangeCounts count_ranges(const Simulation& run) {
  const std::vector<BondId>& deformed = run.survey().deformed;
  return deformed.empty() ? RangeCounts{} : count_ranges(run.state(), deformed);
}

/// How many bonds have broken.
inline std::int64_t count_broken(const PerBond<Bond>& bonds) {
  return std::count_if(bonds.begin(), bonds.end(), [](const Bond& b) { return b.broken; });
}

/// How many bonds there are now, broken ones too.
inline std::int64_t count_bonds(const Simulation& run) {
  return static_cast<std::int64_t>(run.bonds().size());
}

}  // namespace vbond
