#include "vbond/statics/detail/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/rounding.hpp"

namespace vbond {
namespace {

[[noreturn]] void refuse_tangent(const StaticBody& body) {
  throw NoEquilibrium(body.stage().name, "the tangent stiffness is not finite: " + body.first_not_finite(),
                      "loads and stiffnesses must be far from the largest number");
}

/// The lowest eigenvalue and its mode. The search begins below -10 margin and goes lower until the shifted
/// matrix is positive definite. The value is x^T K x of the mode, free of the rounding of the search.
EigenPairs lowest_pair(const StaticBody& body, Factor& factor, double margin) {
  const SparseMatrix& K = body.tangent();
  const double size = K.norm();
  double below = std::max(10.0 * margin, std::numeric_limits<double>::epsilon() * size);
  while (!factor.factor_definite(K, below)) {
    below *= 10.0;
    if (!(below < 1e3 * size)) refuse_tangent(body);
  }
  EigenPairs lowest = smallest_eigenpairs(K, 1, -below);
  const Vector x = lowest.vectors.col(0);
  lowest.values[0] = x.dot(K * x);
  return lowest;
}

/// How many eigenvalues lie below minus the margin, of which there is one at least.
int count_below(const SparseMatrix& K, Factor& factor, double margin, std::optional<int> negative) {
  return std::max(1, factor.factor_indefinite(K, margin).value_or(negative.value_or(1)));
}

void judge_by_lowest(const StaticBody& body, Factor& factor, std::optional<int> negative, Stability& s) {
  const SparseMatrix& K = body.tangent();
  s.lowest = lowest_pair(body, factor, eigenvalue_error(K));
  const double lowest = s.lowest->values[0], error = eigenvalue_error(K, s.lowest->vectors.col(0));
  s.neutral = std::abs(lowest) <= error;
  if (lowest < -error) s.unstable = count_below(K, factor, error, negative);
}

/// Each eigenvalue of the whole tangent differs from one of the symmetric part by no more than the
/// antisymmetric part. So only those below minus that are surely negative; if others are below zero,
/// stability is not known.
void judge_beside_moments(const StaticBody& body, Factor& factor, std::optional<int> negative, Stability& s) {
  const SparseMatrix& K = body.tangent();
  const double margin = std::max(eigenvalue_error(K), body.moment_part());
  s.lowest = lowest_pair(body, factor, margin);
  if (s.lowest->values[0] < -margin) {
    s.unstable = count_below(K, factor, margin, negative);
    return;
  }
  s.lowest.reset();
  s.neutral = !negative;
  s.unstable.reset();
}

/// By the lowest eigenvalues, each known to its residual.
Stability judge_by_multigrid(const StaticBody& body, TangentSolver& solver) {
  constexpr int most = 32;
  const SparseMatrix& K = body.tangent();
  Stability s;
  if (body.unknowns().size() == 0) return s;
  if (K.norm() == 0.0) {
    s.neutral = true;
    return s;
  }
  const Lowest& found = solver.multigrid_at(body).lowest(1, most);
  const EigenPairs pairs{found.values, found.vectors, 0};
  const double margin = body.has_moment_part() ? body.moment_part() : 0.0;
  // corrections end where they are accurate enough: a turn takes what is out of balance along
  const double left = 4.0 * max_norm(body.unbalanced()) / body.unknowns().length();
  int negative = 0;
  for (Eigen::Index k = 0; k < pairs.values.size(); ++k) {
    const double error = larger(eigenvalue_error(K, pairs.vectors.col(k)), larger(found.errors[k], left));
    if (k == 0) s.definite = pairs.values[0] > error;
    if (k == 0) s.neutral = std::abs(pairs.values[0]) <= error;
    negative += pairs.values[k] < -larger(error, margin);
  }
  s.unstable = negative;
  if (margin > 0.0 && negative == 0 && !s.definite) s.unstable.reset();
  s.lowest = pairs;
  return s;
}

}  // namespace

Stability judge_stability(const StaticBody& body, TangentSolver& solver) {
  solver.prepare(body);
  if (solver.by_multigrid()) return judge_by_multigrid(body, solver);
  Stability s;
  const std::optional<int> negative = solver.factor(body);
  s.definite = negative == 0;
  if (s.definite) return s;
  if (body.tangent().norm() == 0.0) {  // where contacts just begin to touch
    s.neutral = true;
    return s;
  }
  Factor factor = analysed(body.tangent(), &solver.last_factor());
  if (!body.has_moment_part()) {
    judge_by_lowest(body, factor, negative, s);
    return s;
  }
  judge_beside_moments(body, factor, negative, s);
  if (solver.factors_full(body)) s.diverges = solver.take_full(body) && solver.sign_of_full() < 0;
  return s;
}

std::optional<double> smallest_eigenvalue(const StaticBody& body, const TangentSolver& solver,
                                          const Stability& s) {
  if ((solver.by_multigrid() && !s.lowest) || body.unknowns().size() == 0) return std::nullopt;
  if (!s.lowest && !s.definite && !s.neutral) return std::nullopt;
  const double smallest = s.lowest     ? s.lowest->values[0]
                          : s.definite ? eigenvalue_near_zero(body.tangent(), solver.last_factor())
                                       : eigenpairs_near_zero(body.tangent(), 1).values[0];
  if (!std::isfinite(smallest)) refuse_tangent(body);
  return smallest;
}

bool is_neutral(const StaticBody& body, const Stability& s, double smallest) {
  if (s.lowest) return s.neutral;
  const SparseMatrix& K = body.tangent();
  constexpr double far = 1e3;  // no mode's error is so many times that of all
  if (!s.definite || smallest > far * eigenvalue_error(K)) return s.neutral;
  const EigenPairs nearest = eigenpairs_near_zero(K, 1);
  return nearest.values[0] <= eigenvalue_error(K, nearest.vectors.col(0));
}

}  // namespace vbond
