#pragma once
#include <limits>

#include "vbond/physics/touch_forms.hpp"

namespace vbond {

/// Of two that move as prescribed, 1/m* = 0: no damping follows from a restitution, so that m* counts as 0.
template <Scalar T>
VBOND_HD Touching<T> undamped_if_none_is_free(Touching<T> p) {
  const T most(std::numeric_limits<double>::max()), zero(0.0);
  p.m = where_greater(p.m, most, zero, p.m);
  return p;
}

}  // namespace vbond
