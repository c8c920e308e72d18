#pragma once
#include <algorithm>
#include <string>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/newton.hpp"

namespace vbond {

/// Where a body that is singular, or unstable in some directions, gives way: the degrees of freedom that move
/// most in the lowest of the modes next to singular, in words.
inline std::string softest_names(const StaticBody& body, TangentSolver& solver, int unstable = 0) {
  constexpr int most = 8;
  const EigenPairs near =
      solver.near_zero(body, std::min(std::clamp(unstable, 1, most), body.unknowns().size()));
  Eigen::Index lowest = 0;
  near.values.minCoeff(&lowest);
  return body.unknowns().names_of_largest(near.vectors.col(lowest));
}

}  // namespace vbond
