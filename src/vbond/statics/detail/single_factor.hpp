#pragma once
#include <cstddef>
#include <vector>

#include "vbond/core/large_array.hpp"
#include "vbond/statics/detail/blocked_factor.hpp"
#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// A triangular factor L in single precision, which takes half of the memory, so that a solution, which waits
/// for memory, takes half of the time. Sums are in double precision: what it solves with is the symmetric
/// positive definite matrix P^T L L^T P of the rounded entries, as exactly as in double precision. Entry i, j
/// of that matrix differs by no more than difference() times the root of its diagonal entries i and j.
class SingleFactor {
 public:
  /// Takes these blocks, block s from values + at[s] on, column by column, each of the height of the block.
  void take(const FactorBlocks& blocks, const std::vector<std::size_t>& at, const double* values);
  /// x with P^T L L^T P x = b, for each column; up to four take little longer than one. The same to the bit
  /// with each instruction set, and for each column as for that alone.
  DenseMatrix solve(const DenseMatrix& B) const;
  static constexpr double difference() { return 0x1.01p-23; }

 private:
  struct Strip {
    int block, column, width;  // columns of a block, the first counted in the block
    std::size_t at;            // in L_
  };
  void solve_some(int columns, double* x, double* local) const;

  FactorBlocks blocks_;
  std::vector<Strip> strips_;
  LargeArray<float> L_;
  int stride_ = 0;  // of a column in what a block needs at a time
};

}  // namespace vbond
