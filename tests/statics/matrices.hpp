#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "vbond/statics/detail/matrix.hpp"

/// Matrices whose eigenvalues are known.
namespace vbond {

inline SparseMatrix from_triplets(int n, const std::vector<Eigen::Triplet<double>>& t) {
  SparseMatrix A(n, n);
  A.setFromTriplets(t.begin(), t.end());
  return A;
}

/// Springs of these stiffnesses between the neighbours of a box of nx*ny*nz points, its surface free; with
/// `held`, the outside of the box is held by springs of the same kind.
template <class Stiffness>
SparseMatrix lattice(int nx, int ny, int nz, bool held, Stiffness&& stiffness) {
  std::vector<Eigen::Triplet<double>> t;
  const int n[3] = {nx, ny, nz}, stride[3] = {1, nx, nx * ny};
  for (int p = 0; p < nx * ny * nz; ++p)
    for (int k = 0; k < 3; ++k) {
      const int at = p / stride[k] % n[k], q = p + stride[k];
      if (held && at == 0) t.emplace_back(p, p, stiffness());
      if (held && at + 1 == n[k]) t.emplace_back(p, p, stiffness());
      if (at + 1 == n[k]) continue;
      const double c = stiffness();
      t.emplace_back(p, p, c), t.emplace_back(q, q, c), t.emplace_back(p, q, -c), t.emplace_back(q, p, -c);
    }
  return from_triplets(nx * ny * nz, t);
}
inline SparseMatrix lattice(int nx, int ny, int nz, bool held) {
  return lattice(nx, ny, nz, held, [] { return 1.0; });
}

/// All eigenvalues of the held lattice of unit springs, in increasing order.
inline std::vector<double> held_lattice_eigenvalues(int nx, int ny, int nz) {
  const auto one = [](int k, int n) { return 2.0 - 2.0 * std::cos(k * std::numbers::pi / (n + 1)); };
  std::vector<double> values;
  for (int i = 1; i <= nx; ++i)
    for (int j = 1; j <= ny; ++j)
      for (int k = 1; k <= nz; ++k) values.push_back(one(i, nx) + one(j, ny) + one(k, nz));
  std::sort(values.begin(), values.end());
  return values;
}

inline Vector random_vector(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Vector x(n);
  for (double& v : x) v = normal(random);
  return x;
}

}  // namespace vbond
