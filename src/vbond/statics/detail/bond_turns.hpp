#pragma once
#include <optional>

#include "vbond/statics/detail/body.hpp"

namespace vbond {

/// How far the bonds have turned between two placements: the largest change of angle between the two
/// particles of a bond, or between its line and one of them.  [rad]
double largest_bond_turn(const State& now, const Placement& before);

/// The first bond that is snapped now and was not before.
std::optional<BondId> newly_snapped(const State& now, const Placement& before);

}  // namespace vbond
