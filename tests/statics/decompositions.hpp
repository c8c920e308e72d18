#pragma once
#include <complex>

#include "vbond/statics/detail/dense.hpp"

/// What tests alone ask of dense matrices, by Eigen. Its templates are compiled in decompositions.cpp and
/// nowhere else, as those of the library are: half the time of compiling these tests went into them.
namespace vbond::testing {

/// Eigenvalues of a Hermitian matrix in increasing order, and of K x = theta M x with M positive definite.
Vector hermitian_eigenvalues(const Eigen::MatrixXcd& K);
Vector hermitian_eigenvalues(const Eigen::MatrixXcd& K, const Eigen::MatrixXcd& M);

/// A = X diag(values) X^-1 of a matrix without symmetry.
struct Diagonalised {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd X, inverse;
};
Diagonalised diagonalised(const DenseMatrix& A);

/// A^-1 B and the determinant, by LU.
DenseMatrix solved(const DenseMatrix& A, const DenseMatrix& B);
double determinant(const DenseMatrix& A);

}  // namespace vbond::testing
