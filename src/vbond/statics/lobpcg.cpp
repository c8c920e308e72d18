#include "vbond/statics/detail/lobpcg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vbond/statics/detail/deflated.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/eigen_search.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {
namespace {

DenseMatrix side_by_side(const DenseMatrix& A, const DenseMatrix& B) {
  DenseMatrix both(A.rows(), A.cols() + B.cols());
  both << A, B;
  return both;
}

/// One search. X are the vectors so far, P the directions in which they moved last.
class LowestSearch {
 public:
  LowestSearch(const LowestProblem& problem, const LowestWanted& wanted, const DenseMatrix& start)
      : problem_(problem), wanted_(wanted), X_(begin(start)) {
    turn_to_lowest(DenseMatrix(X_.rows(), 0), DenseMatrix(X_.rows(), 0));
  }

  Lowest run() {
    for (int k = 0;; ++k) {
      Pulse::may_end();
      const DenseMatrix BX = metric(X_), R = AX_ - BX * values_.asDiagonal();
      const Vector left = (R.colwise().norm().array() / BX.colwise().norm().array()).matrix().transpose();
      if (is_enough(left)) {
        if (std::exchange(exact_, true)) return found(left, k);
        AX_ = problem_.times(X_);  // sums of products drift: once more with what it really is
        continue;
      }
      if (k == wanted_.iterations) {
        Lowest rough = found(left, k);
        rough.why_not = why_not(left);
        return rough;
      }
      exact_ = false;
      turn_to_lowest(ways_down(R, left), P_);
    }
  }

 private:
  DenseMatrix metric(const DenseMatrix& X) const { return problem_.metric ? problem_.metric(X) : X; }

  void leave_out(DenseMatrix& X) const {
    if (problem_.without && problem_.without->cols() > 0)
      X -= *problem_.without * DenseMatrix(problem_.without->transpose() * metric(X));
  }
  /// Orthonormal in the metric, without what depends on other columns (Stathopoulos and Wu, SIAM J. Sci.
  /// Comput. 23 (2002) 2165).
  DenseMatrix orthonormalised(DenseMatrix X) const {
    for (int twice = 0; twice < 2 && X.cols() > 0; ++twice) {
      DenseMatrix G = X.transpose() * metric(X);
      const Vector scale =
          G.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
      G = scale.asDiagonal() * G * scale.asDiagonal();
      const DenseEigen parts = dense_eigenpairs(0.5 * (G + G.transpose()));
      if (!parts.found) throw NoConvergence("eigenvalues: the matrix is not finite");
      const Eigen::Index kept = (parts.values.array() > 1e-13 * static_cast<double>(X.cols())).count();
      const Vector size = parts.values.tail(kept).cwiseSqrt().cwiseInverse();
      const DenseMatrix turn = scale.asDiagonal() * parts.vectors.rightCols(kept) * size.asDiagonal();
      X = X * turn;
    }
    return X;
  }
  /// The same, and normal to the orthonormal columns Y.
  DenseMatrix normal_to(const DenseMatrix& Y, DenseMatrix X) const {
    for (int twice = 0; twice < 2 && X.cols() > 0; ++twice) {
      leave_out(X);
      X -= Y * DenseMatrix(Y.transpose() * metric(X));
      X = orthonormalised(std::move(X));
    }
    return X;
  }

  DenseMatrix begin(const DenseMatrix& start) const {
    const Eigen::Index n = problem_.size, held = problem_.without ? problem_.without->cols() : 0;
    const Eigen::Index size = std::min<Eigen::Index>(n - held, wanted_.count + 2 + wanted_.count / 4);
    DenseMatrix X = start.leftCols(std::min(start.cols(), size));
    if (X.rows() != n) X.resize(n, 0);
    leave_out(X);
    X = orthonormalised(std::move(X));
    for (Eigen::Index more = size - X.cols(); more > 0; more = size - X.cols()) {
      DenseMatrix Z = normal_to(X, problem_.inverse(any_orthonormal_columns(n, size + 2)).rightCols(more));
      if (Z.cols() == 0) throw NoConvergence("eigenvalues: no vectors to begin with");
      X = side_by_side(X, Z);
    }
    return X;
  }

  double enough_for(Eigen::Index k) const {
    const double reference = larger(std::abs(values_[k]), wanted_.share * max_norm(values_));
    return larger(wanted_.tolerance * reference, problem_.rounding);
  }
  bool is_enough(const Vector& left) const {
    for (Eigen::Index k = 0; k < wanted_.count; ++k)
      if (!(left[k] <= enough_for(k))) return false;
    return true;
  }

  /// The rough inverse of what is left of those that are not found yet.
  DenseMatrix ways_down(const DenseMatrix& R, const Vector& left) const {
    std::vector<Eigen::Index> open;
    for (Eigen::Index k = 0; k < R.cols(); ++k)
      if (!(left[k] <= 0.1 * enough_for(k))) open.push_back(k);
    const DenseMatrix rest = R(Eigen::all, open);
    DenseMatrix W = problem_.inverse(rest);
    for (Eigen::Index k = 0; k < rest.cols(); ++k)
      if (!(rest.col(k).dot(W.col(k)) > 0.0))
        throw InverseNotDefinite("eigenvalues: the preconditioner is not positive definite");
    return W;
  }

  /// Rayleigh and Ritz on X, W and P.
  void turn_to_lowest(DenseMatrix W, DenseMatrix P) {
    W = normal_to(X_, std::move(W));
    DenseMatrix others = W;
    if (P.cols() > 0) others = side_by_side(W, normal_to(side_by_side(X_, W), std::move(P)));
    const Eigen::Index size = X_.cols();
    if (AX_.size() == 0) AX_ = problem_.times(X_);
    const DenseMatrix S = side_by_side(X_, others),
                      AS = others.cols() > 0 ? side_by_side(AX_, problem_.times(others)) : AX_;
    const DenseMatrix T = S.transpose() * AS;
    const DenseEigen ritz = dense_eigenpairs(0.5 * (T + T.transpose()));
    if (!ritz.found || !ritz.values.allFinite()) throw NoConvergence("eigenvalues: the matrix is not finite");
    const DenseMatrix Y = ritz.vectors.leftCols(size);
    values_ = ritz.values.head(size);
    X_ = S * Y;
    AX_ = AS * Y;
    P_ = others * Y.bottomRows(others.cols());
  }

  /// Values closer to each other than their residuals are one cluster.
  Vector errors(const Vector& left) const {
    const Eigen::Index size = values_.size();
    Vector errors = left;
    for (Eigen::Index first = 0; first < size;) {
      Eigen::Index end = first + 1;
      double sum = sq(left[first]);
      while (end < size && values_[end] - values_[end - 1] <= 10.0 * (left[end] + left[end - 1]))
        sum += sq(left[end++]);
      double gap = std::numeric_limits<double>::infinity();
      if (first > 0) gap = values_[first] - values_[first - 1] - left[first - 1];
      if (end < size) gap = std::min(gap, values_[end] - values_[end - 1] - left[end]);
      if (end < size && gap > 0.0)
        for (Eigen::Index k = first; k < end; ++k) errors[k] = std::min(errors[k], sum / gap);
      first = end;
    }
    return errors;
  }
  static double sq(double x) { return x * x; }

  Lowest found(const Vector& left, int iterations) const {
    const int count = wanted_.count;
    const Vector values = X_.leftCols(count).cwiseProduct(AX_.leftCols(count)).colwise().sum().transpose();
    return {values,  // free of the rounding of the method
            X_.leftCols(count),
            errors(left).head(count),
            X_.rightCols(X_.cols() - count),
            iterations,
            {}};
  }
  std::string why_not(const Vector& left) const {
    Eigen::Index worst = 0;
    for (Eigen::Index k = 0; k < wanted_.count; ++k)
      if (left[k] / enough_for(k) > left[worst] / enough_for(worst)) worst = k;
    return fmt::format(
        "lowest eigenvalues by multigrid: after {} iterations the residual of number {}, {:.3g}, is {:.2g}, "
        "not the {:.2g} that is asked for",
        wanted_.iterations, worst + 1, values_[worst], left[worst], enough_for(worst));
  }

  const LowestProblem& problem_;
  const LowestWanted& wanted_;
  DenseMatrix X_, AX_, P_;
  Vector values_;
  bool exact_ = false;
};

Lowest solved_densely(const LowestProblem& p, int count) {
  const DenseMatrix unit = DenseMatrix::Identity(p.size, p.size);
  DenseMatrix A = p.times(unit);
  const DenseMatrix B = p.metric ? p.metric(unit) : unit;
  const int left_out = p.without ? static_cast<int>(p.without->cols()) : 0;
  if (left_out > 0) {  // to the end of the spectrum
    const DenseMatrix images = B * *p.without;
    const double far = A.cwiseAbs().rowwise().sum().maxCoeff() / std::max(1e-300, B.diagonal().minCoeff());
    A += 4.0 * far * images * images.transpose();
  }
  const DenseEigen all = p.metric ? dense_eigenpairs(A, B) : dense_eigenpairs(A);
  if (!all.found || !all.values.allFinite()) throw NoConvergence("eigenvalues: the matrix is not finite");
  const int number = std::min(count, static_cast<int>(p.size) - left_out);
  Lowest found{all.values.head(number),
               all.vectors.leftCols(number),
               Vector::Zero(number),
               DenseMatrix(p.size, 0),
               0,
               {}};
  for (int k = 0; k < number && !p.metric; ++k)  // free of the rounding of the method
    found.values[k] = found.vectors.col(k).dot(p.times(found.vectors.col(k)).col(0));
  return found;
}

}  // namespace

Lowest lowest_eigenpairs(const LowestProblem& problem, const LowestWanted& wanted, const DenseMatrix& start) {
  if (solve_densely(problem.size, wanted.count + 2)) return solved_densely(problem, wanted.count);
  return LowestSearch(problem, wanted, start).run();
}

}  // namespace vbond
