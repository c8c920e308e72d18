#include "vbond/statics/detail/linear_buckling.hpp"

#include <cmath>
#include <limits>

#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {
namespace {

/// The derivative of the tangent along the path, by a central difference over +-h. With 1/s the load factor
/// that would change a bond by 1, K' is about s K and its third derivative s^3 K: truncation is h^2 s^3 K /
/// 6, rounding eps K / h, and their sum is least near h = eps^(1/3) / s, where both are eps^(2/3) = 4e-11 of
/// K'.
SparseMatrix tangent_rate(StaticBody& body, const Vector& rate) {
  const double h = std::cbrt(std::numeric_limits<double>::epsilon()) / body.largest_bond_change(rate, 1.0);
  const Placement here = body.placement();
  const auto tangent_at = [&](double change) {
    body.restore(here);
    body.move(change * rate, here.load_factor + change);
    return body.tangent();
  };
  const SparseMatrix above = tangent_at(h), below = tangent_at(-h);
  body.restore(here);
  return (above - below) / (2 * h);
}

/// The lowest theta of K' x = theta K x are -1/mu.
std::vector<double> by_multigrid(ByMultigrid& solver, const SparseMatrix& K, const SparseMatrix& rate,
                                 int count) {
  constexpr double tolerance = 1e-6, range = 1e-4;
  LowestProblem problem;
  problem.size = K.rows();
  problem.times = [&rate](const DenseMatrix& X) -> DenseMatrix { return rate * X; };
  problem.metric = [&K](const DenseMatrix& X) -> DenseMatrix { return K * X; };
  problem.inverse = [&solver](const DenseMatrix& X) { return solver.solutions(X); };
  std::vector<double> factors;
  const int number = std::min(count, static_cast<int>(K.rows()));
  for (const double theta : solver.lowest_of(problem, {number, tolerance, 0.0, 200}).values) {
    if (!(theta < 0.0) || (!factors.empty() && -theta < range / factors[0])) break;
    factors.push_back(-1.0 / theta);
  }
  return factors;
}

}  // namespace

std::vector<double> linear_critical_factors(StaticBody& body, TangentSolver& solver, const Vector& rate,
                                            int count) {
  if (!(body.largest_bond_change(rate, 1.0) > 0.0)) return {};
  const Pulse::Work work("linear estimates of critical loads");
  const SparseMatrix K = body.tangent();
  try {
    const SparseMatrix rate_of_K = tangent_rate(body, rate);
    if (solver.by_multigrid()) return by_multigrid(solver.multigrid_at(body), K, rate_of_K, count);
    const Vector values = critical_factors(K, rate_of_K, count).values;
    return {values.begin(), values.end()};
  } catch (const NoConvergence&) {
    return {};
  }
}

}  // namespace vbond
