#include "vbond/statics/detail/kept_factor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/core/memory.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/single_kernel.hpp"

namespace vbond {
namespace {

/// Iterations that were needed more than if each left a hundredth, as where M is A but for small movements.
double needless_iterations(const GradientsMade& made) {
  const double iterations = static_cast<double>(made.alpha.size());
  return std::max(0.0, iterations - std::log(made.left) / std::log(0.01));
}

/// An upper bound of the largest eigenvalue of D^-1/2 M D^-1/2 (Gershgorin), by the root of D.
double largest_scaled_row(const SparseMatrix& M, const Vector& root) {
  double largest = 0.0;
  for (int j = 0; j < M.outerSize(); ++j) {
    double sum = 0.0;
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) sum += std::abs(it.value()) / root[it.row()];
    largest = larger(largest, sum / root[j]);
  }
  return largest;
}

/// Calls work(from, to) for pieces of so many rows, in each thread for its own.
template <class Work>
void for_pieces(Eigen::Index rows, Crew& crew, Work work) {
  const auto number = static_cast<Eigen::Index>(crew.count());
  crew.for_each([&](std::size_t thread) {
    const auto k = static_cast<Eigen::Index>(thread);
    work(k * rows / number, (k + 1) * rows / number);
  });
}

/// A p of a symmetric matrix.
Vector product(const SparseMatrix& A, const Vector& p, Crew& crew) {
  Vector y(p.size());
  for_pieces(A.outerSize(), crew, [&](Eigen::Index from, Eigen::Index to) {
    for (Eigen::Index k = from; k < to; ++k) {
      double sum = 0.0;
      for (SparseMatrix::InnerIterator it(A, k); it; ++it) sum += it.value() * p[it.row()];
      y[k] = sum;
    }
  });
  return y;
}

/// The same, all columns in one pass over A: row by row, four numbers at a time.
DenseMatrix product(const SparseMatrix& A, const DenseMatrix& P, Crew& crew) {
  using Four = Eigen::Vector4d;
  DenseMatrix Y(P.rows(), P.cols()), rows = DenseMatrix::Zero(4, P.rows());
  for (Eigen::Index first = 0; first < P.cols(); first += 4) {
    const Eigen::Index columns = std::min<Eigen::Index>(4, P.cols() - first);
    rows.topRows(columns) = P.middleCols(first, columns).transpose();
    for_pieces(A.outerSize(), crew, [&](Eigen::Index from, Eigen::Index to) {
      for (Eigen::Index k = from; k < to; ++k) {
        Four sum = Four::Zero();
        for (SparseMatrix::InnerIterator it(A, k); it; ++it)
          sum += it.value() * Eigen::Map<const Four>(&rows(0, it.row()));
        Y.row(k).segment(first, columns) = sum.head(columns).transpose();
      }
    });
  }
  return Y;
}

/// Unknowns whose own stiffness in A is much more or less than in M, and those with which they share that, in
/// their order. m: the diagonal of M.
std::vector<int> changed_unknowns(const SparseMatrix& A, const SparseMatrix& M, const Vector& m) {
  constexpr double much = 0.01;  // one of ten contacts of a grain has a thirtieth along some axis
  const Vector a = A.diagonal();
  std::vector<char> changed(static_cast<std::size_t>(m.size()), 0);
  std::vector<int> unknowns;
  for (int j = 0; j < A.outerSize(); ++j) {
    if (!(std::abs(a[j] - m[j]) > much * m[j])) continue;
    changed[static_cast<std::size_t>(j)] = 1;
    const auto look = [&](int i, double change) {
      if (std::abs(change) > much * std::sqrt(m[i] * m[j])) changed[static_cast<std::size_t>(i)] = 1;
    };
    SparseMatrix::InnerIterator of_M(M, j);
    for (SparseMatrix::InnerIterator of_A(A, j); of_A; ++of_A) {
      for (; of_M && of_M.row() < of_A.row(); ++of_M) look(static_cast<int>(of_M.row()), of_M.value());
      const bool both = of_M && of_M.row() == of_A.row();
      look(static_cast<int>(of_A.row()), of_A.value() - (both ? of_M.value() : 0.0));
      if (both) ++of_M;
    }
    for (; of_M; ++of_M) look(static_cast<int>(of_M.row()), of_M.value());
  }
  for (int k = 0; k < static_cast<int>(changed.size()); ++k)
    if (changed[static_cast<std::size_t>(k)] != 0) unknowns.push_back(k);
  return unknowns;
}

}  // namespace

void KeptFactor::begin(const SparseMatrix& A) {
  at_hand_ = true;
  random_as_made_ = random_;
  M_ = A;
  diagonal_ = M_.diagonal();
  changes_.clear();
  constexpr double largest_share = 0.5;  // of the memory, for the factor without the copy of half its size
  const bool has_room = factor_.bytes() <= largest_share * memory_limit();
  in_single_ = has_room && factor_.copy_to(single_) && single_is_near();
  kappa_ = 0.0;
  proofs_ = 0;
  price_ = 1.0;
  spent_ = in_cycle_ = slow_ = wasted_ = recent_ = 0.0;
}

// Of a random side, which has something of all movements: what M leaves of a solution with the rounded
// factor, in the norm of that, in which soft movements count as much as others.
bool KeptFactor::single_is_near() {
  constexpr double near = 1e-3;  // less than what movements do as a rule
  const Vector r = random_side(), x = single_.solve(r), left = r - M_ * x;
  return left.dot(single_.solve(left).col(0)) <= near * near * r.dot(x);
}

/// That M is of the rounded factor adds to it.
double KeptFactor::kappa() {
  if (kappa_ > 0.0) return kappa_;
  kappa_ = largest_scaled_row(M_, diagonal_.cwiseSqrt());
  if (in_single_) kappa_ += SingleFactor::difference() * static_cast<double>(M_.rows());
  return kappa_;
}

void KeptFactor::drop() {
  at_hand_ = false;
  changes_.clear();
}

bool KeptFactor::is_due() const {
  return slow_ > patience() || (proofs_ > 0 && recent_ * proofs_ > cost_of_factor() + wasted_);
}

double KeptFactor::patience() const {
  return std::max(30.0, cost_of_factor());
}

double KeptFactor::cost_of_factor() const {
  return (in_single_ ? 2.0 : 1.0) * factor_.cost_in_solutions();
}

/// Of a solution for so many columns. Measured: four take 1.6 times as long as one, and so on.
double KeptFactor::price_of(Eigen::Index columns) const {
  return price_ * (1.0 + 0.2 * static_cast<double>(columns - 1));
}

void KeptFactor::follow(const std::vector<int>& unknowns, DenseMatrix change) {
  constexpr double least_part = 1e-3;
  follow(unknowns, std::move(change), least_part);
}

void KeptFactor::follow(const SparseMatrix& A) {
  constexpr double least_part = 0.03;  // a contact has one part, and movement of all around it adds to it
  constexpr std::size_t most = 120;    // unknowns: where more change iteration does, or a new factor
  const std::vector<int> unknowns = changed_unknowns(A, M_, diagonal_);
  if (unknowns.empty() || unknowns.size() > most) return;
  const auto at = [&unknowns](Eigen::Index k) { return unknowns[static_cast<std::size_t>(k)]; };
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  DenseMatrix change(size, size);
  for (Eigen::Index j = 0; j < size; ++j)
    for (Eigen::Index i = 0; i < size; ++i) change(i, j) = A.coeff(at(i), at(j)) - M_.coeff(at(i), at(j));
  follow(unknowns, std::move(change), least_part);
}

void KeptFactor::follow(const std::vector<int>& unknowns, DenseMatrix change, double least_part) {
  const auto at = [&unknowns](Eigen::Index k) { return unknowns[static_cast<std::size_t>(k)]; };
  const Eigen::Index size = change.rows();
  const DenseEigen parts = dense_eigenpairs(change);
  if (!parts.found || !parts.values.allFinite()) return drop();
  std::vector<Eigen::Index> large;
  const double least = least_part * max_norm(parts.values);
  for (Eigen::Index k = 0; k < size; ++k)
    if (std::abs(parts.values[k]) > least) large.push_back(k);
  if (large.empty()) return;

  Change c{unknowns, parts.vectors(Eigen::all, large), {}, {}, std::move(change), least_part};
  const Vector values = parts.values(large);
  DenseMatrix Q = DenseMatrix::Zero(M_.rows(), c.Q.cols());
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
  for (Eigen::Index k = 0; k < size; ++k) diagonal_[at(k)] += followed(k, k);
  kappa_ = 0.0;
  price_ += static_cast<double>(c.Z.size()) * sizeof(double) / ((in_single_ ? 1.0 : 2.0) * factor_.bytes());
  in_cycle_ += price_of(c.Z.cols());
  changes_.push_back(std::move(c));
}

KeptFactorUnderWay KeptFactor::under_way() const {
  KeptFactorUnderWay now;
  for (const Change& c : changes_)
    now.changes.push_back({{c.unknowns.begin(), c.unknowns.end()},
                           {c.given.data(), c.given.data() + c.given.size()},
                           c.least_part});
  now.random_as_made = random_as_made_, now.random = random_;
  now.proofs = proofs_, now.spent = spent_, now.in_cycle = in_cycle_;
  now.slow = slow_, now.wasted = wasted_, now.recent = recent_;
  return now;
}

bool KeptFactor::go_on_from(const SparseMatrix& A, const KeptFactorUnderWay& then) {
  random_ = then.random_as_made;
  begin(A);
  for (const KeptFactorUnderWay::Change& c : then.changes) {
    const auto size = static_cast<Eigen::Index>(c.unknowns.size());
    follow(std::vector<int>(c.unknowns.begin(), c.unknowns.end()),
           Eigen::Map<const DenseMatrix>(c.numbers.data(), size, size), c.least_part);
    if (!at_hand_) return false;
  }
  draw_on_from(then.random);
  proofs_ = static_cast<int>(then.proofs);
  spent_ = then.spent, in_cycle_ = then.in_cycle;
  slow_ = then.slow, wasted_ = then.wasted, recent_ = then.recent;
  return true;
}

DenseMatrix KeptFactor::solve_kept(const DenseMatrix& B) const {
  DenseMatrix X = in_single_ ? single_.solve(B) : factor_.solve_columns(B);
  for (const Change& c : changes_) {
    const DenseMatrix part = c.inner * (c.Q.transpose() * X(c.unknowns, Eigen::all));
    for (Eigen::Index first = 0; first < X.cols(); first += most_sides) {
      const Eigen::Index sides = std::min<Eigen::Index>(most_sides, X.cols() - first);
      const DenseMatrix by_rows = part.middleCols(first, sides).transpose();
      for_pieces(X.rows(), *crew_, [&](Eigen::Index from, Eigen::Index to) {
        single_kernel().subtract_product[sides - 1](c.Z.data() + from, to - from,
                                                    static_cast<int>(part.rows()), by_rows.data(),
                                                    X.data() + first * X.rows() + from, X.rows());
      });
    }
  }
  return X;
}

std::optional<Vector> KeptFactor::solve(const SparseMatrix& A, const Vector& b, double accuracy) {
  const auto times = [&](const Vector& p) -> Vector { return product(A, p, *crew_); };
  const auto inverse = [this](const Vector& v) -> Vector {
    in_cycle_ += price_;
    return solve_kept(v);
  };
  GradientsMade made;
  std::optional<Vector> x = conjugate_gradients(times, inverse, b, {0.0, accuracy}, patience(), &made);
  slow_ += needless_iterations(made);
  return x;
}

std::optional<DenseMatrix> KeptFactor::gradients(const SparseMatrix& A, const DenseMatrix& B,
                                                 const DenseMatrix& X, const std::vector<Enough>& enough,
                                                 std::vector<GradientsMade>* made) {
  const auto times = [&](const DenseMatrix& P) -> DenseMatrix { return product(A, P, *crew_); };
  const auto inverse = [this](const DenseMatrix& R) -> DenseMatrix {
    in_cycle_ += price_of(R.cols());
    return solve_kept(R);
  };
  return conjugate_gradients_of_columns(times, inverse, B, X, enough, patience(), made);
}

std::optional<DenseMatrix> KeptFactor::solve_columns(const SparseMatrix& A, const DenseMatrix& B,
                                                     const DenseMatrix& X, double accuracy) {
  const std::vector<Enough> enough(static_cast<std::size_t>(B.cols()), Enough{0.0, accuracy});
  return gradients(A, B, X, enough, nullptr);
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
  return r.cwiseProduct(diagonal_.cwiseSqrt());
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
  return solve_if_definite(A, Vector(), 1.0).has_value();
}

std::optional<Vector> KeptFactor::solve_if_definite(const SparseMatrix& A, const Vector& b, double accuracy) {
  constexpr Eigen::Index sides = 3;
  constexpr double delta = 1e-3;  // of each
  constexpr double soft = 1e-3;   // so much softer than M along some movement: let a factor judge
  const Eigen::Index others = b.size() > 0 ? 1 : 0;
  DenseMatrix B(A.rows(), sides + others);
  for (Eigen::Index k = 0; k < sides; ++k) B.col(k) = random_side();
  std::vector<Enough> enough(sides, Enough{delta / std::sqrt(kappa()), 0.0});
  if (others > 0) B.col(sides) = b, enough.push_back({0.0, accuracy});
  std::vector<GradientsMade> made;
  const std::optional<DenseMatrix> X = gradients(A, B, DenseMatrix(), enough, &made);
  double needed = 1.0;
  for (const GradientsMade& m : made)
    if (!m.alpha.empty())
      needed = std::min(needed, 1.0 - needless_iterations(m) / static_cast<double>(m.alpha.size()));
  spent_ += in_cycle_;
  constexpr double weight = 0.25;  // after a break more are needed than after a step: a mean over some proofs
  const double wasted = (1.0 - needed / price_) * std::exchange(in_cycle_, 0.0);
  slow_ = 0.0;
  wasted_ += wasted;
  recent_ += (proofs_++ == 0 ? 1.0 : weight) * (wasted - recent_);
  if (!X) return {};
  for (std::size_t k = 0; k < sides; ++k)
    if (!(smallest_ritz_value(made[k]) > soft)) return {};
  return others > 0 ? Vector(X->col(sides)) : Vector();
}

}  // namespace vbond
