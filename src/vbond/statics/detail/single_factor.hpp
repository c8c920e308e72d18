#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "vbond/core/crew.hpp"
#include "vbond/core/large_array.hpp"
#include "vbond/statics/detail/blocked_factor.hpp"
#include "vbond/statics/detail/factor_branches.hpp"
#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// A triangular factor L in single precision, which takes half of the memory, so that a solution, which waits
/// for memory, takes half of the time. Sums are in double precision: what it solves with is the symmetric
/// positive definite matrix P^T L L^T P of the rounded entries, as exactly as in double precision. Entry i, j
/// of that matrix differs by no more than difference() times the root of its diagonal entries i and j.
///
/// Branches of the tree of elimination need nothing of each other: several threads solve them side by side.
/// Which columns are a branch depends on the factor alone, and what branches leave to the columns after them
/// is added in their order, so the result does not depend on the number of threads. Only one thread may call
/// solve() at a time.
class SingleFactor {
 public:
  explicit SingleFactor(std::shared_ptr<Crew> crew = std::make_shared<Crew>(1));
  /// Takes these blocks, block s from values + at[s] on, column by column, each of the height of the block.
  void take(const FactorBlocks& blocks, const std::vector<std::size_t>& at, const double* values);
  /// x with P^T L L^T P x = b, for each column; up to four take little longer than one. The same to the bit
  /// with each instruction set, and for each column as for that alone.
  DenseMatrix solve(const DenseMatrix& B) const;
  static constexpr double difference() { return 0x1.01p-23; }
  /// How many branches there are; 0: the factor is small.
  std::size_t branches() const { return parts_.branches.size(); }

 private:
  struct Strip {
    int block, column, width;  // columns of a block, the first counted in the block
    std::size_t at;            // in L_
  };
  void copy_top();
  template <class Work>
  void for_branches(Work work) const;
  void solve_some(int columns, double* x) const;
  void forward(int block, int sides, double* x, double* local) const;
  void backward(int block, int sides, double* x, double* local) const;

  std::shared_ptr<Crew> crew_;
  /// Rows that are columns of the top, which are of no branch, have numbers in the copy of these that each
  /// branch has behind the columns of all.
  FactorBlocks blocks_;
  std::vector<Strip> strips_;
  std::vector<std::size_t> first_strip_;  // of each block
  LargeArray<float> L_;
  std::ptrdiff_t stride_ = 0;         // of a column in what a block needs at a time
  std::vector<std::size_t> by_size_;  // branches, the largest first
  FactorBranches parts_;
  std::vector<int> top_columns_;
  std::ptrdiff_t length_ = 0;                       // of a column, all copies included
  mutable std::vector<std::vector<double>> local_;  // scratch, of each thread
};

}  // namespace vbond
