#include "vbond/statics/detail/by_multigrid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/statics/detail/gmres.hpp"
#include "vbond/statics/detail/gradients.hpp"

namespace vbond {
namespace {

constexpr double most_gradients = 1000;
/// Lowest eigenpairs are known to this residual, over the larger of the eigenvalue and a tenth of the
/// largest that is looked at: values then to its square.
constexpr LowestWanted lowest_wanted{1, 1e-6, 0.1, 500};

double largest_diagonal_of(const SparseMatrix& A) {
  return max_norm(A.diagonal());
}

/// What rounding leaves of b - A x, or of A x - lambda x for an x of length 1.
double rounding_of_product(const SparseMatrix& A, double length) {
  return 16.0 * epsilon * largest_diagonal_of(A) * length;
}

}  // namespace

void ByMultigrid::take(const StaticBody& body, double shift) {
  body_ = &body;
  A_ = &body.tangent();
  shift_ = shift;
  fresh_ = false;
  lowest_.reset();
}

void ByMultigrid::make(double shift) {
  preconditioner_.make(*A_, shift, body_->unknowns(), body_->state().r);
  made_shift_ = shift;
  made_for_ = shift_;
  first_price_ = price_ = 0.0;
  fresh_ = true;
}

bool ByMultigrid::is_due() const {
  return !preconditioner_.at_hand() || made_for_ != shift_ || (!fresh_ && price_ > 2.0 * first_price_);
}

/// With the lowest eigenvalue below zero, or near it beside the others, one that makes it one of them.
double ByMultigrid::shift_known_to_do() const {
  if (shift_ > 0.0 || known_.size() == 0) return shift_;
  const double lowest = known_[0], others = max_norm(known_);
  return lowest > 0.1 * others ? 0.0 : 2.0 * std::abs(lowest) + 0.2 * others;
}

/// The same from rough eigenvectors.
double ByMultigrid::shift_for(const DenseMatrix& modes) const {
  const Vector stiffness =
      (modes.cwiseProduct(*A_ * modes).colwise().sum().array() / modes.colwise().squaredNorm().array())
          .matrix()
          .transpose();
  const double least = stiffness.minCoeff(), others = max_norm(stiffness);
  return least > 0.1 * others ? least : 2.0 * std::abs(least) + 0.2 * others;
}

DenseMatrix ByMultigrid::solutions(const DenseMatrix& R) const {
  DenseMatrix X(R.rows(), R.cols());
  for (Eigen::Index k = 0; k < R.cols(); ++k) X.col(k) = inverse(R.col(k));
  return X;
}

Vector ByMultigrid::times(const Vector& p) const {
  Vector y = A_->transpose() * p;  // symmetric: rows are quicker
  if (shift_ > 0.0) y += shift_ * p;
  return y;
}

Vector ByMultigrid::solve(const Vector& b, double accuracy) {
  if (is_due()) make(shift_);
  if (std::optional<Vector> x = gradients(b, accuracy)) return std::move(*x);
  if (fresh_ && made_shift_ == shift_) return {};
  make(shift_);
  return gradients(b, accuracy).value_or(Vector());
}

std::optional<Vector> ByMultigrid::gradients(const Vector& b, double accuracy) {
  GradientsMade made;
  const std::optional<Vector> x = conjugate_gradients([this](const Vector& p) { return times(p); },
                                                      [this](const Vector& r) { return inverse(r); }, b,
                                                      {0.0, accuracy}, most_gradients, &made);
  iterations_ += static_cast<int>(made.alpha.size());
  if (x && made.left < 1.0) price_ = static_cast<double>(made.alpha.size()) / -std::log10(made.left);
  if (first_price_ == 0.0) first_price_ = price_;
  return x;
}

// x = V c + y, y normal to the eigenvectors V. What their residuals leave between the two is small, of second
// order, and goes with the rounds.
Vector ByMultigrid::solve_beside(const Vector& b, Eigen::Index first, Eigen::Index null, double accuracy) {
  constexpr int rounds = 12;
  constexpr double part_of_round = 1e-8;
  const Lowest& lowest = *lowest_;
  const DenseMatrix& V = lowest.vectors;
  const auto N = V.middleCols(first, null);
  const auto normal = [&V](const Vector& x) -> Vector { return x - V * (V.transpose() * x); };
  const auto without_null = [&N](const Vector& r) -> Vector { return r - N * (N.transpose() * r); };
  Vector amplitude = lowest.values.cwiseInverse();
  amplitude.segment(first, null).setZero();
  Vector x = Vector::Zero(b.size()), r = without_null(b);
  const double size = r.norm();
  double left = size;
  for (int round = 0; left > larger(accuracy * size, rounding_of_product(*A_, x.norm())); ++round) {
    GradientsMade made;
    Vector next = x + V * amplitude.cwiseProduct(V.transpose() * r);
    const std::optional<Vector> y =
        conjugate_gradients([&](const Vector& p) { return normal(times(p)); },
                            [&](const Vector& p) { return normal(inverse(normal(p))); },
                            normal(b - times(next)), {0.0, part_of_round}, most_gradients, &made);
    iterations_ += static_cast<int>(made.alpha.size());
    if (!y) {
      const bool ended = static_cast<double>(made.alpha.size()) >= most_gradients;
      if (ended) give_up("conjugate gradients", left / size, accuracy);
      throw NoConvergence(
          "multigrid: the tangent has more negative eigenvalues than were found; solver = \"direct\" counts "
          "them");
    }
    next += *y;
    Vector next_r = without_null(b - times(next));
    const double now = next_r.norm();
    const bool gains = now < 0.5 * left;
    if (now < left) x = std::move(next), r = std::move(next_r), left = now;
    if (!gains || round == rounds) break;
  }
  const double enough = larger(accuracy * size, 100.0 * rounding_of_product(*A_, x.norm()));
  if (!(left <= enough)) give_up("conjugate gradients", left / size, accuracy);
  return x;
}

Vector ByMultigrid::solve_any(const Vector& b, double accuracy) {
  if (!lowest_) {
    Vector x = solve(b, accuracy);
    if (x.size() > 0 || shift_ > 0.0) return x;
  }
  lowest();
  return solve_beside(b, 0, 0, accuracy);
}

Vector ByMultigrid::solve_full(const Vector& b, double accuracy) {
  constexpr int basis = 60, most_gmres = 300;
  const SparseMatrix K = body_->full_tangent();
  if (is_due()) make(shift_known_to_do());
  const auto roughly = [this](const Vector& r) -> Vector {
    if (!lowest_) return inverse(r);
    const DenseMatrix& V = lowest_->vectors;
    const Vector along = V.transpose() * r, z = inverse(r - V * along);
    return z + V * (along.cwiseQuotient(lowest_->values) - V.transpose() * z);
  };
  const double size = b.norm();
  for (int most = fresh_ ? most_gmres : basis;; most = most_gmres) {
    const Gmres g =
        gmres([&K](const Vector& p) -> Vector { return K * p; }, roughly, b, accuracy* size, basis, most);
    iterations_ += g.iterations;
    if (g.left <= larger(accuracy * size, 100.0 * rounding_of_product(*A_, g.x.norm()))) return g.x;
    if (fresh_) return {};
    make(shift_known_to_do());
  }
}

void ByMultigrid::give_up(const char* what, double left, double wanted) const {
  throw NoConvergence(fmt::format(
      "multigrid: {} ends at a residual of {:.2g} of the right-hand side, not at the {:.2g} asked for; "
      "solver = \"direct\" does without iteration",
      what, left, wanted));
}

namespace {

DenseMatrix all_vectors(const Lowest& l) {
  DenseMatrix all(l.vectors.rows(), l.vectors.cols() + l.guards.cols());
  all << l.vectors, l.guards;
  return all;
}

}  // namespace

/// One search with the preconditioner as it is.
Lowest ByMultigrid::look(const LowestProblem& problem, LowestWanted wanted, const DenseMatrix& start,
                         int most) {
  wanted.iterations = most;
  Lowest found = lowest_eigenpairs(problem, wanted, start);
  iterations_ += found.iterations;
  return found;
}

/// With the preconditioner at hand as long as it does, then with one of this tangent, with a shift where it
/// would not be definite.
Lowest ByMultigrid::search(const LowestProblem& problem, const LowestWanted& wanted,
                           const DenseMatrix& start) {
  constexpr int enough_for_old = 12;
  const double size = largest_diagonal_of(*A_);
  const bool singular = problem.without && problem.without->cols() > 0;
  if (is_due() && !singular) make(shift_known_to_do());
  DenseMatrix begin = start;
  if (preconditioner_.at_hand() && made_shift_ >= (singular ? 1e-300 : 0.0)) try {
      Lowest found = look(problem, wanted, begin, fresh_ ? wanted.iterations : enough_for_old);
      if (found.why_not.empty()) return found;
      begin = all_vectors(found);
      if (!fresh_) {
        make(std::max(shift_for(begin), 0.0));
        found = look(problem, wanted, begin, wanted.iterations);
        if (found.why_not.empty()) return found;
        begin = all_vectors(found);
      }
    } catch (const InverseNotDefinite&) {
    }
  for (double by = 1e-6 * size;; by *= 100.0) try {
      make(by);
      begin = all_vectors(look(problem, {wanted.count, 0.1, 1.0}, begin, 60));
      if (const double shift = shift_for(begin); shift < made_shift_) make(shift);
      Lowest found = look(problem, wanted, begin, wanted.iterations);
      if (found.why_not.empty()) return found;
      if (!(by < size)) throw NoConvergence(found.why_not + "; solver = \"direct\" does without iteration");
      begin = all_vectors(found);
    } catch (const InverseNotDefinite&) {
      if (!(by < size)) throw;
    }
}

const Lowest& ByMultigrid::lowest(int count, int most) {
  const auto size = static_cast<int>(A_->rows());
  const auto goes_beyond_zero = [](const Lowest& l) {
    return l.size() > 0 && l.values[l.size() - 1] > l.errors[l.size() - 1];
  };
  LowestWanted wanted = lowest_wanted;
  wanted.count = std::max(count, 1 + static_cast<int>((known_.array() <= 0.0).count()));
  if (lowest_) wanted.count = std::max(wanted.count, lowest_->size());
  for (;; wanted.count *= 2) {
    wanted.count = std::min({wanted.count, std::max(count, most), size});
    if (!lowest_ || lowest_->size() < wanted.count) {
      LowestProblem problem;
      problem.size = A_->rows();
      problem.times = [this](const DenseMatrix& X) -> DenseMatrix { return A_->transpose() * X; };
      problem.inverse = [this](const DenseMatrix& R) { return solutions(R); };
      problem.rounding = rounding_of_product(*A_, 1.0);
      lowest_ = search(problem, wanted, kept_);
      known_ = lowest_->values;
      kept_ = all_vectors(*lowest_);
    }
    if (goes_beyond_zero(*lowest_) || wanted.count >= std::min(std::max(count, most), size)) return *lowest_;
  }
}

Lowest ByMultigrid::lowest_of(const LowestProblem& problem, const LowestWanted& wanted) {
  return search(problem, wanted, {});
}

}  // namespace vbond
