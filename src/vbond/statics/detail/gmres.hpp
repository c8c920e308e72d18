#pragma once
#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/statics/detail/dense.hpp"

namespace vbond {

struct Gmres {
  Vector x;
  double left = 0;  ///< |b - A x|
  int iterations = 0;
};

/// x with |b - A x| <= enough by GMRES (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856),
/// preconditioned from the right, so that the residual is that of A: times(p) is A p, inverse(r) is roughly
/// A^-1 r. Begins anew after `basis` iterations; ends with more left
/// after `most`, or where a round gains nothing.
template <class Times, class Inverse>
Gmres gmres(Times&& times, Inverse&& inverse, const Vector& b, double enough, int basis, int most) {
  Gmres g{Vector::Zero(b.size()), b.norm(), 0};
  Vector r = b;
  while (g.left > enough && g.iterations < most && std::isfinite(g.left)) {
    const double size = g.left;
    DenseMatrix V(b.size(), basis + 1), Z(b.size(), basis), H = DenseMatrix::Zero(basis + 1, basis);
    V.col(0) = r / size;
    int k = 0;
    Vector y;
    for (; k < basis; ++g.iterations) {
      Z.col(k) = inverse(Vector(V.col(k)));
      Vector w = times(Vector(Z.col(k)));
      for (int twice = 0; twice < 2; ++twice) {
        const Vector along = V.leftCols(k + 1).transpose() * w;
        w -= V.leftCols(k + 1) * along;
        H.col(k).head(k + 1) += along;
      }
      H(k + 1, k) = w.norm();
      ++k;
      y = solve_shortest(H.topLeftCorner(k + 1, k), size * Vector::Unit(k + 1, 0));
      const double left = (size * Vector::Unit(k + 1, 0) - H.topLeftCorner(k + 1, k) * y).norm();
      if (left <= 0.5 * enough || !(H(k, k - 1) > 0.0)) break;
      V.col(k) = w / H(k, k - 1);
    }
    const Vector next = g.x + Z.leftCols(k) * y;
    Vector next_r = b - times(next);
    const double left = next_r.norm();
    if (!(left < size)) break;
    g.x = next;
    g.left = left;
    r = std::move(next_r);
    if (left > 0.9 * size) break;
  }
  return g;
}

}  // namespace vbond
