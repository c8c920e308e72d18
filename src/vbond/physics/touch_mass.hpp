#pragma once
#include <limits>

#include "vbond/physics/touch_forms.hpp"

namespace vbond {

/// Of two that move as prescribed, 1/m* = 0: no damping follows from a restitution, so that m* counts as 0.
/// (In place: a copy of all these numbers goes through memory.)
template <Scalar T>
VBOND_HD void undamp_if_none_is_free(Touching<T>& p) {
  const T most(std::numeric_limits<double>::max()), zero(0.0);
  p.m = where_greater(p.m, most, zero, p.m);
}

}  // namespace vbond
