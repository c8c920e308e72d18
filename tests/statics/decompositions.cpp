#include "decompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace vbond::testing {

namespace {

/// [Re K, -Im K; Im K, Re K] has each eigenvalue of K twice, and needs no templates for complex numbers.
DenseMatrix in_reals(const Eigen::MatrixXcd& K) {
  DenseMatrix A(2 * K.rows(), 2 * K.cols());
  A << K.real(), -K.imag(), K.imag(), K.real();
  return A;
}

/// The first of each two.
Vector every_second(const Vector& values) {
  return values(Eigen::seq(0, Eigen::last, 2));
}

}  // namespace

Vector hermitian_eigenvalues(const Eigen::MatrixXcd& K) {
  return every_second(dense_eigenvalues(in_reals(K)).values);
}

Vector hermitian_eigenvalues(const Eigen::MatrixXcd& K, const Eigen::MatrixXcd& M) {
  return every_second(dense_eigenpairs(in_reals(K), in_reals(M)).values);
}

Diagonalised diagonalised(const DenseMatrix& A) {
  const Eigen::EigenSolver<DenseMatrix> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors(), solver.eigenvectors().inverse()};
}

DenseMatrix solved(const DenseMatrix& A, const DenseMatrix& B) {
  return A.partialPivLu().solve(B);
}

double determinant(const DenseMatrix& A) {
  return A.determinant();
}

}  // namespace vbond::testing
