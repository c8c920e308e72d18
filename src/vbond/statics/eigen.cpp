#include "vbond/statics/detail/eigen.hpp"

#include <Spectra/SymEigsSolver.h>
#include <Spectra/SymGEigsSolver.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace vbond {
namespace {

// Up to here all eigenpairs are found faster densely than a few by iteration (measured).
constexpr int largest_dense = 120;
constexpr double lanczos_tolerance = 1e-11;  // of vectors; eigenvalues are good to its square
constexpr int lanczos_restarts = 1000;
// A shift that is an eigenvalue is moved by this times the largest diagonal entry, then by more: the inverse
// reaches 1e8 there, and rounding of that leaves vectors of other eigenvalues eight digits and more.
constexpr double first_step = 1e-8;
// Eigenvalues are known to some eps times the largest diagonal entry.
constexpr double known_to = 1e-12;

bool solve_densely(Eigen::Index n, int count) {
  return n <= largest_dense || 3 * count > n;
}

int basis_size(int count, Eigen::Index n) {
  return static_cast<int>(std::min<Eigen::Index>(n, std::max(2 * count + 20, 40)));
}

/// Eigenpairs and the order in which they are wanted: by increasing key.
struct Found {
  std::vector<double> key;
  std::vector<double> value;
  DenseMatrix vectors;

  int size() const { return static_cast<int>(key.size()); }
  void add(double k, double v, const Vector& x) {
    key.push_back(k);
    value.push_back(v);
    vectors.conservativeResize(x.size(), size());
    vectors.col(size() - 1) = x;
  }
  void sort() {
    std::vector<int> order(key.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [this](int a, int b) { return key[std::size_t(a)] < key[std::size_t(b)]; });
    Found sorted;
    sorted.vectors.resize(vectors.rows(), size());
    for (const int k : order) {
      sorted.key.push_back(key[std::size_t(k)]);
      sorted.value.push_back(value[std::size_t(k)]);
      sorted.vectors.col(sorted.size() - 1) = vectors.col(k);
    }
    *this = std::move(sorted);
  }
  int below(double k) const {
    return static_cast<int>(std::count_if(key.begin(), key.end(), [k](double x) { return x < k; }));
  }
  EigenPairs part(int first, int count) const {
    const int n = std::clamp(size() - first, 0, count);
    return {Eigen::Map<const Vector>(value.data() + first, n), vectors.middleCols(first, n)};
  }
};

/// What to look for: `count` of `available` pairs, with keys from `from` on, known to `resolution`.
struct Wanted {
  int count, available;
  double from, resolution;
};

/// A key a little beyond `last`, and how many pairs there are below it.
template <class Number>
std::pair<double, int> counted_beyond(double last, double resolution, Number&& number_below) {
  for (double margin = std::max(1e-6 * std::abs(last), resolution);
       margin < 0.1 * std::abs(last) + 1e6 * resolution; margin *= 1.7)
    if (const std::optional<int> number = number_below(last + margin)) return {last + margin, *number};
  throw std::runtime_error("eigenvalues: they are too close to each other to be counted");
}

/// Looks for pairs until none is missing among the first ones. look(k, found) adds k more; number_below(key)
/// says how many there are, or nothing where a matrix is singular.
template <class Look, class Number>
EigenPairs find_all(const Wanted& w, Look&& look, Number&& number_below) {
  Found found;
  int unwanted = 0;
  int missing = std::min(w.count, w.available);
  for (int rounds = 0; missing > 0; ++rounds) {
    if (rounds > w.count + 20)
      throw std::runtime_error(fmt::format("eigenvalues: {} are missing that must exist", missing));
    look(missing, found);
    found.sort();
    unwanted = found.below(w.from);
    if (found.size() >= w.available) break;
    const int needed = std::min(w.count + unwanted, w.available);
    const double last = found.key[static_cast<std::size_t>(std::min(needed, found.size()) - 1)];
    const auto [cut, number] = counted_beyond(last, w.resolution, number_below);
    missing = std::max(std::min(number, w.available) - found.below(cut), needed - found.size());
  }
  return found.part(unwanted, w.count);
}

/// x -> scale P (A - sigma I)^-1 P x, P the projection normal to `without` and `found`.
struct ShiftedInverse {
  using Scalar = double;
  Eigen::Index rows() const { return n; }
  Eigen::Index cols() const { return n; }
  void project(Vector& x) const {
    if (without.cols() > 0) x -= without * Vector(without.transpose() * x);
    if (found.cols() > 0) x -= found * (found.transpose() * x);
  }
  void perform_op(const double* in, double* out) const {
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

template <class Solver>
void iterate(Solver& solver, Spectra::SortRule rule, int count, Eigen::Index n) {
  solver.init();
  const auto converged = static_cast<int>(solver.compute(rule, lanczos_restarts, lanczos_tolerance));
  if (converged < count)
    throw std::runtime_error(
        fmt::format("eigenvalues of a matrix of {} unknowns: {} of {} converged within {} restarts", n,
                    converged, count, lanczos_restarts));
}

double largest_diagonal(const SparseMatrix& A) {
  return Vector(A.diagonal()).cwiseAbs().maxCoeff();
}

/// A - sigma I factored, sigma where it was wanted, or a little below if that is an eigenvalue.
struct Shifted {
  Shifted(const SparseMatrix& A, double wanted) : sigma(wanted), scale(largest_diagonal(A)) {
    factor.analyse(A);
    if (!(scale > 0.0)) scale = 1.0;
    for (double step = first_step * scale;; step *= 10.0) {
      if (factor.factor_definite(A, -sigma)) return;
      if (const auto negative = factor.factor_indefinite(A, -sigma)) {
        below = *negative;
        return;
      }
      if (step > 1e-6 * scale) throw std::runtime_error("eigenvalues: no shift can be factored");
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
      const DenseMatrix Q =
          Eigen::HouseholderQR<DenseMatrix>(X).householderQ() * DenseMatrix::Identity(A.rows(), 4);
      for (Eigen::Index k = 0; k < 4; ++k) op.perform_op(Q.col(k).data(), X.col(k).data());
      nu = Eigen::SelfAdjointEigenSolver<DenseMatrix>(Q.transpose() * X).eigenvalues();
    }
    const double distance = at.scale / nu[3];
    if (nu[3] > 1.5 * nu[0] || distance < 1e2 * known_to * at.scale) return;
    const double closer = at.sigma + 0.9 * distance;
    if (!at.factor.factor_definite(A, -closer)) break;
    at.sigma = closer;
  }
  at.factor.factor_definite(A, -at.sigma);
}

/// Adds the `count` eigenpairs nearest to sigma (above it, with LargestAlge) that are not among those known;
/// `factor` is that of A - sigma I.
template <class Key>
void look_near(const SparseMatrix& A, const Factor& factor, Spectra::SortRule rule,
               const SparseMatrix& without, int count, Found& found, Key&& key) {
  const Eigen::Index n = A.rows();
  const DenseMatrix known = found.vectors;
  const double scale = largest_diagonal(A);
  ShiftedInverse op{n, factor, scale > 0.0 ? scale : 1.0, without, known};
  Spectra::SymEigsSolver<ShiftedInverse> solver(op, count, basis_size(count, n));
  iterate(solver, rule, count, n);
  const DenseMatrix x = solver.eigenvectors();
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    Vector v = x.col(k);
    op.project(v);
    v.normalize();
    const double value = v.dot(A * v);  // free of the rounding of the inverse
    found.add(key(value), value, v);
  }
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

}  // namespace

EigenPairs smallest_eigenpairs(const SparseMatrix& A, int count, double bound, const SparseMatrix& without) {
  const Eigen::Index n = A.rows();
  if (n == 0 || count <= 0) return {Vector(0), DenseMatrix(n, 0)};
  if (solve_densely(n, count)) {
    const Eigen::SelfAdjointEigenSolver<DenseMatrix> all(dense_without(A, without));
    Found found;
    for (Eigen::Index k = 0; k < n - without.cols(); ++k)
      if (all.eigenvalues()[k] >= bound - known_to * largest_diagonal(A))
        found.add(all.eigenvalues()[k], all.eigenvalues()[k], all.eigenvectors().col(k));
    return found.part(0, count);
  }
  Shifted at(A, bound);
  approach(A, without, at);
  const double no_end = std::numeric_limits<double>::infinity();
  const int available = static_cast<int>(n) - at.below - number_between(A, without, at.sigma, no_end);
  Factor counter;
  counter.analyse(A);
  const double resolution = known_to * at.scale;
  return find_all(
      Wanted{count, available, bound - at.sigma - resolution, resolution},
      [&](int k, Found& found) {
        look_near(A, at.factor, Spectra::SortRule::LargestAlge, without, k, found,
                  [&](double value) { return value - at.sigma; });
      },
      [&](double key) -> std::optional<int> {
        const auto negative = counter.factor_indefinite(A, -(at.sigma + key));
        if (!negative) return std::nullopt;
        return *negative - at.below - number_between(A, without, at.sigma, at.sigma + key);
      });
}

EigenPairs eigenpairs_near_zero(const SparseMatrix& A, int count) {
  const Eigen::Index n = A.rows();
  if (n == 0 || count <= 0) return {Vector(0), DenseMatrix(n, 0)};
  if (solve_densely(n, count)) {
    const Eigen::SelfAdjointEigenSolver<DenseMatrix> all((DenseMatrix(A)));
    Found found;
    for (Eigen::Index k = 0; k < n; ++k)
      found.add(std::abs(all.eigenvalues()[k]), all.eigenvalues()[k], all.eigenvectors().col(k));
    found.sort();
    return found.part(0, count);
  }
  const Shifted at(A, 0.0);
  Factor counter;
  counter.analyse(A);
  return find_all(
      Wanted{count, static_cast<int>(n), 0.0, known_to * at.scale},
      [&](int k, Found& found) {
        look_near(A, at.factor, Spectra::SortRule::LargestMagn, {}, k, found,
                  [](double value) { return std::abs(value); });
      },
      [&](double key) -> std::optional<int> {
        const auto below = counter.factor_indefinite(A, -key), far_below = counter.factor_indefinite(A, key);
        if (!below || !far_below) return std::nullopt;
        return *below - *far_below;
      });
}

double eigenvalue_near_zero(const SparseMatrix& A, const Factor& factor) {
  if (solve_densely(A.rows(), 1)) return eigenpairs_near_zero(A, 1).values[0];
  Found found;
  look_near(A, factor, Spectra::SortRule::LargestMagn, {}, 1, found,
            [](double value) { return std::abs(value); });
  return found.value[0];
}

namespace {

/// How far beyond the critical factor of smallest size others are looked for.
constexpr double factor_range = 1e4;

/// x -> -scale (B + A X Theta X^T A) x: pairs (theta, X) of -B x = theta A x that are known get theta = 0.
struct LoadOperator {
  using Scalar = double;
  Eigen::Index rows() const { return B.rows(); }
  Eigen::Index cols() const { return B.rows(); }
  void perform_op(const double* in, double* out) const {
    const Eigen::Map<const Vector> x(in, B.rows());
    Vector y = B * x;
    if (AX.cols() > 0) y += AX * theta.cwiseProduct(AX.transpose() * x);
    Eigen::Map<Vector>(out, B.rows()) = -scale * y;
  }
  const SparseMatrix& B;
  double scale;
  DenseMatrix AX;
  Vector theta;
};

struct StiffnessOperator {
  using Scalar = double;
  Eigen::Index rows() const { return A.rows(); }
  Eigen::Index cols() const { return A.rows(); }
  void solve(const double* in, double* out) const {
    Eigen::Map<Vector>(out, A.rows()) = factor.solve(Eigen::Map<const Vector>(in, A.rows()));
  }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Vector>(out, A.rows()) = A * Eigen::Map<const Vector>(in, A.rows());
  }
  const SparseMatrix& A;
  const Factor& factor;
};

/// Largest theta, or largest in size, of -B x = theta A x, as pairs (mu = 1 / theta, x).
void look_for_factors(StiffnessOperator& stiffness, const SparseMatrix& B, double scale,
                      Spectra::SortRule rule, int count, Found& found) {
  const SparseMatrix& A = stiffness.A;
  LoadOperator load{B, scale, {}, Vector(found.size())};
  if (found.size() > 0) load.AX = A * found.vectors;
  for (int k = 0; k < found.size(); ++k) load.theta[k] = 1.0 / found.value[static_cast<std::size_t>(k)];
  Spectra::SymGEigsSolver<LoadOperator, StiffnessOperator, Spectra::GEigsMode::RegularInverse> solver(
      load, stiffness, count, basis_size(count, A.rows()));
  iterate(solver, rule, count, A.rows());
  const Vector theta = solver.eigenvalues();
  const DenseMatrix x = solver.eigenvectors();
  for (Eigen::Index k = 0; k < theta.size(); ++k) {
    const Vector v = x.col(k);
    const double mu = scale / theta[k];
    found.add(mu, mu, v / std::sqrt(v.dot(A * v)));
  }
}

EigenPairs dense_factors(const SparseMatrix& A, const SparseMatrix& B, int count) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<DenseMatrix> all(-DenseMatrix(B), DenseMatrix(A));
  const Vector theta = all.eigenvalues();
  const double smallest = theta.cwiseAbs().maxCoeff() / factor_range;
  Found found;
  for (Eigen::Index k = theta.size() - 1; k >= 0 && theta[k] > smallest; --k)
    found.add(1.0 / theta[k], 1.0 / theta[k], all.eigenvectors().col(k));
  return found.part(0, count);
}

}  // namespace

EigenPairs critical_factors(const SparseMatrix& A, const SparseMatrix& B, int count) {
  const Eigen::Index n = A.rows();
  const double largest_B = B.nonZeros() > 0 ? B.coeffs().cwiseAbs().maxCoeff() : 0.0;
  if (n == 0 || count <= 0) return {Vector(0), DenseMatrix(n, 0)};
  Factor factor;
  factor.analyse(A);
  if (!factor.factor_definite(A))
    throw std::invalid_argument("critical factors: the matrix is not positive definite");
  if (!(largest_B > 0.0)) return {Vector(0), DenseMatrix(n, 0)};
  if (solve_densely(n, count)) return dense_factors(A, B, count);
  StiffnessOperator stiffness{A, factor};
  // Some |theta| is at least max |B_ij| over the largest eigenvalue of A: scaled it is not far below 1.
  const double scale = largest_diagonal(A) / largest_B;
  Found nearest;
  look_for_factors(stiffness, B, scale, Spectra::SortRule::LargestMagn, 1, nearest);
  Factor counter;
  counter.analyse(A + B);
  const auto number_below = [&](double mu) { return counter.factor_indefinite(A + mu * B); };
  const std::optional<int> available = number_below(factor_range * std::abs(nearest.value[0]));
  if (!available) throw std::runtime_error("critical factors: they cannot be counted");
  return find_all(
      Wanted{count, *available, 0.0, 0.0},
      [&](int k, Found& found) {
        look_for_factors(stiffness, B, scale, Spectra::SortRule::LargestAlge, k, found);
      },
      number_below);
}

namespace {

struct Product {
  using Scalar = double;
  Eigen::Index rows() const { return A.rows(); }
  Eigen::Index cols() const { return A.rows(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Vector>(out, A.rows()) = scale * (A * Eigen::Map<const Vector>(in, A.rows()));
  }
  const SparseMatrix& A;
  double scale;
};

}  // namespace

double largest_eigenvalue(const SparseMatrix& A) {
  const Eigen::Index n = A.rows();
  if (n == 0) throw std::invalid_argument("largest eigenvalue of an empty matrix");
  if (n <= largest_dense) {
    const Eigen::SelfAdjointEigenSolver<DenseMatrix> all(DenseMatrix(A), Eigen::EigenvaluesOnly);
    const double radius = all.eigenvalues().cwiseAbs().maxCoeff();
    return all.eigenvalues()[n - 1] + 1e-12 * radius;  // rounding of some n eps
  }
  const double diagonal = largest_diagonal(A), scale = diagonal > 0.0 ? 1.0 / diagonal : 1.0;
  Product op{A, scale};
  Spectra::SymEigsSolver<Product> solver(op, 1, basis_size(1, n));
  solver.init();
  for (const double tolerance : {1e-10, 1e-8, 1e-6}) {
    if (solver.compute(Spectra::SortRule::LargestAlge, 200, tolerance) < 1) continue;
    const Vector x = solver.eigenvectors().col(0).normalized();
    const double theta = x.dot(A * x);
    return theta + (A * x - theta * x).norm();  // an eigenvalue lies within the residual of theta
  }
  throw std::runtime_error(fmt::format("largest eigenvalue of a matrix of {} unknowns: no convergence", n));
}

}  // namespace vbond
