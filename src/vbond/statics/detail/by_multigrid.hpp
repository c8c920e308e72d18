#pragma once
#include <optional>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/lobpcg.hpp"
#include "vbond/statics/detail/multigrid.hpp"

namespace vbond {

/// What TangentSolver does without a factor. One preconditioner serves all tangents of a stage, as long as it
/// does: it is made anew where gradients take twice the iterations for a digit that they took first, and
/// where they end without a solution. It must be definite also where the tangent is not: then it is that of
/// one with a shift.
class ByMultigrid {
 public:
  /// Makes ready for tangent() + shift I of the body as it stands.
  void take(const StaticBody& body, double shift);

  /// Solves for this part of b by conjugate gradients; empty if the matrix is not definite.
  Vector solve(const Vector& b, double accuracy);
  /// The same whatever the signs of tangent(): the lowest eigenvectors are taken out. Throws NoConvergence.
  Vector solve_any(const Vector& b, double accuracy);
  /// The same normal to the first `null` of the vectors at(first) on, of which nothing is taken along.
  Vector solve_beside(const Vector& b, Eigen::Index first, Eigen::Index null, double accuracy);
  /// With full_tangent(), by GMRES; empty if that does not reach the accuracy.
  Vector solve_full(const Vector& b, double accuracy);

  /// The lowest eigenpairs of tangent(): at least `count`, all that are negative, up to `most` of these, and
  /// one that is not. Throws NoConvergence.
  const Lowest& lowest(int count = 1, int most = 64);
  /// Those of another problem, whose inverse uses solutions() of this preconditioner.
  Lowest lowest_of(const LowestProblem& problem, const LowestWanted& wanted);
  /// Roughly A^-1 of each column.
  DenseMatrix solutions(const DenseMatrix& R) const;
  /// Iterations of conjugate gradients, GMRES and eigenvalues so far.
  int iterations() const { return iterations_; }

 private:
  void make(double shift);
  bool is_due() const;
  double shift_known_to_do() const;
  double shift_for(const DenseMatrix& modes) const;
  Lowest look(const LowestProblem& problem, LowestWanted wanted, const DenseMatrix& start, int most);
  Lowest search(const LowestProblem& problem, const LowestWanted& wanted, const DenseMatrix& start);
  Vector inverse(const Vector& r) const { return preconditioner_.solve(r); }
  Vector times(const Vector& p) const;
  std::optional<Vector> gradients(const Vector& b, double accuracy);
  [[noreturn]] void give_up(const char* what, double left, double wanted) const;

  Multigrid preconditioner_;
  const StaticBody* body_ = nullptr;
  const SparseMatrix* A_ = nullptr;
  double shift_ = 0;                    // asked for
  double made_shift_ = 0;               // of the preconditioner
  double made_for_ = 0;                 // the shift that was asked for then
  double first_price_ = 0, price_ = 0;  // iterations per digit, of the first solution and of the last
  bool fresh_ = false;                  // made for this tangent
  int iterations_ = 0;
  std::optional<Lowest> lowest_;  // of this tangent
  Vector known_;                  // values of the last
  DenseMatrix kept_;              // and vectors, to begin the next search with
};

}  // namespace vbond
