#pragma once
#include <cstddef>
#include <memory>
#include <optional>

#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/single_factor.hpp"

namespace vbond {

/// Sparse triangular factors of a symmetric matrix, by CHOLMOD with BLAS on one thread, so that results do
/// not depend on the number of threads. Of the matrix the lower triangle is read.
class Factor {
 public:
  Factor();
  ~Factor();
  Factor(Factor&&) noexcept;
  Factor& operator=(Factor&&) noexcept;

  /// Chooses the order of elimination; to be called once per pattern. Throws std::bad_alloc.
  void analyse(const SparseMatrix& A);
  /// The same with what another one has found for this pattern, at no cost.
  void analyse_as(const Factor& other);
  /// Bytes that the factor of the last pattern analysed will take; infinite if it would have more entries
  /// than CHOLMOD's indices can count (2^31), and then it cannot be made.
  double bytes() const;

  /// Factors A + shift I = L L^T (supernodal where that is faster). False if that is not positive definite,
  /// or so little that rounding hides it; then solve() must not be called.
  bool factor_definite(const SparseMatrix& A, double shift = 0.0);
  /// Factors A + shift I = L D L^T (in dense blocks where factor_definite() does; no pivoting) and returns
  /// the number of negative entries of D, which is the number of negative eigenvalues (Sylvester's law of
  /// inertia); nothing if an entry of D is zero to rounding, in which case singular_unknown() says which and
  /// solve() must not be called. Keeps a copy of A.
  std::optional<int> factor_indefinite(const SparseMatrix& A, double shift = 0.0);
  int singular_unknown() const;
  /// What a definite factor of the pattern costs, in solutions with it: by counts of operations, of which
  /// those of a factor go some 18 times as fast (blocks of BLAS; a solution waits for memory).
  double cost_in_solutions() const;
  /// Operations that a definite factor of the pattern takes.
  double operations() const;
  /// How many times a factor was made, or tried.
  int made() const;

  /// x with (A + shift I) x = b, one step of refinement included for the indefinite form.
  Vector solve(const Vector& b) const;
  /// Of a definite factor, (A + shift I) = L L^T but for the order of unknowns: y with L y = b, and x with
  /// L^T x = y. The one after the other is solve().
  Vector half_solve(const Vector& b) const;
  Vector other_half_solve(const Vector& y) const;
  /// The same for each column, without refinement; several at a time cost little more than one.
  DenseMatrix solve_columns(const DenseMatrix& B) const;
  /// Of a definite factor: copies it into one of single precision. False if it is so small that it is not in
  /// dense blocks.
  bool copy_to(SingleFactor& single) const;

 private:
  struct Cholmod;
  std::unique_ptr<Cholmod> c_;
};

/// Ready to factor A: with the analysis of another one of the same pattern, where there is one.
Factor analysed(const SparseMatrix& A, const Factor* of_same_pattern = nullptr);

}  // namespace vbond
