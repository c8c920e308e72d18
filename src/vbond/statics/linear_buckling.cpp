#include "vbond/statics/detail/linear_buckling.hpp"

#include <cmath>
#include <limits>

#include "vbond/statics/detail/eigen.hpp"

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

}  // namespace

std::vector<double> linear_critical_factors(StaticBody& body, const Vector& rate, int count) {
  if (!(body.largest_bond_change(rate, 1.0) > 0.0)) return {};
  const SparseMatrix K = body.tangent();
  try {
    const Vector values = critical_factors(K, tangent_rate(body, rate), count).values;
    return {values.begin(), values.end()};
  } catch (const NoConvergence&) {
    return {};
  }
}

}  // namespace vbond
