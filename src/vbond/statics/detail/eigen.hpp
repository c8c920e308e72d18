#pragma once
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/detail/matrix.hpp"

/// Some eigenpairs of large sparse matrices, by Lanczos iteration (Spectra) on the inverse; small matrices
/// are solved densely. Lanczos may miss copies of a multiple eigenvalue: how many there are up to the last
/// one found is counted by Sylvester's law of inertia, and missing ones are looked for among vectors normal
/// to those found. All throw NoConvergence.
namespace vbond {

struct EigenPairs {
  Vector values;        ///< in increasing order of what was asked for
  DenseMatrix vectors;  ///< one column each, of length 1
  int factors = 0;      ///< that were made to find them
};

/// The `count` eigenvalues of the symmetric A above (algebraically) `bound`, or at it to rounding, smallest
/// first, with multiplicity. Eigenvectors of A in the columns of `without` (orthonormal) are left out. Fewer
/// are returned if there are fewer.
EigenPairs smallest_eigenpairs(const SparseMatrix& A, int count, double bound,
                               const SparseMatrix& without = {});

/// The `count` eigenvalues of the symmetric, not necessarily definite A that are nearest to zero, nearest
/// first. of_same_pattern: a factor whose analysis is taken.
EigenPairs eigenpairs_near_zero(const SparseMatrix& A, int count, const Factor* of_same_pattern = nullptr);

/// The eigenvalue nearest to zero of an A whose factor is at hand: much cheaper, but it does not tell copies.
double eigenvalue_near_zero(const SparseMatrix& A, const Factor& factor);

/// The smallest positive mu with A x + mu B x = 0, A positive definite and B symmetric; x^T A x = 1. Those
/// beyond 10^4 times the mu of smallest size, of whatever sign, are not looked for; fewer are returned if
/// there are fewer. A that is not positive definite to
/// rounding is no case for it: NoConvergence.
EigenPairs critical_factors(const SparseMatrix& A, const SparseMatrix& B, int count);

/// The largest eigenvalue of the symmetric A, from above: theta + |A x - theta x| of an approximate pair.
/// High by 1e-10 of it, by 1e-6 at most where very many lie next to it.
double largest_eigenvalue(const SparseMatrix& A);

/// Vector number `mode` of a basis of the columns' span that does not depend on the columns chosen in it:
/// each vector is the one that moves some unknown most, that unknown forwards, and is normal to those before.
/// Of unknowns that can be moved as far to 1e-6, which is more than rounding, it is the first.
Vector mode_of_cluster(DenseMatrix columns, int mode);

}  // namespace vbond
