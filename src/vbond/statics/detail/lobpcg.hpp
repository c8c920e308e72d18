#pragma once
#include <functional>
#include <string>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/matrix.hpp"

/// The lowest eigenpairs of large symmetric matrices of which only products are at hand and a rough inverse:
/// LOBPCG (Knyazev, SIAM J. Sci. Comput. 23 (2001) 517) on an orthonormal basis, with guard vectors, so that
/// equal eigenvalues are found together.
namespace vbond {

using OfColumns = std::function<DenseMatrix(const DenseMatrix&)>;

/// A x = lambda B x.
struct LowestProblem {
  Eigen::Index size = 0;
  OfColumns times;                        ///< A x
  OfColumns inverse;                      ///< roughly A^-1 x: symmetric and positive definite
  OfColumns metric;                       ///< B x, positive definite; empty: B is 1
  const SparseMatrix* without = nullptr;  ///< B-orthonormal eigenvectors that are left out
  double rounding = 0;                    ///< what rounding leaves of the residual of a pair
};

/// When it is enough: `count` pairs with |A x - lambda B x| <= tolerance max(|lambda|, share of the largest
/// |lambda| that is looked at).
struct LowestWanted {
  int count = 1;
  double tolerance = 1e-6;
  double share = 0;
  int iterations = 500;
};

struct Lowest {
  Vector values;        ///< in increasing order
  DenseMatrix vectors;  ///< one column each, B-orthonormal
  /// How far each value may be off: its residual, or the square of that over the distance to the next value
  /// that is not close by.
  Vector errors;
  DenseMatrix guards;  ///< roughly those that follow
  int iterations = 0;
  std::string why_not;  ///< empty, or why it is not enough: then the pairs are as good as they have become
  int size() const { return static_cast<int>(values.size()); }
};

/// The rough inverse turned out not to be positive definite.
class InverseNotDefinite : public NoConvergence {
 public:
  using NoConvergence::NoConvergence;
};

/// Begins with the columns of `start`, any number of them. That no pair lies below those found is not proven.
/// Throws NoConvergence if the matrix is not finite. With as few unknowns as can be solved densely it does
/// that.
Lowest lowest_eigenpairs(const LowestProblem& problem, const LowestWanted& wanted,
                         const DenseMatrix& start = {});

}  // namespace vbond
