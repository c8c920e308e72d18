// Equations with the whole tangent, which is not symmetric where outside moments act or bonds flow.
#include <Eigen/IterativeLinearSolvers>
#include <cmath>
#include <vector>

#include "vbond/statics/detail/newton.hpp"

namespace vbond {
namespace {

/// Lets the factor of the symmetric part precondition the full tangent.
class FactorPreconditioner {
 public:
  using MatrixType = SparseMatrix;
  void use(const Factor& factor) { factor_ = &factor; }
  template <class M>
  FactorPreconditioner& analyzePattern(const M&) {
    return *this;
  }
  template <class M>
  FactorPreconditioner& factorize(const M&) {
    return *this;
  }
  template <class M>
  FactorPreconditioner& compute(const M&) {
    return *this;
  }
  template <class B>
  Vector solve(const B& b) const {
    return factor_->solve(b);
  }
  Eigen::ComputationInfo info() const { return Eigen::Success; }

 private:
  const Factor* factor_ = nullptr;
};

/// Columns of A as entries, for a larger matrix.
std::vector<Eigen::Triplet<double>> entries_of(const SparseMatrix& A) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(A.nonZeros() + 2 * A.rows() + 1));
  for (int k = 0; k < A.outerSize(); ++k)
    for (SparseMatrix::InnerIterator it(A, k); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(it.col()), it.value());
  return entries;
}

/// The tangent with a stiffness for each unknown that has none and moves nothing else, as the place of a
/// grain on a floor, or of one that has come off: where nothing loads them, solutions leave them alone.
SparseMatrix with_idle_held(SparseMatrix K) {
  Vector entries = Vector::Zero(K.rows());
  for (int k = 0; k < K.outerSize(); ++k)
    for (SparseMatrix::InnerIterator it(K, k); it; ++it) {
      entries[it.row()] += std::abs(it.value());
      entries[k] += std::abs(it.value());
    }
  const double stiffness = max_norm(K.diagonal());
  for (Eigen::Index k = 0; k < entries.size(); ++k)
    if (entries[k] == 0.0) K.coeffRef(k, k) = stiffness;
  return K;
}

}  // namespace

bool TangentSolver::take_full(const StaticBody& body) {
  prepare(body);
  if (!factors_full(body)) return take(body);
  if (full_at_ != body.placement_number()) {
    full_is_regular_ = full_.factor(with_idle_held(body.full_tangent()));
    full_at_ = body.placement_number();
  }
  return full_is_regular_;
}

Vector TangentSolver::solve_full(const StaticBody& body, const Vector& b, double accuracy) {
  if (!body.is_unsymmetric()) return solve(b, accuracy);
  if (multigrid_) {
    Vector x = multigrid_->solve_full(b, accuracy);
    return x.size() > 0 ? x : solve(b, accuracy);  // as below
  }
  if (body.has_moment_part()) return take_full(body) ? full_.solve(b) : Vector();
  return solve_by_iteration(body, b);
}

/// Of bonds that flow: most of their tangent is symmetric.
Vector TangentSolver::solve_by_iteration(const StaticBody& body, const Vector& b) {
  const SparseMatrix K = body.full_tangent();
  Eigen::BiCGSTAB<SparseMatrix, FactorPreconditioner> method;
  method.preconditioner().use(factor_);
  method.setTolerance(1e-13);
  method.setMaxIterations(200);
  method.compute(K);
  const Vector x = method.solve(b);
  // otherwise with the symmetric part alone: corrections are then less good, but what is out of balance
  // judges them
  return method.error() < 1e-6 ? x : solve(b);
}

// The last column is scaled to the size of the tangent's diagonal, so that the pivots compare.
bool TangentSolver::take_bordered(const StaticBody& body, const Bordered& border) {
  prepare(body);
  const SparseMatrix K = with_idle_held(body.full_tangent());
  const int n = static_cast<int>(K.rows());
  const double force = max_norm(border.g), stiffness = max_norm(K.diagonal());
  per_factor_ = force > 0.0 && stiffness > 0.0 ? stiffness / force : 1.0;
  std::vector<Eigen::Triplet<double>> entries = entries_of(K);
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k, n, -per_factor_ * border.g[k]);
    entries.emplace_back(n, k, border.n[k]);
  }
  entries.emplace_back(n, n, per_factor_ * border.w);
  SparseMatrix A(n + 1, n + 1);
  A.setFromTriplets(entries.begin(), entries.end());
  return bordered_.factor(A);
}

Vector TangentSolver::solve_bordered(const Vector& R, double c) const {
  Vector b(R.size() + 1);
  b << R, c;
  Vector x = bordered_.solve(b);
  x[R.size()] *= per_factor_;
  return x;
}

}  // namespace vbond
