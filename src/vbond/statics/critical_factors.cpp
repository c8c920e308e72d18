#include <cmath>
#include <optional>

#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/eigen_search.hpp"
#include "vbond/statics/detail/lanczos.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {
namespace {

/// How far beyond the critical factor of smallest size others are looked for.
constexpr double factor_range = 1e4;

// Where Lanczos looks from: this part of the way to the first critical factor, which is known roughly then.
// Factors that lie close together, as those of shells do, are told apart from there in few iterations.
constexpr double way_to_first = 0.98;
constexpr double rough = 1e-3;  // residual, as a part of theta: theta itself is off by its square, or by it

/// y -> -scale L^-1 B L^-T y, with (A + sigma B) = L L^T. Its eigenvalues are scale / (mu - sigma). Those
/// whose vectors y are known count as 0.
struct LoadOperator {
  void operator()(const double* in, double* out) const {
    Pulse::may_end();
    const Eigen::Map<const Vector> y(in, B.rows());
    Vector z = -scale * factor.half_solve(B * factor.other_half_solve(y));
    if (known.cols() > 0) z -= known * theta.cwiseProduct(known.transpose() * y);
    Eigen::Map<Vector>(out, B.rows()) = z;
  }
  const SparseMatrix& B;
  const Factor& factor;
  double scale;
  DenseMatrix known;
  Vector theta;
};

/// Looks for mu > sigma with (A + mu B) x = 0.
class FactorSearch {
 public:
  FactorSearch(const SparseMatrix& A, const SparseMatrix& B, Factor& factor)
      : A_(A), B_(B), factor_(factor), scale_(largest_diagonal(A) / B.coeffs().cwiseAbs().maxCoeff()) {}

  /// Roughly the mu of smallest size.
  double nearest() const {
    return scale_ /
           lanczos(A_.rows(), LoadOperator{B_, factor_, scale_, {}, {}}, Largest::size, 1, rough).values[0];
  }

  /// Goes near to the first mu > 0, which must exist.
  void approach() {
    const double first =
        scale_ /
        lanczos(A_.rows(), LoadOperator{B_, factor_, scale_, {}, {}}, Largest::value, 1, rough).values[0];
    double sigma = way_to_first * first;
    for (int k = 0; k < 40 && std::isfinite(sigma) && sigma > 0.0; ++k, sigma *= 0.9)
      if (factor_.factor_definite(A_ + sigma * B_)) {
        sigma_ = sigma;
        scale_ = first - sigma;
        return;
      }
    if (!factor_.factor_definite(A_))
      throw NoConvergence("critical factors: the matrix is not positive definite to rounding");
  }

  /// Adds the next ones, as pairs (mu, x), and keeps their y.
  void look(int count, Found& found) {
    const auto [theta, y] = lanczos(A_.rows(), LoadOperator{B_, factor_, scale_, known_, theta_},
                                    Largest::value, count, tolerance_of_vectors);
    for (Eigen::Index k = 0; k < theta.size(); ++k) {
      const double mu = sigma_ + scale_ / theta[k];
      const Vector x = factor_.other_half_solve(y.col(k));
      found.add(mu, mu, x / std::sqrt(x.dot(A_ * x)));
    }
    const Eigen::Index before = known_.cols();
    known_.conservativeResize(A_.rows(), before + y.cols());
    known_.rightCols(y.cols()) = y;
    theta_.conservativeResize(before + y.cols());
    theta_.tail(y.cols()) = theta;
  }

 private:
  const SparseMatrix &A_, &B_;
  Factor& factor_;
  double scale_, sigma_ = 0.0;  // scale: some eigenvalue of the operator is not far below 1
  DenseMatrix known_;
  Vector theta_;
};

EigenPairs dense_factors(const SparseMatrix& A, const SparseMatrix& B, int count) {
  const DenseEigen all = dense_eigenpairs(-DenseMatrix(B), DenseMatrix(A));
  const Vector& theta = all.values;
  const double smallest = theta.cwiseAbs().maxCoeff() / factor_range;
  Found found;
  for (Eigen::Index k = theta.size() - 1; k >= 0 && theta[k] > smallest; --k)
    found.add(1.0 / theta[k], 1.0 / theta[k], all.vectors.col(k));
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
    throw NoConvergence("critical factors: the matrix is not positive definite to rounding");
  if (!(largest_B > 0.0)) return {Vector(0), DenseMatrix(n, 0)};
  if (solve_densely(n, count)) return dense_factors(A, B, count);
  FactorSearch search(A, B, factor);
  const double largest = factor_range * std::abs(search.nearest());
  Factor counter;
  counter.analyse(A + B);
  const auto number_below = [&](double mu) { return counter.factor_indefinite(A + mu * B); };
  const std::optional<int> available = number_below(largest);
  if (!available) throw NoConvergence("critical factors: they cannot be counted");
  if (*available > 0) search.approach();
  return find_counted(
      Wanted{count, *available, 0.0, 0.0}, [&](int k, Found& found) { search.look(k, found); }, number_below);
}

}  // namespace vbond
