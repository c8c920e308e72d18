#pragma once
#include <optional>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/unknowns.hpp"

namespace vbond {

/// A root S = D C of the mass matrix, M = S S^T. D has the square root of the mass that goes with each
/// unknown: mass, or inertia / length^2 of a turn. C is 1 but for the turns of particles whose moments of
/// inertia differ: the lower triangle of Cholesky's factor of their inertia, in world axes and as the
/// particle stands, over the least moment, which D has.
class MassRoot {
 public:
  MassRoot(const Model& model, const State& state, const Unknowns& unknowns);

  /// S^-1 K S^-T, whose eigenvalues are the squares of angular frequencies.  [1/time^2]
  SparseMatrix scaled(const SparseMatrix& K) const;
  /// The same of an antisymmetric K: the imaginary part of a Hermitian one.
  SparseMatrix scaled_skew(const SparseMatrix& K) const;
  /// The motion S^-T y of an eigenvector y of that.
  Vector motion(const Vector& y) const;
  /// S y and S^T x.
  DenseMatrix times(const DenseMatrix& y) const;
  DenseMatrix transpose_times(const DenseMatrix& x) const;
  /// D, and C^T x: S^T = C^T D.
  const Vector& diagonal() const { return diagonal_; }
  SparseMatrix times_factor(const SparseMatrix& x) const;

 private:
  SparseMatrix scaled_to_rounding(const SparseMatrix& K) const;  // not symmetric to the last bit
  struct OfTops {
    SparseMatrix factor, inverse;  // C, C^-1
  };
  Vector diagonal_;
  std::optional<OfTops> tops_;  // empty: C is 1
};

}  // namespace vbond
