#include <cmath>
#include <functional>
#include <optional>

#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/eigen_search.hpp"
#include "vbond/statics/detail/lanczos.hpp"

namespace vbond {
namespace {

/// How far beyond the critical factor of smallest size others are looked for.
constexpr double factor_range = 1e4;

/// x -> -scale (B + A X Theta X^T A) x: pairs (theta, X) of -B x = theta A x that are known get theta = 0.
struct LoadOperator {
  void operator()(const double* in, double* out) const {
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

/// Products with A and with its inverse.
DefiniteOperator stiffness_operator(const SparseMatrix& A, const Factor& factor) {
  const Eigen::Index n = A.rows();
  return {[&A, n](const double* in, double* out) {
            Eigen::Map<Vector>(out, n) = A * Eigen::Map<const Vector>(in, n);
          },
          [&factor, n](const double* in, double* out) {
            Eigen::Map<Vector>(out, n) = factor.solve(Eigen::Map<const Vector>(in, n));
          }};
}

/// Largest theta, or largest in size, of -B x = theta A x, as pairs (mu = 1 / theta, x).
void look_for_factors(const SparseMatrix& A, const DefiniteOperator& stiffness, const SparseMatrix& B,
                      double scale, Largest which, int count, Found& found) {
  LoadOperator load{B, scale, {}, Vector(found.size())};
  if (found.size() > 0) load.AX = A * found.vectors;
  for (int k = 0; k < found.size(); ++k) load.theta[k] = 1.0 / found.value[static_cast<std::size_t>(k)];
  const auto [theta, x] = lanczos(A.rows(), std::cref(load), stiffness, which, count);
  for (Eigen::Index k = 0; k < theta.size(); ++k) {
    const Vector v = x.col(k);
    const double mu = scale / theta[k];
    found.add(mu, mu, v / std::sqrt(v.dot(A * v)));
  }
}

EigenPairs dense_factors(const SparseMatrix& A, const SparseMatrix& B, int count) {
  const DenseEigen all = dense_eigenpairs(-DenseMatrix(B), DenseMatrix(A));
  const Vector& theta = all.values;
  const double smallest = theta.cwiseAbs().maxCoeff() / factor_range;
  Found found;
  for (Eigen::Index k = theta.size() - 1; k >= 0 && theta[k] > smallest; --k)
    found.add(1.0 / theta[k], 1.0 / theta[k], all.vectors.col(k));
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
  const DefiniteOperator stiffness = stiffness_operator(A, factor);
  // Some |theta| is at least max |B_ij| over the largest eigenvalue of A: scaled it is not far below 1.
  const double scale = largest_diagonal(A) / largest_B;
  Found nearest;
  look_for_factors(A, stiffness, B, scale, Largest::size, 1, nearest);
  const auto look = [&](int k, Found& found) {
    look_for_factors(A, stiffness, B, scale, Largest::value, k, found);
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
