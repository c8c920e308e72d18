#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "vbond/model/body_view.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/state.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

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
    const BondRange range = bond_range(s.bonds[k], bond_shape(s, k));
    n.strained += range == BondRange::strained;
    n.snapped += range == BondRange::snapped;
  }
  return n;
}

/// Counts among all bonds.
inline RangeCounts count_ranges(const State& s) {
  return count_ranges(s, deformed_bonds(s));
}

/// Counts among all bonds; only the deformed ones are looked at, so without any this is free.
inline RangeCounts count_ranges(const BodyView& body) {
  const Survey& survey = body.survey();
  if (!survey.any_deformed) return {};
  const BodyPart part = body.part();
  const RangeCounts here = count_ranges(part.state, survey.deformed);
  std::array<double, 2> sums{static_cast<double>(here.strained), static_cast<double>(here.snapped)};
  part.all.sum(sums);
  return {static_cast<std::int64_t>(sums[0]), static_cast<std::int64_t>(sums[1])};
}

/// How many bonds have broken; those that rub from then on, too.
inline std::int64_t count_broken(const BodyPart& body) {
  return count_bonds(body, has_failed);
}

}  // namespace vbond
