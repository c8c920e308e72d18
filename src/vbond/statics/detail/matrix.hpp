#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cmath>
#include <limits>

namespace vbond {

using Vector = Eigen::VectorXd;
using DenseMatrix = Eigen::MatrixXd;
/// Compressed columns; symmetric matrices are stored whole, both triangles.
using SparseMatrix = Eigen::SparseMatrix<double>;

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The largest |x_k|, 0 of none; NaN if there is one among them, which Eigen's maxCoeff() may drop.
inline double max_norm(const Vector& x) {
  return x.size() == 0 ? 0.0 : x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
}

/// The larger of the two; NaN if one of them is, which std::max may drop.
inline double larger(double a, double b) {
  return b > a || std::isnan(b) ? b : a;
}

}  // namespace vbond
