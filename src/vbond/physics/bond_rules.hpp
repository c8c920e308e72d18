#pragma once
#include "vbond/physics/flow.hpp"
#include "vbond/physics/strength.hpp"
#include "vbond/physics/stretch.hpp"

namespace vbond {

/// What is left of a bond when it breaks: two plane faces that push and rub.
struct Rubbing {
  double friction = 0;  ///< coefficient of friction of the faces, >= 0
  double reach = 0;  ///< shift at which they part, over the radius that c_B and c_A tell; 0: nothing is left

  bool any() const { return reach > 0.0; }
  friend constexpr bool operator==(const Rubbing&, const Rubbing&) = default;
};

/// What the bonds of a set share besides being elastic: the form of their stretching, whether they damp, what
/// they break by, and how they flow or soften.
struct BondRules {
  Stretch stretch;
  Strength strength;
  bool damped = false;  ///< whether some coefficient of damping is not zero
  Yield yield;
  Creep creep;
  Softening softening;
  Rubbing rubbing;

  bool can_break() const { return strength.criterion != Criterion::none || softening.any(); }
  /// Whether bonds remember something.
  bool flow() const { return yield != Yield{} || creep.rate > 0.0 || softening.any(); }
  friend constexpr bool operator==(const BondRules&, const BondRules&) = default;
};

/// Rules of bonds that stretch harmonically, do not damp and do not break.
inline constexpr BondRules no_rules{};

}  // namespace vbond
