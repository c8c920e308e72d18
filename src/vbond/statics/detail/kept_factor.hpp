#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "vbond/core/crew.hpp"
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/detail/gradients.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/fracture_under_way.hpp"

namespace vbond {

/// The factor of a positive definite matrix M that is kept while the body changes: it preconditions conjugate
/// gradients on the present matrix A. Where a bond breaks, M changes with it, by a matrix of rank 6
/// (Woodbury's formula), so that it differs from A by the small movements since the factor was made.
///
/// A large factor is copied into one of single precision, as long as that is near. M is the matrix of the
/// rounded factor then, and all that is said of it here holds.
///
/// That A is positive definite is shown by conjugate gradients too, on random right-hand sides r. Let A u =
/// mu M u, u^T M u = 1, mu <= 0. Step m leaves of r along u the part p_m(mu) u^T r. If p^T A p has been
/// positive for all directions p, the roots of p_m are positive and p_m(0) = 1, so p_m(mu) >= 1: what is
/// left, sqrt(r_m^T M^-1 r_m), is no less than |u^T r|. With components of r uniform, of variance D_kk =
/// M_kk, u^T r has a variance u^T D u of at least 1/kappa, kappa the largest eigenvalue of D^-1/2 M D^-1/2,
/// and a density of at most 0.41 over its root (K. Ball, Proc. Am. Math. Soc. 97 (1986) 465). When no more
/// than delta / sqrt(kappa) is left there is such a mu with a chance below 0.82 delta. Sides are drawn one
/// independently of the other, so that chances multiply: three of delta = 1e-3, which go through the factor
/// together, take half of the iterations of one of 1e-9.
class KeptFactor {
 public:
  /// Keeps a reference. What comes of it does not depend on how many threads there are.
  explicit KeptFactor(Factor& factor, std::shared_ptr<Crew> crew = std::make_shared<Crew>(1))
      : factor_(factor), crew_(std::move(crew)), single_(crew_) {}

  /// The factor has just been made, of this matrix.
  void begin(const SparseMatrix& A);
  /// What it has come to since then: all but where the body stood then.
  KeptFactorUnderWay under_way() const;
  /// The factor has just been made anew of the matrix of then: all that it has come to since, to the last
  /// bit. False if it cannot be of that matrix.
  bool go_on_from(const SparseMatrix& A, const KeptFactorUnderWay& then);
  void draw_on_from(const std::mt19937_64& random) { random_ = random; }
  void drop();
  bool at_hand() const { return at_hand_; }
  /// A new factor would be the cheaper way on: since the last proof it would have saved as many iterations as
  /// one matrix may take, as where the body moves far; or of late it would have saved more solutions from
  /// proof to proof than on average since the factor was made, its own cost among them. What it would have
  /// saved shows by how much an iteration leaves.
  bool is_due() const;
  /// Solutions since the factor was made, in those with it alone.
  double spent() const { return spent_ + in_cycle_; }
  /// The matrix has changed by this among these unknowns, as a bond has broken: so does M.
  void follow(const std::vector<int>& unknowns, DenseMatrix change);
  /// The same wherever A differs much from M, as where pairs have come to touch or have ceased to. Its
  /// pattern may be another one than that of the factor.
  void follow(const SparseMatrix& A);

  /// x with A x = b, to this part of b in the norm of M^-1; nothing if A is not positive definite along the
  /// way, or it takes longer than a new factor.
  std::optional<Vector> solve(const SparseMatrix& A, const Vector& b, double accuracy);
  /// The same for each column, which take little longer together than one does, from this X on.
  std::optional<DenseMatrix> solve_columns(const SparseMatrix& A, const DenseMatrix& B, const DenseMatrix& X,
                                           double accuracy);
  /// M^-1 b: x with A x = b, as nearly as M has followed A.
  Vector solve_roughly(const Vector& b);
  /// True: A is positive definite, but for a chance of 1e-9. False: not known.
  bool shows_definite(const SparseMatrix& A);
  /// If it shows that: x with A x = b, to this part of b as above. Takes hardly longer.
  std::optional<Vector> solve_if_definite(const SparseMatrix& A, const Vector& b, double accuracy);

 private:
  /// M with Q diag(values) Q^T more, Q orthonormal columns that have entries for a few unknowns only: its
  /// inverse is M^-1 - Z inner Q^T M^-1.
  struct Change {
    std::vector<int> unknowns;
    DenseMatrix Q;      // those rows
    DenseMatrix Z;      // M^-1 Q
    DenseMatrix inner;  // (diag(values)^-1 + Q^T M^-1 Q)^-1
    DenseMatrix given;  // the change that it is of
    double least_part;  // of the largest of its parts: what is less is left out
  };
  void follow(const std::vector<int>& unknowns, DenseMatrix change, double least_part);
  /// From this X on; without columns: from 0.
  std::optional<DenseMatrix> gradients(const SparseMatrix& A, const DenseMatrix& B, const DenseMatrix& X,
                                       const std::vector<Enough>& enough, std::vector<GradientsMade>* made);
  bool single_is_near();
  double kappa();
  double cost_of_factor() const;
  double price_of(Eigen::Index columns) const;
  /// Solutions that are spent on one matrix before a new factor is made.
  double patience() const;
  /// M^-1 B, all changes included.
  DenseMatrix solve_kept(const DenseMatrix& B) const;
  Vector random_side();
  double smallest_ritz_value(const GradientsMade& c) const;

  Factor& factor_;
  std::shared_ptr<Crew> crew_;
  SingleFactor single_;
  bool in_single_ = false;  // single_ is used
  SparseMatrix M_;
  Vector diagonal_;              // of M
  std::vector<Change> changes_;  // in their order
  double kappa_ = 0;             // 0: to be found
  bool at_hand_ = false;
  std::mt19937_64 random_, random_as_made_;
  int proofs_ = 0;                   // since the factor was made
  double price_ = 1;                 // of one solution, in those with the factor alone
  double spent_ = 0, in_cycle_ = 0;  // such solutions since the factor was made; since the last proof
  double slow_ = 0;                  // since the last proof: iterations that a new factor would have saved
  double wasted_ = 0, recent_ = 0;  // of spent_ what it would have saved; from one proof to the next, of late
};

}  // namespace vbond
