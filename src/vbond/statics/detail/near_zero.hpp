#pragma once
#include <functional>
#include <optional>

#include "vbond/statics/detail/eigen.hpp"

namespace vbond {

/// Eigenpairs of a symmetric matrix that are next to zero, in increasing order and without a gap: values[k]
/// is number first + k of all, counted from 0.
struct NearZero {
  int first = 0;
  Vector values;
  DenseMatrix vectors;  ///< one column each, of length 1

  bool has(int number) const { return number >= first && number < first + values.size(); }
  double value(int number) const { return values[number - first]; }
  /// Vectors of the values of no more than this size.
  DenseMatrix vectors_within(double size) const;
};

/// B -> A^-1 B, column by column, or the same of a matrix next to A.
using SolveColumns = std::function<DenseMatrix(const DenseMatrix&)>;

/// Inverse iteration on a block of vectors, for one matrix after another that is not far from the one before:
/// it begins with the vectors found last. One vector alone, as Lanczos iteration has it, finds of values that
/// are equal one after another, and of the crowds of a shell each slowly.
class NearZeroSearch {
 public:
  /// The `count` pairs of A nearest to zero, in increasing order. A value v is known to 1e-3 |v|, or as much
  /// less as it is smaller than `scale`; nothing below `resolution` is told apart. Nothing if many iterations
  /// do not reach that.
  std::optional<EigenPairs> find(const SparseMatrix& A, const SolveColumns& solve, int count, double scale,
                                 double resolution);

 private:
  DenseMatrix X_;  // the vectors found last and some more, orthonormal
};

}  // namespace vbond
