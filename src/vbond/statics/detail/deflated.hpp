#pragma once
#include <functional>

#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// Orthonormal columns in which no eigenvector is missing: to begin an iteration with.
DenseMatrix any_orthonormal_columns(Eigen::Index rows, Eigen::Index columns);

/// A symmetric matrix that cannot be factored as it is, taken apart: the eigenvectors whose eigenvalues are
/// within rounding of zero, and what is left on the space normal to them, where it can be inverted (Chan,
/// SIAM J. Numer. Anal. 21 (1984) 738). At a critical point of a path the tangent is such a matrix. There may
/// be no such eigenvectors: a factor without pivoting also meets a zero by chance.
class Deflated {
 public:
  /// Keeps a reference to A. Throws NoConvergence if no matrix near by can be factored: A is not finite.
  /// of_same_pattern: a factor whose analysis is taken.
  explicit Deflated(const SparseMatrix& A, const Factor* of_same_pattern = nullptr);
  /// Taken apart by others: solve() is theirs, and there is no solve_beside().
  Deflated(DenseMatrix null_vectors, Vector null_values, int negative,
           std::function<Vector(const Vector&)> solve);
  /// Eigenvalues this near to zero are taken for zero.
  static double zero(const SparseMatrix& A);

  /// Orthonormal columns, and their eigenvalues.
  const DenseMatrix& null_vectors() const { return null_; }
  const Vector& null_values() const { return values_; }
  /// Eigenvalues below those.
  int negative() const { return negative_; }
  /// x normal to the null vectors, with A x = b - (the part of b along them).
  Vector solve(const Vector& b) const;
  /// x with (A + a shift just above rounding) x = b.
  Vector solve_beside(const Vector& b) const { return factor_.solve(b); }
  /// The same for each column, without refinement.
  DenseMatrix solve_beside_columns(const DenseMatrix& B) const { return factor_.solve_columns(B); }
  /// Factors that were made.
  int factors() const { return factor_.made(); }

 private:
  Vector normal(const Vector& x) const { return x - null_ * (null_.transpose() * x); }
  void find_null_vectors(double bound);

  const SparseMatrix* A_ = nullptr;
  std::function<Vector(const Vector&)> solve_;
  Factor factor_;  // of A + a shift just above rounding
  DenseMatrix null_;
  Vector values_;
  int negative_ = 0;
};

}  // namespace vbond
