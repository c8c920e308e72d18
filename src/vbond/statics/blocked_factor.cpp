#include "vbond/statics/detail/blocked_factor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

// BLAS, as Fortran names it.
extern "C" {
void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
            const int*, const double*, const int*, const double*, double*, const int*);
void dgemv_(const char*, const int*, const int*, const double*, const double*, const int*, const double*,
            const int*, const double*, double*, const int*);
void dtrsm_(const char*, const char*, const char*, const char*, const int*, const int*, const double*,
            const double*, const int*, double*, const int*);
void dtrsv_(const char*, const char*, const char*, const int*, const double*, const int*, double*,
            const int*);
}

namespace vbond {
namespace {

/// Columns that are eliminated one by one before BLAS takes what they leave to the others.
constexpr int strip = 32;

/// C = beta C + alpha A B^T; leading dimensions follow each matrix.
void multiply(int m, int n, int k, double alpha, const double* A, int lda, const double* B, int ldb,
              double beta, double* C, int ldc) {
  if (m == 0 || n == 0 || k == 0) return;
  dgemm_("N", "T", &m, &n, &k, &alpha, A, &lda, B, &ldb, &beta, C, &ldc);
}

/// Y = beta Y + alpha op(A) X, op(A) = A of m x k, or the transposed of A of k x m.
void apply(bool transposed, int m, int n, int k, double alpha, const double* A, int lda, const double* X,
           int ldx, double beta, double* Y, int ldy) {
  if (m == 0 || k == 0) return;
  const char* op = transposed ? "T" : "N";
  const int one = 1;
  if (n == 1)
    dgemv_(op, transposed ? &k : &m, transposed ? &m : &k, &alpha, A, &lda, X, &one, &beta, Y, &one);
  else
    dgemm_(op, "N", &m, &n, &k, &alpha, A, &lda, X, &ldx, &beta, Y, &ldy);
}

/// X = op(L)^-1 X, L with ones on its diagonal.
void solve_corner(bool transposed, int m, int n, const double* L, int ldl, double* X, int ldx) {
  const char* op = transposed ? "T" : "N";
  const int step = 1;
  const double one = 1.0;
  if (n == 1)
    dtrsv_("L", op, "U", &m, L, &ldl, X, &step);
  else
    dtrsm_("L", "L", op, "U", &m, &n, &one, L, &ldl, X, &ldx);
}

std::size_t entries(int height, int width) {
  return static_cast<std::size_t>(height) * static_cast<std::size_t>(width);
}

}  // namespace

BlockedFactor::BlockedFactor(FactorBlocks blocks) : blocks_(std::move(blocks)) {
  const auto n = static_cast<std::size_t>(blocks_.columns());
  block_of_.resize(n);
  rank_.resize(n);
  D_.resize(n);
  place_.resize(n);
  for (std::size_t k = 0; k < n; ++k) rank_[static_cast<std::size_t>(blocks_.order[k])] = static_cast<int>(k);
  at_.assign(1, 0);
  for (std::size_t s = 0; s + 1 < blocks_.first.size(); ++s) {
    const int width = blocks_.first[s + 1] - blocks_.first[s];
    std::fill_n(block_of_.begin() + blocks_.first[s], width, static_cast<int>(s));
    at_.push_back(at_.back() + entries(blocks_.from[s + 1] - blocks_.from[s], width));
  }
  L_.resize(at_.back());
}

BlockedFactor::Block BlockedFactor::block(int s) const {
  const auto k = static_cast<std::size_t>(s);
  const auto [first, width, height] = blocks_.block(s);
  return {first, width, height, blocks_.rows.data() + blocks_.from[k], at_[k]};
}

// A block takes what each earlier block with rows among its columns leaves to it. Those blocks wait in a list
// of the block they are needed by next; `done` is their first row that is.
bool BlockedFactor::factorize(const SparseMatrix& A, double shift) {
  const Eigen::Map<const Eigen::VectorXi> rank(rank_.data(), static_cast<Eigen::Index>(rank_.size()));
  SparseMatrix permuted(A.rows(), A.cols());
  permuted.selfadjointView<Eigen::Lower>() =
      A.selfadjointView<Eigen::Lower>().twistedBy(Eigen::PermutationMatrix<Eigen::Dynamic>(rank));
  std::fill(L_.begin(), L_.end(), 0.0);
  const int number = blocks_.number();
  std::vector<int> waiting(static_cast<std::size_t>(number), -1), next = waiting, done = waiting;
  const auto wait = [&](int s, const Block& b, int row) {
    if (row == b.height) return;
    done[static_cast<std::size_t>(s)] = row;
    int& list = waiting[static_cast<std::size_t>(block_of_[static_cast<std::size_t>(b.rows[row])])];
    next[static_cast<std::size_t>(s)] = std::exchange(list, s);
  };
  for (int s = 0; s < number; ++s) {
    const Block b = block(s);
    for (int i = 0; i < b.height; ++i) place_[static_cast<std::size_t>(b.rows[i])] = i;
    take(permuted, shift, b);
    for (int earlier = waiting[static_cast<std::size_t>(s)]; earlier >= 0;) {
      const int after = next[static_cast<std::size_t>(earlier)];
      const Block from = block(earlier);
      const int row = done[static_cast<std::size_t>(earlier)];
      int end = row;
      while (end < from.height && from.rows[end] < b.first + b.width) ++end;
      subtract(from, row, end, b);
      wait(earlier, from, end);
      earlier = after;
    }
    if (!eliminate(b)) return false;
    wait(s, b, b.width);
  }
  return true;
}

void BlockedFactor::take(const SparseMatrix& permuted, double shift, const Block& b) {
  double* column = L_.data() + b.at;
  for (int k = 0; k < b.width; ++k, column += b.height) {
    for (SparseMatrix::InnerIterator it(permuted, b.first + k); it; ++it)
      column[place_[static_cast<std::size_t>(it.row())]] += it.value();
    column[k] += shift;
  }
}

/// L D L^T of an earlier block, for its rows from first_row on and the columns that belong to its rows before
/// last_row.
void BlockedFactor::subtract(const Block& from, int first_row, int last_row, const Block& to) {
  const int width = last_row - first_row, height = from.height - first_row;
  const double* L = L_.data() + from.at + first_row;
  scaled_.resize(std::max(scaled_.size(), entries(width, from.width)));
  product_.resize(std::max(product_.size(), entries(height, width)));
  double* scaled = scaled_.data();
  for (int k = 0; k < from.width; ++k)
    for (int i = 0; i < width; ++i)
      *scaled++ = L[entries(from.height, k) + static_cast<std::size_t>(i)] * d(from.first + k);
  multiply(height, width, from.width, 1.0, L, from.height, scaled_.data(), width, 0.0, product_.data(),
           height);
  const int* rows = from.rows + first_row;
  for (int k = 0; k < width; ++k) {
    double* column = L_.data() + to.at + entries(to.height, rows[k] - to.first);
    const double* product = product_.data() + entries(height, k);
    for (int i = k; i < height; ++i) column[place_[static_cast<std::size_t>(rows[i])]] -= product[i];
  }
}

bool BlockedFactor::eliminate(const Block& b) {
  const int height = b.height;
  for (int k = 0; k < b.width; k += strip) {
    const int width = std::min(strip, b.width - k), left = height - k - width;
    double* corner = L_.data() + b.at + entries(height, k) + static_cast<std::size_t>(k);
    if (!eliminate_corner(corner, width, height, b.first + k)) return false;
    if (left == 0) return true;
    double* under = corner + width;
    const double one = 1.0;
    dtrsm_("R", "L", "T", "U", &left, &width, &one, corner, &height, under, &height);  // L D
    scaled_.resize(std::max(scaled_.size(), entries(left, width)));
    for (int c = 0; c < width; ++c) {
      double* column = under + entries(height, c);
      std::copy_n(column, left, scaled_.data() + entries(left, c));
      for (int i = 0; i < left; ++i) column[i] /= d(b.first + k + c);
    }
    for (int c = 0; k + width + c < b.width; c += strip)
      multiply(left - c, std::min(strip, b.width - k - width - c), width, -1.0, under + c, height,
               scaled_.data() + c, left, 1.0, under + entries(height, width + c) + c, height);
  }
  return true;
}

/// A square at the diagonal.
bool BlockedFactor::eliminate_corner(double* corner, int width, int height, int first_column) {
  for (int k = 0; k < width; ++k) {
    double* pivots = corner + entries(height, k);
    const double pivot = pivots[k];
    D_[static_cast<std::size_t>(first_column + k)] = pivot;
    if (!std::isfinite(pivot) || pivot == 0.0) {
      zero_pivot_ = first_column + k;
      return false;
    }
    for (int c = k + 1; c < width; ++c) {
      const double share = pivots[c] / pivot;
      double* column = corner + entries(height, c);
      for (int i = c; i < width; ++i) column[i] -= share * pivots[i];
    }
    for (int i = k + 1; i < width; ++i) pivots[i] /= pivot;
  }
  return true;
}

DenseMatrix BlockedFactor::solve(const DenseMatrix& b) const {
  const int n = static_cast<int>(b.rows()), columns = static_cast<int>(b.cols());
  DenseMatrix x(n, columns), under(n, columns);
  for (int k = 0; k < n; ++k) x.row(k) = b.row(blocks_.order[static_cast<std::size_t>(k)]);
  for (int s = 0; s < blocks_.number(); ++s) {
    const Block k = block(s);
    const double* L = L_.data() + k.at;
    const int below = k.height - k.width;
    solve_corner(false, k.width, columns, L, k.height, &x(k.first, 0), n);
    apply(false, below, columns, k.width, 1.0, L + k.width, k.height, &x(k.first, 0), n, 0.0, under.data(),
          n);
    for (int c = 0; c < columns; ++c)
      for (int i = 0; i < below; ++i) x(k.rows[k.width + i], c) -= under(i, c);
  }
  for (int k = 0; k < n; ++k) x.row(k) /= d(k);
  for (int s = blocks_.number(); s-- > 0;) {
    const Block k = block(s);
    const double* L = L_.data() + k.at;
    const int below = k.height - k.width;
    for (int c = 0; c < columns; ++c)
      for (int i = 0; i < below; ++i) under(i, c) = x(k.rows[k.width + i], c);
    apply(true, k.width, columns, below, -1.0, L + k.width, k.height, under.data(), n, 1.0, &x(k.first, 0),
          n);
    solve_corner(true, k.width, columns, L, k.height, &x(k.first, 0), n);
  }
  DenseMatrix result(n, columns);
  for (int k = 0; k < n; ++k) result.row(blocks_.order[static_cast<std::size_t>(k)]) = x.row(k);
  return result;
}

}  // namespace vbond
