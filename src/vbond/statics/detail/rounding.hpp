#pragma once
#include <cmath>
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

/// The same of the eigenvalue x^T K x whose mode x, of length 1, is at hand. Entries are rounded to eps at
/// random: the root of the sum of squares of what each adds is the spread that is seen (pinned columns of 10
/// to 320 bonds, EA L^2 / EI = 400 to 4e6, 21 loads each: 0.4 to 1.2 of it), and three of it are passed by
/// none. Where bonds are stiff beside the mode, rounding of positions and of balance is more: then it is the
/// estimate for all.
inline double eigenvalue_error(const SparseMatrix& K, const Vector& x) {
  double sum = 0.0;
  for (Eigen::Index column = 0; column < K.outerSize(); ++column)
    for (SparseMatrix::InnerIterator it(K, column); it; ++it) {
      const double share = it.value() * x[it.row()] * x[it.col()];
      sum += share * share;
    }
  return larger(eigenvalue_error(K), 3.0 * std::numeric_limits<double>::epsilon() * std::sqrt(sum));
}

}  // namespace vbond
