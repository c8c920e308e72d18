#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

#include "vbond/statics/detail/matrix.hpp"

/// Pivots of L D L^T that are zero to rounding. A factor c has columns(), d(j) and below(j, f), which calls
/// f(row, value) for what is below the diagonal.
namespace vbond {

/// What rounding may have added to the pivot d_k. The factors are exactly those of A + E, with
/// |E| <= eps |L| |D| |L|^T (Higham, Accuracy and Stability of Numerical Algorithms, th. 10.3, without its
/// factor for the number of terms, which random signs keep near 1). With L^T v = e_k, v^T A v = d_k, so to
/// first order d_k has changed by v^T E v.
template <class L>
double rounding_of_pivot(const L& c, int k) {
  std::vector<double> v(static_cast<std::size_t>(k) + 1, 0.0);
  v.back() = 1.0;
  double sum = std::abs(c.d(k));
  for (int j = k - 1; j >= 0; --j) {
    double v_j = 0.0, reach = 0.0;
    c.below(j, [&](int i, double l) {
      if (i > k) return;
      v_j -= l * v[static_cast<std::size_t>(i)];
      reach += std::abs(l * v[static_cast<std::size_t>(i)]);
    });
    v[static_cast<std::size_t>(j)] = v_j;
    const double r = reach + std::abs(v_j);
    sum += std::abs(c.d(j)) * r * r;
  }
  return epsilon * sum;
}

/// The first pivot that is zero to rounding or not finite, or -1. The bound of rounding is worked out only
/// for pivots in which nearly everything cancels: of a free body of n unknowns that moves as a whole v = 1
/// everywhere, and the bound about 4 n eps times what cancels; a hundred instead of 4 leaves room for an
/// uneven v.
template <class L>
int lost_pivot(const L& c) {
  std::vector<double> cancelled(static_cast<std::size_t>(c.columns()), 0.0);  // diagonal of |L| |D| |L|^T
  const double suspect = 100.0 * epsilon * c.columns();
  for (int k = 0; k < c.columns(); ++k) {
    const double d = std::abs(c.d(k));
    if (!std::isfinite(d)) return k;
    c.below(k, [&](int i, double l) { cancelled[static_cast<std::size_t>(i)] += l * l * d; });
    if (d <= suspect * (d + cancelled[static_cast<std::size_t>(k)]) && d <= rounding_of_pivot(c, k)) return k;
  }
  return -1;
}

}  // namespace vbond
