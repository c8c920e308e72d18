#include "vbond/statics/detail/kept_factor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/statics/detail/dense.hpp"

namespace vbond {
namespace {

/// An upper bound of the largest eigenvalue of D^-1/2 M D^-1/2 (Gershgorin).
double largest_scaled_row(const SparseMatrix& M) {
  const Vector root = M.diagonal().cwiseSqrt();
  double largest = 0.0;
  for (int j = 0; j < M.outerSize(); ++j) {
    double sum = 0.0;
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) sum += std::abs(it.value()) / root[it.row()];
    largest = larger(largest, sum / root[j]);
  }
  return largest;
}

}  // namespace

void KeptFactor::begin(const SparseMatrix& A) {
  at_hand_ = true;
  M_ = A;
  kappa_ = largest_scaled_row(M_);
  changes_.clear();
  proofs_ = 0;
  price_ = 1.0;
  spent_ = in_cycle_ = recent_ = 0.0;
}

void KeptFactor::drop() {
  at_hand_ = false;
  changes_.clear();
}

bool KeptFactor::is_due() const {
  return in_cycle_ > patience() || (proofs_ > 0 && recent_ * proofs_ > factor_.cost_in_solutions() + spent_);
}

double KeptFactor::patience() const {
  return std::max(30.0, factor_.cost_in_solutions());
}

void KeptFactor::follow(const SparseMatrix& A, const std::vector<int>& unknowns) {
  constexpr double least_part = 1e-3;  // of the largest: what is less is movement, as everywhere else
  const auto at = [&unknowns](Eigen::Index k) { return unknowns[static_cast<std::size_t>(k)]; };
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  DenseMatrix change(size, size);
  for (Eigen::Index j = 0; j < size; ++j)
    for (Eigen::Index i = 0; i < size; ++i) change(i, j) = A.coeff(at(i), at(j)) - M_.coeff(at(i), at(j));
  const DenseEigen parts = dense_eigenpairs(change);
  if (!parts.found || !parts.values.allFinite()) return drop();
  std::vector<Eigen::Index> large;
  const double least = least_part * max_norm(parts.values);
  for (Eigen::Index k = 0; k < size; ++k)
    if (std::abs(parts.values[k]) > least) large.push_back(k);
  if (large.empty()) return;

  Change c{unknowns, parts.vectors(Eigen::all, large), {}, {}};
  const Vector values = parts.values(large);
  DenseMatrix Q = DenseMatrix::Zero(A.rows(), c.Q.cols());
  Q(unknowns, Eigen::all) = c.Q;
  c.Z = solve_kept(Q);
  DenseMatrix outer = c.Q.transpose() * c.Z(unknowns, Eigen::all);
  outer.diagonal() += values.cwiseInverse();
  // what M gains or loses in negative eigenvalues, this matrix has more or less than the values (Haynsworth)
  const DenseEigen signs = dense_eigenpairs(outer);
  if (!signs.found || (signs.values.array() < 0.0).count() != (values.array() < 0.0).count()) return drop();
  c.inner = signs.vectors * signs.values.cwiseInverse().asDiagonal() * signs.vectors.transpose();
  if (!c.inner.allFinite()) return drop();
  const DenseMatrix followed = c.Q * values.asDiagonal() * c.Q.transpose();
  for (Eigen::Index j = 0; j < size; ++j)
    for (Eigen::Index i = 0; i < size; ++i)
      if (followed(i, j) != 0.0) M_.coeffRef(at(i), at(j)) += followed(i, j);
  kappa_ = largest_scaled_row(M_);
  price_ += static_cast<double>(c.Z.size()) * sizeof(double) / (2.0 * factor_.bytes());
  in_cycle_ += 3.0 * price_;  // columns, which go through the factor together
  changes_.push_back(std::move(c));
}

DenseMatrix KeptFactor::solve_kept(const DenseMatrix& B) const {
  DenseMatrix X = factor_.solve_columns(B);
  for (const Change& c : changes_) {
    const DenseMatrix part = c.inner * (c.Q.transpose() * X(c.unknowns, Eigen::all));
    X.noalias() -= c.Z * part;
  }
  return X;
}

std::optional<Vector> KeptFactor::gradients(const SparseMatrix& A, Vector r, const Enough& enough,
                                            GradientsMade* made) {
  const auto times = [&A](const Vector& p) -> Vector { return A * p; };
  const auto inverse = [this](const Vector& v) -> Vector {
    in_cycle_ += price_;
    return solve_kept(v);
  };
  return conjugate_gradients(times, inverse, std::move(r), enough, patience(), made);
}

std::optional<Vector> KeptFactor::solve(const SparseMatrix& A, const Vector& b, double accuracy) {
  return gradients(A, b, {0.0, accuracy}, nullptr);
}

std::optional<DenseMatrix> KeptFactor::solve_columns(const SparseMatrix& A, const DenseMatrix& B,
                                                     const DenseMatrix& X, double accuracy) {
  const auto times = [&A](const DenseMatrix& P) -> DenseMatrix { return A * P; };
  const auto inverse = [this](const DenseMatrix& R) -> DenseMatrix {
    in_cycle_ += price_;
    return solve_kept(R);
  };
  return conjugate_gradients_of_columns(times, inverse, B, X, accuracy, patience());
}

Vector KeptFactor::solve_roughly(const Vector& b) {
  in_cycle_ += price_;
  return solve_kept(b);
}

Vector KeptFactor::random_side() {
  constexpr double half_width = 1.7320508075688772;  // sqrt(3): of variance 1
  Vector r(M_.rows());
  for (Eigen::Index k = 0; k < r.size(); ++k) {
    const double unit = static_cast<double>(random_() >> 11) * 0x1p-53;
    r[k] = half_width * (2.0 * unit - 1.0);
  }
  return r.cwiseProduct(M_.diagonal().cwiseSqrt());
}

/// Of M^-1 A, by the tridiagonal matrix of Lanczos that conjugate gradients contain.
double KeptFactor::smallest_ritz_value(const GradientsMade& c) const {
  const auto size = static_cast<Eigen::Index>(c.alpha.size());
  DenseMatrix T = DenseMatrix::Zero(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const auto at = static_cast<std::size_t>(k);
    T(k, k) = 1.0 / c.alpha[at] + (k > 0 ? c.beta[at - 1] / c.alpha[at - 1] : 0.0);
    if (k + 1 < size) T(k, k + 1) = T(k + 1, k) = std::sqrt(c.beta[at]) / c.alpha[at];
  }
  const DenseEigen all = dense_eigenvalues(T);
  return all.found && size > 0 ? all.values[0] : 0.0;
}

bool KeptFactor::shows_definite(const SparseMatrix& A) {
  constexpr double delta = 1e-9;
  constexpr double soft = 1e-3;  // so much softer than M along some movement: let a factor judge
  GradientsMade c;
  const bool ended = gradients(A, random_side(), {delta / std::sqrt(kappa_), 0.0}, &c).has_value();
  spent_ += in_cycle_;
  constexpr double weight = 0.25;  // after a break more are needed than after a step: a mean over some proofs
  const double cycle = std::exchange(in_cycle_, 0.0);
  recent_ += (proofs_++ == 0 ? 1.0 : weight) * (cycle - recent_);
  return ended && smallest_ritz_value(c) > soft;
}

}  // namespace vbond
