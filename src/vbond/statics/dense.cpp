#include "vbond/statics/detail/dense.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace vbond {

DenseEigen dense_eigenpairs(const DenseMatrix& A) {
  const Eigen::SelfAdjointEigenSolver<DenseMatrix> all(A);
  return {all.eigenvalues(), all.eigenvectors(), all.info() == Eigen::Success};
}

DenseEigen dense_eigenvalues(const DenseMatrix& A) {
  const Eigen::SelfAdjointEigenSolver<DenseMatrix> all(A, Eigen::EigenvaluesOnly);
  return {all.eigenvalues(), {}, all.info() == Eigen::Success};
}

DenseEigen dense_eigenpairs(const DenseMatrix& A, const DenseMatrix& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<DenseMatrix> all(A, B);
  return {all.eigenvalues(), all.eigenvectors(), all.info() == Eigen::Success};
}

DenseSingular singular_values(const DenseMatrix& A) {
  const Eigen::JacobiSVD<DenseMatrix> svd(A, Eigen::ComputeThinU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

DenseSingular singular_values_pivoted(const DenseMatrix& A) {
  const Eigen::JacobiSVD<DenseMatrix, Eigen::FullPivHouseholderQRPreconditioner> svd(A, Eigen::ComputeFullV);
  return {svd.singularValues(), {}, svd.matrixV()};
}

DenseMatrix orthonormal(const DenseMatrix& X) {
  return Eigen::HouseholderQR<DenseMatrix>(X).householderQ() * DenseMatrix::Identity(X.rows(), X.cols());
}

DenseMatrix upper_factor(const DenseMatrix& A) {
  return A.householderQr().matrixQR().topRows(A.cols()).triangularView<Eigen::Upper>();
}

Vector solve_dense(const DenseMatrix& A, const Vector& b) {
  return A.fullPivLu().solve(b);
}

Vector solve_shortest(const DenseMatrix& A, const Vector& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

}  // namespace vbond
