#pragma once
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

struct EigenPairs {
  Vector values;        ///< in increasing order of what was asked for
  DenseMatrix vectors;  ///< one column each, of length 1
};

/// The `count` eigenvalues of the symmetric A just above (algebraically) `bound`, smallest first, with
/// multiplicity: their number is checked against the inertia of A - s I, s beyond the last of them, and
/// missing ones are looked for again among vectors normal to those found. Vectors in the columns of `without`
/// (orthonormal eigenvectors of A) are left out. Small matrices are solved densely.
/// Fewer are returned if A is smaller. Throws NoConvergence.
EigenPairs smallest_eigenpairs(const SparseMatrix& A, int count, double bound,
                               const DenseMatrix& without = {});

/// The `count` eigenvalues of the symmetric, not necessarily definite A that are nearest to zero.
EigenPairs eigenpairs_near_zero(const SparseMatrix& A, int count);

/// The smallest positive mu with A x + mu B x = 0, A positive definite and B symmetric; x^T A x = 1.
EigenPairs critical_factors(const SparseMatrix& A, const SparseMatrix& B, int count);

/// The largest eigenvalue of the symmetric A, to 1e-10 relative, from above if in doubt.
double largest_eigenvalue(const SparseMatrix& A);

}  // namespace vbond
