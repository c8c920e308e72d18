#include "vbond/statics/detail/mass_scaled.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

namespace vbond {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// The inertia of a top along the axes of its turns.
Eigen::Matrix3d inertia_in_space(const PrincipalInertia& inertia, const Quatd& q, ParticleId p,
                                 const Unknowns& unknowns) {
  Eigen::Matrix3d I;
  for (int j = 0; j < 3; ++j) {
    const Vec3d column = angular_momentum(inertia.moments, q * inertia.axes, unknowns.axis(p, j + 3));
    for (int i = 0; i < 3; ++i) I(i, j) = unknowns.along(p, i + 3, {{}, column});
  }
  return I;
}

/// Cholesky's factor of the inertia of the free turns of a particle over its least moment, and the inverse.
void add_top(const Eigen::Matrix3d& inertia, ParticleId p, const Unknowns& unknowns, Triplets& factor,
             Triplets& inverse) {
  std::vector<int> free;
  for (int k = 0; k < 3; ++k)
    if (unknowns.of(p, k + 3) != Unknowns::held) free.push_back(k);
  const auto n = static_cast<Eigen::Index>(free.size());
  if (n == 0) return;
  const DenseMatrix L = DenseMatrix(inertia(free, free)).llt().matrixL();
  const DenseMatrix inverse_L = L.triangularView<Eigen::Lower>().solve(DenseMatrix::Identity(n, n));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      const int row = unknowns.of(p, free[static_cast<std::size_t>(i)] + 3),
                column = unknowns.of(p, free[static_cast<std::size_t>(j)] + 3);
      factor.emplace_back(row, column, L(i, j));
      inverse.emplace_back(row, column, inverse_L(i, j));
    }
}

SparseMatrix square(Eigen::Index size, const Triplets& entries) {
  SparseMatrix A(size, size);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace

MassRoot::MassRoot(const Model& model, const State& state, const Unknowns& unknowns)
    : diagonal_(unknowns.size()) {
  for (int k = 0; k < unknowns.size(); ++k) {
    const ParticleId p = unknowns.place(k).particle;
    diagonal_[k] =
        unknowns.is_turn(k) ? std::sqrt(model.inertia[p]) / unknowns.length() : std::sqrt(model.mass[p]);
  }
  if (model.principal.empty()) return;
  Triplets factor, inverse;
  for (int k = 0; k < unknowns.size(); ++k) {
    if (unknowns.is_turn(k) && model.is_top(unknowns.place(k).particle)) continue;
    factor.emplace_back(k, k, 1.0);
    inverse.emplace_back(k, k, 1.0);
  }
  for (const ParticleId p : model.principal.ids())
    if (model.is_top(p))
      add_top(inertia_in_space(model.principal[p], state.q[p], p, unknowns) / model.inertia[p], p, unknowns,
              factor, inverse);
  tops_ = OfTops{square(diagonal_.size(), factor), square(diagonal_.size(), inverse)};
}

SparseMatrix MassRoot::scaled_to_rounding(const SparseMatrix& K) const {
  const Vector scale = diagonal_.cwiseInverse();
  const SparseMatrix A = scale.asDiagonal() * K * scale.asDiagonal();
  if (!tops_) return A;
  const SparseMatrix half = tops_->inverse * A;
  return half * SparseMatrix(tops_->inverse.transpose());
}

SparseMatrix MassRoot::scaled(const SparseMatrix& K) const {
  const SparseMatrix A = scaled_to_rounding(K);
  return tops_ ? SparseMatrix(0.5 * (A + SparseMatrix(A.transpose()))) : A;
}

SparseMatrix MassRoot::scaled_skew(const SparseMatrix& K) const {
  const SparseMatrix A = scaled_to_rounding(K);
  return tops_ ? SparseMatrix(0.5 * (A - SparseMatrix(A.transpose()))) : A;
}

Vector MassRoot::motion(const Vector& y) const {
  if (!tops_) return y.cwiseQuotient(diagonal_);
  return Vector(tops_->inverse.transpose() * y).cwiseQuotient(diagonal_);
}

DenseMatrix MassRoot::times(const DenseMatrix& y) const {
  if (!tops_) return diagonal_.asDiagonal() * y;
  return diagonal_.asDiagonal() * DenseMatrix(tops_->factor * y);
}

DenseMatrix MassRoot::transpose_times(const DenseMatrix& x) const {
  const DenseMatrix scaled = diagonal_.asDiagonal() * x;
  return tops_ ? DenseMatrix(tops_->factor.transpose() * scaled) : scaled;
}

SparseMatrix MassRoot::times_factor(const SparseMatrix& x) const {
  return tops_ ? SparseMatrix(tops_->factor.transpose() * x) : x;
}

}  // namespace vbond
