#pragma once
#include <memory>

#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// Sparse triangular factors of a square matrix without symmetry, by UMFPACK: rows are exchanged, so that
/// they are accurate whatever the signs of the eigenvalues.
class UnsymmetricFactor {
 public:
  UnsymmetricFactor();
  ~UnsymmetricFactor();
  UnsymmetricFactor(UnsymmetricFactor&&) noexcept;
  UnsymmetricFactor& operator=(UnsymmetricFactor&&) noexcept;

  /// Factors A, of which it keeps a copy. The order of elimination is chosen anew where the pattern is
  /// another one. False if A is singular to rounding or not finite; then solve() must not be called. Throws
  /// std::bad_alloc.
  bool factor(const SparseMatrix& A);
  /// Of the determinant of the last matrix: -1 or 1; 0 if it is singular.
  int sign() const;
  /// How many times a factor was made, or tried.
  int made() const;
  /// x with A x = b, refined with A.
  Vector solve(const Vector& b) const;

 private:
  struct Umfpack;
  std::unique_ptr<Umfpack> u_;
};

}  // namespace vbond
