#pragma once
#include "vbond/statics/detail/matrix.hpp"

/// Eigenvalues, singular values and factors of dense matrices, by Eigen. Its templates for them are compiled
/// in dense.cpp and nowhere else: each file that had its own took up to half a minute of compiling.
namespace vbond {

struct DenseEigen {
  Vector values;        ///< in increasing order
  DenseMatrix vectors;  ///< one column each
  bool found = false;   ///< false if the iteration did not end: the matrix is not finite
};

/// All eigenpairs of a symmetric matrix, of which the lower triangle is read; vectors are orthonormal.
DenseEigen dense_eigenpairs(const DenseMatrix& A);
/// The same without vectors.
DenseEigen dense_eigenvalues(const DenseMatrix& A);
/// All pairs of A x = theta B x, A symmetric and B positive definite; x^T B x = 1.
DenseEigen dense_eigenpairs(const DenseMatrix& A, const DenseMatrix& B);

/// A = U diag(values) V^T.
struct DenseSingular {
  Vector values;  ///< in decreasing order
  DenseMatrix U;  ///< as many columns as there are values
  DenseMatrix V;  ///< square: beyond the values, columns that A takes to zero
};

DenseSingular singular_values(const DenseMatrix& A);
/// The same without U, and with full pivoting: for a matrix whose columns differ in size by many orders.
DenseSingular singular_values_pivoted(const DenseMatrix& A);

/// An orthonormal basis of what the columns span.
DenseMatrix orthonormal(const DenseMatrix& X);
/// R of A = Q R, A with at least as many rows as columns: square.
DenseMatrix upper_factor(const DenseMatrix& A);

/// x with A x = b, A square and regular, by LU with full pivoting.
Vector solve_dense(const DenseMatrix& A, const Vector& b);
/// The shortest x for which A x is nearest to b.
Vector solve_shortest(const DenseMatrix& A, const Vector& b);

}  // namespace vbond
