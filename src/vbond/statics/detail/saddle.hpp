#pragma once
#include <functional>

#include "vbond/statics/detail/stability.hpp"

namespace vbond {

/// Leaves the unstable balance at which the body stands, of this stability, along its most negative mode, the
/// largest component of which is positive: downhill, or through a valley that is too flat for that. Judges
/// the stability where it comes to, and adds to iterations. Not converged: no other balance was found, and
/// the body is anywhere.
NewtonOutcome leave_saddle(StaticBody& body, TangentSolver& solver, Stability& stability,
                           const std::function<bool()>& interrupted, int& iterations);

}  // namespace vbond
