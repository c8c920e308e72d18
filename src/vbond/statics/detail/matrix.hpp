#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace vbond {

using Vector = Eigen::VectorXd;
using DenseMatrix = Eigen::MatrixXd;
/// Compressed columns; symmetric matrices are stored whole, both triangles.
using SparseMatrix = Eigen::SparseMatrix<double>;

}  // namespace vbond
