#pragma once
#include <limits>

#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// To how much an eigenvalue of the tangent K is known that belongs to a smooth mode: entries are rounded to
/// eps of themselves, and a tenth of that is left of the sum over many (measured: columns of 20 to 320
/// bonds). What is nearer to zero than this is neither positive nor negative. NaN if K is not finite.
/// [force/length]
inline double eigenvalue_error(const SparseMatrix& K) {
  return 0.1 * std::numeric_limits<double>::epsilon() * max_norm(K.diagonal());
}

}  // namespace vbond
