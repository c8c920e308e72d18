#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// What a solution by conjugate gradients left behind.
struct GradientsMade {
  std::vector<double> alpha, beta;  ///< steps and their ratios, one per iteration
  double left = 1.0;                ///< norm of the residual at the end, as a part of that at the start
};

/// When the norm of the residual, sqrt(r^T M^-1 r), is small enough: this large, or this part of what it was.
struct Enough {
  double norm, part;
};

/// Preconditioned conjugate gradients from x = 0: times(p) is A p, inverse(r) is M^-1 r, M positive definite.
/// Nothing if A or M turns out not to be positive definite, or after `most` iterations.
template <class Times, class Inverse>
std::optional<Vector> conjugate_gradients(Times&& times, Inverse&& inverse, Vector r, const Enough& enough,
                                          double most, GradientsMade* made = nullptr) {
  Vector x = Vector::Zero(r.size());
  Vector z = inverse(r);
  Vector p = z;
  double size = r.dot(z);
  const double start = size, end = std::max(enough.norm * enough.norm, enough.part * enough.part * size);
  for (int k = 0; size > end; ++k) {
    const Vector Ap = times(p);
    const double curvature = p.dot(Ap);
    if (!(curvature > 0.0) || !std::isfinite(curvature) || k >= most) return {};
    const double alpha = size / curvature;
    x += alpha * p;
    r -= alpha * Ap;
    z = inverse(r);
    const double next = r.dot(z), beta = next / size;
    if (made) {
      made->alpha.push_back(alpha), made->beta.push_back(beta);
      made->left = std::sqrt(std::abs(next) / start);
    }
    size = next;
    p = z + beta * p;
  }
  if (!(size >= 0.0)) return {};  // M is not positive definite, or NaN
  return x;
}

/// X with A X = B, each column as above but all of them together: inverse(R) is cheaper for several at a
/// time. From this X on, or from 0 if it has no columns. When each is enough: its norm, or this part of the
/// root of b^T X, or of what the norm is from X = 0. A column that has ended leaves the others. made: for
/// each column.
template <class Times, class Inverse>
std::optional<DenseMatrix> conjugate_gradients_of_columns(Times&& times, Inverse&& inverse,
                                                          const DenseMatrix& B, DenseMatrix X,
                                                          const std::vector<Enough>& enough, double most,
                                                          std::vector<GradientsMade>* made = nullptr) {
  const auto products = [](const DenseMatrix& a, const DenseMatrix& b) -> Vector {
    return a.cwiseProduct(b).colwise().sum();
  };
  DenseMatrix R = B;
  if (X.cols() == 0)
    X = DenseMatrix::Zero(B.rows(), B.cols());
  else
    R -= times(X);
  DenseMatrix P = inverse(R);
  Vector size = products(R, P);
  const Vector start = size, given = size.cwiseMax(products(B, X));
  Vector end(size.size());
  for (Eigen::Index c = 0; c < size.size(); ++c) {
    const auto [norm, part] = enough[static_cast<std::size_t>(c)];
    end[c] = std::max(norm * norm, part * part * given[c]);
  }
  if (made) made->resize(enough.size());
  std::vector<Eigen::Index> on(enough.size());  // columns of X that those of R and P are of
  std::iota(on.begin(), on.end(), Eigen::Index{0});
  const auto let_go = [&] {  // false: M is not positive definite, or NaN
    std::vector<Eigen::Index> left, stay;
    for (std::size_t k = 0; k < on.size(); ++k)
      if (size[static_cast<Eigen::Index>(k)] > end[on[k]])
        stay.push_back(static_cast<Eigen::Index>(k)), left.push_back(on[k]);
    const bool sound = (size.array() >= 0.0).all();
    if (left.size() == on.size()) return sound;
    R = DenseMatrix(R(Eigen::all, stay)), P = DenseMatrix(P(Eigen::all, stay)), size = Vector(size(stay));
    on = std::move(left);
    return sound;
  };
  for (int k = 0;; ++k) {
    if (!let_go()) return {};
    if (on.empty()) return X;
    const DenseMatrix AP = times(P);
    const Vector curvature = products(P, AP);
    if (!((curvature.array() > 0.0).all() && curvature.allFinite()) || k >= most) return {};
    const Vector alpha = size.cwiseQuotient(curvature);
    X(Eigen::all, on) += P * alpha.asDiagonal();
    R -= AP * alpha.asDiagonal();
    const DenseMatrix Z = inverse(R);
    const Vector next = products(R, Z), beta = next.cwiseQuotient(size);
    for (std::size_t at = 0; made && at < on.size(); ++at) {
      const auto c = static_cast<Eigen::Index>(at);
      GradientsMade& of_column = (*made)[static_cast<std::size_t>(on[at])];
      of_column.alpha.push_back(alpha[c]), of_column.beta.push_back(beta[c]);
      of_column.left = std::sqrt(std::abs(next[c]) / start[on[at]]);
    }
    P = Z + P * beta.asDiagonal();
    size = next;
  }
}

}  // namespace vbond
