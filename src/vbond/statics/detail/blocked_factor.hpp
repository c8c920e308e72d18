#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "vbond/core/large_array.hpp"
#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// The dense blocks of a sparse triangular factor. Block s has the columns first[s] to first[s+1] - 1, all of
/// them with entries in the rows rows[from[s]] to rows[from[s+1] - 1], the block's own columns first.
struct FactorBlocks {
  std::vector<int> first, from, rows;
  std::vector<int> order;  ///< order[k]: which unknown is eliminated as number k
  int columns() const { return static_cast<int>(order.size()); }
  int number() const { return static_cast<int>(first.size()) - 1; }
  struct Size {
    int first, width, height;
  };
  Size block(int s) const {
    const auto k = static_cast<std::size_t>(s);
    return {first[k], first[k + 1] - first[k], from[k + 1] - from[k]};
  }
};

/// P (A + shift I) P^T = L D L^T in dense blocks, D diagonal with entries of either sign, without pivoting:
/// what CHOLMOD does for positive definite matrices only. Block by block from the left, by BLAS.
class BlockedFactor {
 public:
  explicit BlockedFactor(FactorBlocks blocks);

  /// False if an entry of D is exactly zero or not finite: zero_pivot() is its number in the order of
  /// elimination. Of A the lower triangle is read.
  bool factorize(const SparseMatrix& A, double shift);
  int zero_pivot() const { return zero_pivot_; }

  int columns() const { return blocks_.columns(); }
  double d(int column) const { return D_[static_cast<std::size_t>(column)]; }
  /// Calls f(row, value) for what is below the diagonal of L.
  template <class F>
  void below(int column, F&& f) const;

  /// x with (A + shift I) x = b, for each column.
  DenseMatrix solve(const DenseMatrix& b) const;

 private:
  struct Block {
    int first, width, height;
    const int* rows;
    std::size_t at;  // of the first entry in L_
  };
  Block block(int s) const;
  void take(const SparseMatrix& permuted, double shift, const Block& b);
  void subtract(const Block& from, int first_row, int last_row, const Block& to);
  bool eliminate(const Block& b);
  bool eliminate_corner(double* corner, int width, int height, int first_column);

  FactorBlocks blocks_;
  std::vector<std::size_t> at_;
  std::vector<int> block_of_, rank_;  // of a column; of an unknown in the order of elimination
  LargeArray<double> L_;
  std::vector<double> D_;
  std::vector<int> place_;                // scratch: of a row within the present block
  std::vector<double> scaled_, product_;  // scratch
  int zero_pivot_ = -1;
};

template <class F>
void BlockedFactor::below(int column, F&& f) const {
  const Block b = block(block_of_[static_cast<std::size_t>(column)]);
  const int k = column - b.first;
  const double* values = L_.data() + b.at + static_cast<std::size_t>(k) * static_cast<std::size_t>(b.height);
  for (int i = k + 1; i < b.height; ++i) f(b.rows[i], values[i]);
}

}  // namespace vbond
