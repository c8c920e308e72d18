// Eigenvalues of the tangent stiffness along a path.
#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/statics/detail/arc_length.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/eigen_search.hpp"
#include "vbond/statics/detail/rounding.hpp"

namespace vbond {

namespace {

// The rate of an eigenvalue is a difference over a step that changes bonds by this: truncation is its square.
constexpr double small_bond_change = 1e-3;

}  // namespace

/// Roughly the eigenpair nearest to zero.
std::pair<double, Vector> ArcLength::soft_mode() {
  constexpr int iterations = 4;
  const SparseMatrix& K = body_.tangent();
  if (solver_.by_multigrid()) {
    const EigenPairs near = solver_.near_zero(body_, 1);
    return {near.values[0], near.vectors.col(0)};
  }
  DenseMatrix X = any_orthonormal_columns(K.rows(), std::min<Eigen::Index>(K.rows(), 3));
  for (int k = 0; k < iterations; ++k) X = orthonormal(solve_beside(X));
  const DenseEigen ritz = dense_eigenpairs(X.transpose() * (K * X));
  Eigen::Index nearest = 0;
  ritz.values.cwiseAbs().minCoeff(&nearest);
  return {ritz.values[nearest], X * ritz.vectors.col(nearest)};
}

std::optional<double> ArcLength::eigenvalue(int number) {
  if (!solver_.by_multigrid()) return {};
  const Lowest& lowest = solver_.multigrid_at(body_).lowest(std::min(number + 1, body_.unknowns().size()));
  return lowest.values[std::min(number, lowest.size() - 1)];
}

/// By factors, the `count` nearest to zero in increasing order.
EigenPairs ArcLength::pairs_near_zero(int count, double scale) {
  const SparseMatrix& A = body_.tangent();
  if (!solve_densely(A.rows(), count)) {
    if (factored_at_ != body_.placement_number()) factor({Vector::Zero(A.rows()), 0.0});
    const auto found = near_zero_.find(
        A, [this](const DenseMatrix& B) { return solve_beside(B); }, count, scale, 0.1 * eigenvalue_error(A));
    if (found) return *found;
  }
  EigenPairs near = solver_.near_zero(body_, count);
  other_factors_ += near.factors;
  Found sorted;
  for (Eigen::Index k = 0; k < near.values.size(); ++k)
    sorted.add(near.values[k], near.values[k], near.vectors.col(k));
  sorted.sort();
  return sorted.part(0, sorted.size());
}

/// How many eigenvalues lie below a bound, or one close by. A factor without pivoting may meet a zero pivot
/// at any bound near zero: then the eigenvalues near zero are taken out one by one.
int ArcLength::number_below(double bound) {
  const SparseMatrix& A = body_.tangent();
  Factor factor = analysed(A, &solver_.last_factor());
  for (int k = 0; k < 8; ++k) {
    const std::optional<int> number = factor.factor_indefinite(A, -std::pow(1.5, k) * bound);
    ++other_factors_;
    if (number) return *number;
  }
  const Deflated near(A, &solver_.last_factor());
  other_factors_ += near.factors();
  return near.negative() + static_cast<int>((near.null_values().array() < bound).count());
}

NearZero ArcLength::near_zero(int number, int unstable, double scale) {
  constexpr int first_count = 4;
  const SparseMatrix& A = body_.tangent();
  const int size = static_cast<int>(A.rows());
  for (int count = std::min(first_count, size);; count = std::min(2 * count, size)) {
    EigenPairs found = pairs_near_zero(count, scale);
    const Vector& near = found.values;
    const double beside = -Deflated::zero(A);  // far enough from zero for a factor to tell
    const bool sure = near.cwiseAbs().minCoeff() > -beside;
    const auto below = static_cast<int>((near.array() < (sure ? 0.0 : beside)).count());
    NearZero zero{(sure ? unstable : number_below(beside)) - below, std::move(found.values),
                  std::move(found.vectors)};
    if (count == size && !zero.has(number))  // there are no more
      zero.first = number < zero.first ? number : number + 1 - size;
    if (zero.has(number)) return zero;
  }
}

Softest ArcLength::softest(const PathDirection& tangent) {
  if (solver_.factors_full(body_)) return {};  // its eigenvalues do not tell what is stable
  const auto [value, mode] = soft_mode();
  const double change = body_.largest_bond_change(tangent.u, tangent.f);
  if (!(change > 0.0)) return {value, 0.0};
  const double h = small_bond_change / change;
  const Placement here = body_.placement();
  const auto beside = [&, &of_mode = mode](double s) {
    body_.restore(here);
    body_.move(s * tangent.u, here.load_factor + s * tangent.f);
    return of_mode.dot(body_.tangent() * of_mode);
  };
  const double rate = (beside(h) - beside(-h)) / (2.0 * h);
  body_.restore(here);
  return {value, rate};
}

}  // namespace vbond
