#include <Spectra/SymGEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>

#include "vbond/statics/detail/eigen_search.hpp"

namespace vbond {
namespace {

/// How far beyond the critical factor of smallest size others are looked for.
constexpr double factor_range = 1e4;

/// x -> -scale (B + A X Theta X^T A) x: pairs (theta, X) of -B x = theta A x that are known get theta = 0.
struct LoadOperator {
  using Scalar = double;
  Eigen::Index rows() const { return B.rows(); }
  Eigen::Index cols() const { return B.rows(); }
  void perform_op(const double* in, double* out) const {
    const Eigen::Map<const Vector> x(in, B.rows());
    Vector y = B * x;
    if (AX.cols() > 0) y += AX * theta.cwiseProduct(AX.transpose() * x);
    Eigen::Map<Vector>(out, B.rows()) = -scale * y;
  }
  const SparseMatrix& B;
  double scale;
  DenseMatrix AX;
  Vector theta;
};

struct StiffnessOperator {
  using Scalar = double;
  Eigen::Index rows() const { return A.rows(); }
  Eigen::Index cols() const { return A.rows(); }
  void solve(const double* in, double* out) const {
    Eigen::Map<Vector>(out, A.rows()) = factor.solve(Eigen::Map<const Vector>(in, A.rows()));
  }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Vector>(out, A.rows()) = A * Eigen::Map<const Vector>(in, A.rows());
  }
  const SparseMatrix& A;
  const Factor& factor;
};

/// Largest theta, or largest in size, of -B x = theta A x, as pairs (mu = 1 / theta, x).
void look_for_factors(StiffnessOperator& stiffness, const SparseMatrix& B, double scale,
                      Spectra::SortRule rule, int count, Found& found) {
  const SparseMatrix& A = stiffness.A;
  LoadOperator load{B, scale, {}, Vector(found.size())};
  if (found.size() > 0) load.AX = A * found.vectors;
  for (int k = 0; k < found.size(); ++k) load.theta[k] = 1.0 / found.value[static_cast<std::size_t>(k)];
  Spectra::SymGEigsSolver<LoadOperator, StiffnessOperator, Spectra::GEigsMode::RegularInverse> solver(
      load, stiffness, count, basis_size(count, A.rows()));
  iterate(solver, rule, count, A.rows());
  const Vector theta = solver.eigenvalues();
  const DenseMatrix x = solver.eigenvectors();
  for (Eigen::Index k = 0; k < theta.size(); ++k) {
    const Vector v = x.col(k);
    const double mu = scale / theta[k];
    found.add(mu, mu, v / std::sqrt(v.dot(A * v)));
  }
}

EigenPairs dense_factors(const SparseMatrix& A, const SparseMatrix& B, int count) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<DenseMatrix> all(-DenseMatrix(B), DenseMatrix(A));
  const Vector theta = all.eigenvalues();
  const double smallest = theta.cwiseAbs().maxCoeff() / factor_range;
  Found found;
  for (Eigen::Index k = theta.size() - 1; k >= 0 && theta[k] > smallest; --k)
    found.add(1.0 / theta[k], 1.0 / theta[k], all.eigenvectors().col(k));
  return found.part(0, count);
}

}  // namespace

EigenPairs critical_factors(const SparseMatrix& A, const SparseMatrix& B, int count) {
  const Eigen::Index n = A.rows();
  const double largest_B = B.nonZeros() > 0 ? B.coeffs().cwiseAbs().maxCoeff() : 0.0;
  if (n == 0 || count <= 0) return {Vector(0), DenseMatrix(n, 0)};
  Factor factor;
  factor.analyse(A);
  if (!factor.factor_definite(A))
    throw NoConvergence("critical factors: the matrix is not positive definite to rounding");
  if (!(largest_B > 0.0)) return {Vector(0), DenseMatrix(n, 0)};
  if (solve_densely(n, count)) return dense_factors(A, B, count);
  StiffnessOperator stiffness{A, factor};
  // Some |theta| is at least max |B_ij| over the largest eigenvalue of A: scaled it is not far below 1.
  const double scale = largest_diagonal(A) / largest_B;
  Found nearest;
  look_for_factors(stiffness, B, scale, Spectra::SortRule::LargestMagn, 1, nearest);
  const auto look = [&](int k, Found& found) {
    look_for_factors(stiffness, B, scale, Spectra::SortRule::LargestAlge, k, found);
  };
  const double largest = factor_range * std::abs(nearest.value[0]);
  Factor counter;
  counter.analyse(A + B);
  const auto number_below = [&](double mu) { return counter.factor_indefinite(A + mu * B); };
  const std::optional<int> available = number_below(largest);
  if (!available) throw NoConvergence("critical factors: they cannot be counted");
  return find_counted(Wanted{count, *available, 0.0, 0.0}, look, number_below);
}

}  // namespace vbond
