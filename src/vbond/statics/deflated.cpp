#include "vbond/statics/detail/deflated.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/dense.hpp"

namespace vbond {

DenseMatrix any_orthonormal_columns(Eigen::Index rows, Eigen::Index columns) {
  DenseMatrix X(rows, columns);
  for (Eigen::Index k = 0; k < X.size(); ++k)
    X.data()[k] = std::sin(static_cast<double>(k + 1) * static_cast<double>(k + 1));
  return orthonormal(X);
}

namespace {

double scale_of(const SparseMatrix& A) {
  return larger(1e-300, max_norm(A.diagonal()));
}

}  // namespace

double Deflated::zero(const SparseMatrix& A) {
  return 1e3 * epsilon * scale_of(A);
}

Deflated::Deflated(DenseMatrix null_vectors, Vector null_values, int negative,
                   std::function<Vector(const Vector&)> solve)
    : solve_(std::move(solve)),
      null_(std::move(null_vectors)),
      values_(std::move(null_values)),
      negative_(negative) {}

Deflated::Deflated(const SparseMatrix& A, const Factor* of_same_pattern)
    : A_(&A), factor_(analysed(A, of_same_pattern)) {
  const double scale = scale_of(A);
  std::optional<int> below;
  double shift = epsilon * scale;
  while (!(below = factor_.factor_indefinite(A, shift))) {
    shift *= 8.0;
    if (!(shift < 1e-6 * scale)) throw NoConvergence("the tangent stiffness cannot be factored");
  }
  find_null_vectors(std::max(zero(A), 2.0 * shift));
  negative_ = *below - static_cast<int>((values_.array() < -shift).count());
}

/// Inverse iteration on a block: with the shift this close, null vectors stand out by many orders.
void Deflated::find_null_vectors(double bound) {
  const Eigen::Index n = A_->rows();
  for (Eigen::Index size = std::min<Eigen::Index>(n, 4);; size = std::min(n, 2 * size)) {
    DenseMatrix X = any_orthonormal_columns(n, size);
    for (int iteration = 0; iteration < 4; ++iteration) {
      for (Eigen::Index k = 0; k < size; ++k) X.col(k) = factor_.solve(X.col(k));
      X = orthonormal(X);
    }
    const DenseEigen ritz = dense_eigenpairs(X.transpose() * (*A_ * X));
    const Vector& values = ritz.values;
    const Eigen::Index first = (values.array() < -bound).count();
    const Eigen::Index number = (values.array() <= bound).count() - first;
    null_ = X * ritz.vectors.middleCols(first, number);
    values_ = values.segment(first, number);
    if (number < size || size == n) return;
  }
}

// The factor is that of a matrix off by the shift: each iteration leaves the shift over the next eigenvalue.
Vector Deflated::solve(const Vector& b) const {
  if (solve_) return solve_(b);
  constexpr int most_iterations = 30;
  Vector x = Vector::Zero(b.size()), left = normal(b);
  double size = left.norm();
  const double enough = 1e-14 * size;
  for (int k = 0; k < most_iterations && size > enough; ++k) {
    const Vector next = x + normal(factor_.solve(left));
    Vector next_left = normal(b - *A_ * next);
    if (!(next_left.norm() < size)) break;
    x = next;
    left = std::move(next_left);
    size = left.norm();
  }
  return x;
}

}  // namespace vbond
