#pragma once
#include <vector>

#include "vbond/statics/detail/newton.hpp"

namespace vbond {

/// Critical load factors of the problem K x + mu (dK/df) x = 0 about the place where the body stands, which
/// moves with `rate` per load factor: at most `count`, smallest first, fewer if there are fewer, none if they
/// cannot be found. They are those of a body that does not deform before it buckles. Of one that bends, dK/df
/// holds the turns of its stiff bonds, and the factors may be too small by any number.
std::vector<double> linear_critical_factors(StaticBody& body, TangentSolver& solver, const Vector& rate,
                                            int count);

}  // namespace vbond
