#include "vbond/statics/detail/near_zero.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "vbond/statics/detail/deflated.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {
namespace {

// Vectors beside those wanted: the farther away from zero the last of them, the fewer iterations.
constexpr int guards = 4;
// The guard by which errors are judged: of those before it one or two may be partners of the last one wanted.
constexpr int judging_guard = 2;
constexpr int fewest_iterations = 3;  // a vector that nothing pointed to has come up by then
constexpr int most_iterations = 60;
constexpr double part = 1e-3;  // to which a value is known

/// Numbers of the values, the largest in size first.
std::vector<Eigen::Index> by_size(const Vector& values) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&values](Eigen::Index a, Eigen::Index b) {
    return std::abs(values[a]) > std::abs(values[b]);
  });
  return order;
}

/// The columns of X, as many as there is room for, and arbitrary ones; always one of those, which shows what
/// the others have nothing of.
DenseMatrix filled_up(const DenseMatrix& X, Eigen::Index rows, Eigen::Index columns) {
  const Eigen::Index kept = X.rows() == rows ? std::min(X.cols(), columns - 1) : 0;
  DenseMatrix both(rows, columns);
  if (kept > 0) both.leftCols(kept) = X.leftCols(kept);  // at first there is nothing
  both.rightCols(columns - kept) = any_orthonormal_columns(rows, columns - kept);
  return orthonormal(both);
}

}  // namespace

DenseMatrix NearZero::vectors_within(double size) const {
  std::vector<Eigen::Index> within;
  for (Eigen::Index k = 0; k < values.size(); ++k)
    if (std::abs(values[k]) <= size) within.push_back(k);
  return vectors(Eigen::all, within);
}

// Ritz values of the inverse, whose largest ones are looked for, choose the vectors: those of A itself may
// lie near zero by chance, where vectors of either sign are mixed. Values are then those of A. With the
// distance of the guard they are off by the square of their residual over it.
std::optional<EigenPairs> NearZeroSearch::find(const SparseMatrix& A, const SolveColumns& solve, int count,
                                               double scale, double resolution) {
  const Eigen::Index n = A.rows(), size = std::min<Eigen::Index>(n, count + guards);
  DenseMatrix X = filled_up(X_, n, size);
  for (int k = 0; k < most_iterations; ++k) {
    Pulse::may_end();
    const DenseMatrix Y = solve(X);
    const DenseMatrix S = X.transpose() * Y;
    const DenseEigen inverse = dense_eigenpairs(0.5 * (S + S.transpose()));
    if (!inverse.found || !inverse.values.allFinite()) return {};
    const std::vector<Eigen::Index> order = by_size(inverse.values);
    X = orthonormal(Y * inverse.vectors(Eigen::all, order));
    if (k + 1 < fewest_iterations) continue;
    const DenseMatrix V = X.leftCols(count), AV = A * V, T = V.transpose() * AV;
    const DenseEigen ritz = dense_eigenpairs(0.5 * (T + T.transpose()));
    if (!ritz.found || !ritz.values.allFinite()) return {};
    const DenseMatrix vectors = V * ritz.vectors;
    const DenseMatrix left = AV * ritz.vectors - vectors * ritz.values.asDiagonal();
    const Eigen::Index judge = std::min<Eigen::Index>(count + judging_guard, size - 1);
    const double reach = 1.0 / std::abs(inverse.values[order[static_cast<std::size_t>(judge)]]);
    bool done = true;
    for (int j = 0; j < count; ++j) {
      const double v = std::abs(ritz.values[j]), r = left.col(j).norm(), distance = reach - v;
      const double error = distance > r ? r * r / distance : r;
      done = done && error <= larger(resolution, part * v * std::min(1.0, scale > 0.0 ? v / scale : 1.0));
    }
    if (!done) continue;
    X_ = X;
    X_.leftCols(count) = vectors;
    return EigenPairs{ritz.values, vectors, 0};
  }
  return {};
}

}  // namespace vbond
