#include "vbond/statics/detail/eigen.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>

#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/eigen_search.hpp"
#include "vbond/statics/detail/lanczos.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {
namespace {

// A shift that is an eigenvalue, or next to one, is moved by this times the largest diagonal entry, then by
// more: the inverse reaches 1e8 there, and rounding of that leaves vectors of other eigenvalues eight digits
// and more.
constexpr double first_step = 1e-8;
// Eigenvalues are known to some eps times the largest diagonal entry.
constexpr double known_to = 1e-12;
// Vectors are found to 1e-11 of the largest eigenvalue of the inverse, so to seven digits where
// their own is this part of it.
constexpr double least_share = 1e-4;

/// Counting takes a factor of an indefinite matrix, which has no blocks for BLAS: from some size on, one more
/// search is cheaper (a lattice of 15,000 unknowns: 1 s against 0.1 s; of 45,000: 15 s against 0.5 s).
constexpr double largest_counted = 0x1p25;  // bytes of the factor

template <class Look, class Number>
EigenPairs find_all(const Factor& factor, const Wanted& w, Look&& look, Number&& number_below) {
  if (factor.bytes() > largest_counted) return find_searched(w, look);
  return find_counted(w, look, number_below);
}

/// x -> scale P (A - sigma I)^-1 P x, P the projection normal to `without` and `found`.
struct ShiftedInverse {
  void project(Vector& x) const {
    if (without.cols() > 0) x -= without * Vector(without.transpose() * x);
    if (found.cols() > 0) x -= found * (found.transpose() * x);
  }
  void operator()(const double* in, double* out) const {
    Pulse::may_end();
    Vector x = Eigen::Map<const Vector>(in, n);
    project(x);
    x = scale * factor.solve(x);
    project(x);
    Eigen::Map<Vector>(out, n) = x;
  }
  Eigen::Index n;
  const Factor& factor;
  double scale;  // makes results comparable with 1: Spectra has an absolute tolerance too
  const SparseMatrix& without;
  const DenseMatrix& found;
};

/// A - sigma I factored, sigma where it was wanted, or a little below if that is an eigenvalue.
struct Shifted {
  Shifted(const SparseMatrix& A, double wanted, const Factor* of_same_pattern = nullptr)
      : factor(analysed(A, of_same_pattern)), sigma(wanted), scale(largest_diagonal(A)) {
    if (!(scale > 0.0)) scale = 1.0;
    for (double step = first_step * scale;; step *= 10.0) {
      if (factor.factor_definite(A, -sigma)) return;
      if (const auto negative = factor.factor_indefinite(A, -sigma)) {
        below = *negative;
        return;
      }
      if (step > 1e-6 * scale) throw NoConvergence("eigenvalues: no shift can be factored");
      sigma = wanted - step;
    }
  }
  Factor factor;
  double sigma;
  double scale;   // largest |A_ii|
  int below = 0;  // eigenvalues below sigma
};

/// Moves a shift that lies far below all eigenvalues up to them, where iteration is quick: it is too far as
/// long as the lowest ones look the same from there. Four vectors tell them even if three are equal.
void approach(const SparseMatrix& A, const SparseMatrix& without, Shifted& at) {
  if (at.below > 0) return;
  const DenseMatrix none(A.rows(), 0);
  const ShiftedInverse op{A.rows(), at.factor, at.scale, without, none};
  DenseMatrix X(A.rows(), 4);
  for (Eigen::Index k = 0; k < X.size(); ++k)  // anything in which no eigenvector is missing
    X.data()[k] = std::sin(static_cast<double>(k + 1) * static_cast<double>(k + 1));
  Vector nu;
  while (true) {
    for (int iterations = 0; iterations < 3; ++iterations) {
      const DenseMatrix Q = orthonormal(X);
      for (Eigen::Index k = 0; k < 4; ++k) op(Q.col(k).data(), X.col(k).data());
      nu = dense_eigenpairs(Q.transpose() * X).values;
    }
    const double distance = at.scale / nu[3];
    if (nu[3] > 1.5 * nu[0] || distance < 1e2 * known_to * at.scale) return;
    const double closer = at.sigma + 0.9 * distance;
    if (!at.factor.factor_definite(A, -closer)) break;
    at.sigma = closer;
  }
  at.factor.factor_definite(A, -at.sigma);
}

/// Adds up to `count` eigenpairs nearest to sigma (above it, with Largest::value) that are not among those
/// known; `factor` is that of A - sigma I. Those much further off than the nearest wait for the next look.
template <class Key>
void look_near(const SparseMatrix& A, const Factor& factor, Largest which, const SparseMatrix& without,
               int count, Found& found, Key&& key) {
  const Eigen::Index n = A.rows();
  const DenseMatrix known = found.vectors;
  const double scale = largest_diagonal(A);
  const ShiftedInverse op{n, factor, scale > 0.0 ? scale : 1.0, without, known};
  const auto [nu, x] = lanczos(n, std::cref(op), which, count);
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    if (std::abs(nu[k]) < least_share * nu.cwiseAbs().maxCoeff()) continue;
    Vector v = x.col(k);
    op.project(v);
    v.normalize();
    const double value = v.dot(A * v);  // free of the rounding of the inverse
    found.add(key(value), value, v);
  }
}

void check(const DenseEigen& all) {
  if (!all.found || !all.values.allFinite()) throw NoConvergence("eigenvalues: the matrix is not finite");
}

/// How many of these eigenvectors have eigenvalues between the two.
int number_between(const SparseMatrix& A, const SparseMatrix& vectors, double low, double high) {
  int number = 0;
  for (Eigen::Index k = 0; k < vectors.cols(); ++k) {
    const Vector v = vectors.col(k);
    const double value = v.dot(A * v);
    number += value > low && value <= high;
  }
  return number;
}

/// A + shift of the columns of `without` to the end of the spectrum.
DenseMatrix dense_without(const SparseMatrix& A, const SparseMatrix& without) {
  DenseMatrix D(A);
  if (without.cols() == 0) return D;
  const double radius = D.cwiseAbs().rowwise().sum().maxCoeff();  // all eigenvalues lie within
  return D + 4.0 * radius * DenseMatrix(without * SparseMatrix(without.transpose()));
}

/// The smallest eigenpairs of a large matrix, looked for from a shift that is the bound or below it.
EigenPairs pairs_above(const SparseMatrix& A, int count, double bound, double shift,
                       const SparseMatrix& without) {
  const Eigen::Index n = A.rows();
  Shifted at(A, shift);
  approach(A, without, at);
  const double no_end = std::numeric_limits<double>::infinity();
  const int available = static_cast<int>(n) - at.below - number_between(A, without, at.sigma, no_end);
  Factor counter = analysed(A, &at.factor);
  const double resolution = known_to * at.scale;
  return find_all(
      at.factor, Wanted{count, available, bound - at.sigma - resolution, resolution},
      [&](int k, Found& found) {
        look_near(A, at.factor, Largest::value, without, k, found,
                  [&](double value) { return value - at.sigma; });
      },
      [&](double key) -> std::optional<int> {
        const auto negative = counter.factor_indefinite(A, -(at.sigma + key));
        if (!negative) return std::nullopt;
        return *negative - at.below - number_between(A, without, at.sigma, at.sigma + key);
      });
}

}  // namespace

EigenPairs smallest_eigenpairs(const SparseMatrix& A, int count, double bound, const SparseMatrix& without) {
  const Eigen::Index n = A.rows();
  if (n == 0 || count <= 0) return {Vector(0), DenseMatrix(n, 0)};
  if (solve_densely(n, count)) {
    const DenseEigen all = dense_eigenpairs(dense_without(A, without));
    check(all);
    Found found;
    for (Eigen::Index k = 0; k < n - without.cols(); ++k)
      if (all.values[k] >= bound - known_to * largest_diagonal(A))
        found.add(all.values[k], all.values[k], all.vectors.col(k));
    return found.part(0, count);
  }
  try {
    return pairs_above(A, count, bound, bound, without);
  } catch (const NoConvergence&) {  // several eigenvalues next to the shift: from farther below
    return pairs_above(A, count, bound, bound - first_step * largest_diagonal(A), without);
  }
}

namespace {

double size_of(double value) {
  return std::abs(value);
}

/// Looks from a shift at or near zero; where an eigenvalue is nearer to it than `too_near`, from there below.
EigenPairs near_zero(const SparseMatrix& A, int count, double shift, double too_near,
                     const Factor* of_same_pattern) {
  std::optional<Shifted> at;
  at.emplace(A, shift, of_same_pattern);
  Found nearest;
  look_near(A, at->factor, Largest::size, {}, 1, nearest, size_of);
  if (nearest.key[0] < too_near) {
    const Factor before = std::move(at->factor);
    at.emplace(A, -too_near, &before);
  }
  Factor counter = analysed(A, &at->factor);
  EigenPairs found = find_all(
      at->factor, Wanted{count, static_cast<int>(A.rows()), 0.0, known_to * at->scale},
      [&](int k, Found& f) { look_near(A, at->factor, Largest::size, {}, k, f, size_of); },
      [&](double key) -> std::optional<int> {
        const auto below = counter.factor_indefinite(A, -key), far_below = counter.factor_indefinite(A, key);
        if (!below || !far_below) return std::nullopt;
        return *below - *far_below;
      });
  found.factors = 1 + at->factor.made() + counter.made();
  return found;
}

}  // namespace

EigenPairs eigenpairs_near_zero(const SparseMatrix& A, int count, const Factor* of_same_pattern) {
  const Eigen::Index n = A.rows();
  if (n == 0 || count <= 0) return {Vector(0), DenseMatrix(n, 0)};
  if (solve_densely(n, count)) {
    const DenseEigen all = dense_eigenpairs(DenseMatrix(A));
    check(all);
    Found found;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Vector v = all.vectors.col(k);
      const double value = v.dot(A * v);  // free of the rounding of the method
      found.add(std::abs(value), value, v);
    }
    found.sort();
    return found.part(0, count);
  }
  // a shift that is an eigenvalue to rounding leaves Lanczos nothing but that eigenvalue: then from beside it
  const double away = first_step * largest_diagonal(A);
  for (const double times : {0.0, 1.0, 3.7}) {
    try {
      return near_zero(A, count, -times * away, times == 0.0 ? away : 0.0, of_same_pattern);
    } catch (const NoConvergence&) {
    }
  }
  return near_zero(A, count, -19.0 * away, 0.0, of_same_pattern);
}

double eigenvalue_near_zero(const SparseMatrix& A, const Factor& factor) {
  if (solve_densely(A.rows(), 1)) return eigenpairs_near_zero(A, 1).values[0];
  Found found;
  look_near(A, factor, Largest::size, {}, 1, found, [](double value) { return std::abs(value); });
  return found.value[0];
}

double largest_eigenvalue(const SparseMatrix& A) {
  const Eigen::Index n = A.rows();
  if (n == 0) throw std::invalid_argument("largest eigenvalue of an empty matrix");
  if (n <= largest_dense) {
    const DenseEigen all = dense_eigenvalues(DenseMatrix(A));
    check(all);
    const double radius = all.values.cwiseAbs().maxCoeff();
    return all.values[n - 1] + 1e-12 * radius;  // rounding of some n eps
  }
  const double diagonal = largest_diagonal(A), scale = diagonal > 0.0 ? 1.0 / diagonal : 1.0;
  const auto product = [&](const double* in, double* out) {
    Eigen::Map<Vector>(out, n) = scale * (A * Eigen::Map<const Vector>(in, n));
  };
  const std::optional<Vector> x = lanczos_largest(n, product, {1e-10, 1e-8, 1e-6});
  if (!x)
    throw NoConvergence(fmt::format("largest eigenvalue of a matrix of {} unknowns: no convergence", n));
  const double theta = x->dot(A * *x);
  return theta + (A * *x - theta * *x).norm();  // an eigenvalue lies within the residual of theta
}

Vector mode_of_cluster(DenseMatrix columns, int mode) {
  for (int k = 0;; ++k) {
    const Vector reach = columns.rowwise().norm();
    Eigen::Index first = 0;
    while (reach[first] < (1.0 - 1e-6) * reach.maxCoeff()) ++first;
    const Vector weights = columns.row(first).transpose() / reach[first];
    const Vector v = columns * weights;
    if (k == mode - 1) return v;
    columns -= v * weights.transpose();
  }
}

}  // namespace vbond
