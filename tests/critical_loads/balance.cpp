#include "balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vbond/statics/detail/dense.hpp"

namespace vbond::campaign {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// [K, -q; c, gamma]: regular at limit points, too, if the control moves there.
SparseMatrix bordered(const SparseMatrix& K, const Vector& q, Control control) {
  const int n = static_cast<int>(K.rows());
  Triplets entries;
  entries.reserve(static_cast<std::size_t>(K.nonZeros() + n + 1));
  for (int column = 0; column < n; ++column)
    for (SparseMatrix::InnerIterator it(K, column); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), column, it.value());
  for (int row = 0; row < n; ++row) entries.emplace_back(row, n, -q[row]);
  if (control.unknown == Control::load_factor)
    entries.emplace_back(n, n, 1.0);
  else
    entries.emplace_back(n, control.unknown, 1.0);
  SparseMatrix M(n + 1, n + 1);
  M.setFromTriplets(entries.begin(), entries.end());
  M.makeCompressed();
  return M;
}

int dense_count(const SparseMatrix& K) {
  return static_cast<int>((dense_eigenvalues(K).values.array() < 0.0).count());
}

/// Eigenvalues next to zero, by inverse iteration with a block and Ritz values.
std::optional<Vector> next_to_zero(const SparseMatrix& K, int wanted, int block) {
  const int n = static_cast<int>(K.rows());
  Eigen::SparseLU<SparseMatrix> lu(K);
  if (lu.info() != Eigen::Success) return {};
  DenseMatrix X(n, block);
  for (int k = 0; k < n; ++k)  // any vectors, the same each time
    for (int b = 0; b < block; ++b) X(k, b) = std::cos(1.0 + 0.7 * k * (b + 1) + 0.3 * b * b);
  Vector last = Vector::Zero(block);
  for (int round = 0; round < 200; ++round) {
    const DenseMatrix Q = orthonormal(X);
    const DenseMatrix Y = lu.solve(Q);
    const DenseMatrix S = Q.transpose() * Y;
    const DenseEigen ritz = dense_eigenpairs(0.5 * (S + S.transpose()));
    X = Y * ritz.vectors;
    Vector inverse = ritz.values;
    std::sort(inverse.begin(), inverse.end(), [](double a, double b) { return std::abs(a) > std::abs(b); });
    const double change =
        ((inverse - last).head(wanted).array() / inverse.head(wanted).array()).abs().maxCoeff();
    last = inverse;
    if (change < 1e-13) break;
  }
  return last.cwiseInverse();
}

}  // namespace

double Balances::value(Control control) const {
  if (control.unknown == Control::load_factor) return body_.load_factor();
  const auto [p, dof] = body_.unknowns().place(control.unknown);
  return component(body_.state().r[p], dof);
}

bool Balances::factor(Control control) {
  const SparseMatrix M = bordered(body_.tangent(), body_.load_direction(), control);
  if (analysed_for_ != control.unknown) bordered_.analyzePattern(M);
  analysed_for_ = control.unknown;
  bordered_.factorize(M);
  return bordered_.info() == Eigen::Success;
}

/// Signs of D. An odd number belongs to a negative determinant: if the two disagree, all eigenvalues decide.
std::optional<int> Balances::count_negative(double det_sign) {
  const SparseMatrix& K = body_.tangent();
  if (!inertia_analysed_) inertia_.analyzePattern(K);
  inertia_analysed_ = true;
  inertia_.factorize(K);
  if (inertia_.info() == Eigen::Success) {
    const Vector D = inertia_.vectorD();
    const int count = static_cast<int>((D.array() < 0.0).count());
    if (D.allFinite() && (count % 2 == 1) == (det_sign < 0.0)) return count;
  }
  if (K.rows() > 1500) return {};
  return dense_count(K);
}

std::optional<Node> Balances::find(const Placement& from, const Vector& x, double df, Control control,
                                   double p) {
  ++nodes_;
  const Eigen::Index n = body_.unknowns().size();
  body_.restore(from);
  body_.move(x, from.load_factor + df);
  double last = std::numeric_limits<double>::infinity();
  bool done = false;
  for (int round = 0; round < 16 && !done; ++round) {
    const double residual = body_.residual(), enough = std::max(1e-10, 100 * body_.residual_of_rounding());
    if (!std::isfinite(residual) || (round > 2 && residual > 100 * last)) return {};
    done = round > 0 && residual <= enough && (residual > 0.3 * last || residual < 1e-14);
    last = residual;
    if (!factor(control)) return {};
    if (done) break;
    Vector b(n + 1);
    b.head(n) = body_.unbalanced();
    b[n] = p - value(control);
    const Vector step = bordered_.solve(b);
    if (!step.allFinite() || body_.largest_bond_change(step.head(n)) > 0.7) return {};
    body_.move(step.head(n), body_.load_factor() + step[n]);
  }
  if (!done) return {};
  Vector b = Vector::Zero(n + 1);
  b[n] = 1.0;
  const Vector rate = bordered_.solve(b);
  if (!rate.allFinite()) return {};
  const double det_sign = bordered_.signDeterminant() * (rate[n] < 0.0 ? -1.0 : 1.0);
  const std::optional<int> negative = count_negative(det_sign);
  if (!negative) return {};
  return Node{body_.placement(), p, rate.head(n), rate[n], *negative};
}

std::optional<double> Balances::eigenvalue(const Node& node, int j) {
  body_.restore(node.at);
  const SparseMatrix& K = body_.tangent();
  const int n = static_cast<int>(K.rows()),
            from_zero = j <= node.negative ? node.negative - j : j - node.negative - 1;
  const bool below = j <= node.negative;
  const auto pick = [&](const Vector& all) -> std::optional<double> {
    std::vector<double> side;
    for (const double v : all)
      if ((v < 0.0) == below) side.push_back(std::abs(v));
    std::sort(side.begin(), side.end());
    if (side.size() <= static_cast<std::size_t>(from_zero)) return {};
    return below ? -side[static_cast<std::size_t>(from_zero)] : side[static_cast<std::size_t>(from_zero)];
  };
  for (const int wanted : {2 * from_zero + 2, 4 * from_zero + 6}) {
    const int block = wanted + 4;
    if (block > n / 2) break;
    if (const auto values = next_to_zero(K, wanted, block))
      if (const auto value = pick(values->head(wanted))) return value;
  }
  if (n > 1500) return {};
  return pick(dense_eigenvalues(K).values);
}

double Balances::largest_stiffness() const {
  return body_.tangent().diagonal().cwiseAbs().maxCoeff();
}

}  // namespace vbond::campaign
