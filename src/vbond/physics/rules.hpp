#pragma once
#include "vbond/physics/strength.hpp"
#include "vbond/physics/stretch.hpp"

namespace vbond {

/// What the bonds of a set share besides being elastic: the form of their stretching, whether they damp, and
/// what they break by.
struct BondRules {
  Stretch stretch;
  Strength strength;
  bool damped = false;  ///< whether some coefficient of damping is not zero

  bool can_break() const { return strength.criterion != Criterion::none; }
  friend constexpr bool operator==(const BondRules&, const BondRules&) = default;
};

/// Rules of bonds that stretch harmonically, do not damp and do not break.
inline constexpr BondRules no_rules{};

}  // namespace vbond
