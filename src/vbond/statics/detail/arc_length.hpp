#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/statics/detail/deflated.hpp"
#include "vbond/statics/detail/near_zero.hpp"
#include "vbond/statics/detail/newton.hpp"

namespace vbond {

/// A direction along a path of balance, of length 1 in the metric of ArcLength.
struct PathDirection {
  Vector u;      ///< change of the unknowns
  double f = 0;  ///< change of the load factor
};

/// A balance on a path.
struct PathPoint {
  Placement at;
  PathDirection tangent;
  int unstable = 0;           ///< negative eigenvalues of the tangent stiffness, symmetric part
  bool has_potential = true;  ///< of all loads; without one those eigenvalues do not tell what is stable
  /// Of the determinant of the whole tangent stiffness; 0: not known. Negative: some motion grows without
  /// swinging, whether or not loads have a potential.
  int sign = 0;
};

/// The eigenvalue of the tangent stiffness that is nearest to zero, roughly, and its rate along the path.
struct Softest {
  double value = 0;  ///< [force/length]
  double rate = 0;   ///< [force/length^2]
};

/// What became of one step along a path.
struct StepOutcome {
  std::optional<PathPoint> point;  ///< absent: no balance was found
  PathDirection deviation;         ///< of the balance from the predicted place; normal to the direction
  std::string why;                 ///< absent: what stood in the way
  int iterations = 0;
  bool driven = false;            ///< only of step_beside()
  std::vector<double> residuals;  ///< before each correction and at the end
};

/// Diagonal of the box around the particles, or the longest edge of a cell that moves.  [length]
double extent_of(const StaticBody& body);

/// One step along a path of balance R(u, f) = 0: predictor along a direction, corrector on the plane normal
/// to it (Riks, Int. J. Solids Struct. 15 (1979) 529). A plane, not a sphere: it meets the path once, where a
/// sphere meets it twice and a root has to be chosen. Turns do not add up, so the plane is kept increment by
/// increment; that decides only which balance counts as the one at arc-length s.
///
/// The arc-length is the movement of all degrees of freedom, free and held. So the load factor counts by
/// what it moves itself: not at all under forces, whose size in terms of lengths is arbitrary (Crisfield,
/// Non-linear Finite Element Analysis of Solids and Structures 1 (1991) 9.3), and as the distance that
/// supports go where these drive the body, or the strain that heat imposes on bonds times the size of the
/// body: no arc is without length.
///
/// Where the tangent stiffness is singular the equations of a step are not, at a limit point; and at a
/// bifurcation they are consistent. Both are solved there with the null vectors taken out (Deflated): a step
/// goes through any critical point, and does not move along a mode that nothing drives.
///
/// Where outside moments act the tangent stiffness is not symmetric, and what its symmetric part has for
/// eigenvalues does not matter: the equations of a step are solved as a whole, by factors of their own, which
/// are regular wherever no other path crosses.
class ArcLength {
 public:
  ArcLength(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings);

  double dot(const PathDirection& a, const PathDirection& b) const {
    return a.u.dot(b.u) + weight_ * a.f * b.f;
  }
  PathDirection unit(PathDirection d) const;
  /// Between unit vectors.  [rad]
  double angle(const PathDirection& a, const PathDirection& b) const;

  /// The balance at which the body stands, its tangent on the same side as `along`. Nothing if nothing
  /// changes with the load factor. Throws NoConvergence if the tangent stiffness cannot be factored.
  std::optional<PathPoint> point_here(const PathDirection& along);
  /// Of the point found last, where the body still stands.
  Softest softest(const PathDirection& tangent);
  /// Whether the tangent stiffness of the last point was singular to rounding.
  bool is_singular() const {
    return full_is_singular_ || (singular_ && singular_->null_vectors().cols() > 0);
  }

  /// The balance on the plane at distance s from `from` that is normal to the unit vector `direction`. The
  /// body is then there, or where the search ended. The end of a step, from which the path goes on, is
  /// corrected down to rounding; of places looked at within a step some times that is enough.
  StepOutcome step(const Placement& from, const PathDirection& direction, double s, bool end_of_step);
  /// The same without any movement along these modes, orthonormal columns. Next to a point where they have no
  /// stiffness rounding moves the body along them, and to another path. Where nothing drives them, as in a
  /// symmetric body, it stands on its own path then; `driven` if they are driven a little, and where they are
  /// driven by more there is no point.
  StepOutcome step_beside(const DenseMatrix& modes, const Placement& from, const PathDirection& direction,
                          double s);

  /// By multigrid: the eigenvalue of the tangent stiffness, as the body stands, with this number in
  /// increasing order from 0.
  std::optional<double> eigenvalue(int number);
  /// Eigenpairs of the tangent stiffness next to zero, as the body stands, among them the one with this
  /// number, or the nearest if there is none. Values are known as NearZeroSearch has it. unstable: how many
  /// are negative; where some are zero to rounding those are counted that are negative for sure.
  NearZero near_zero(int number, int unstable, double scale);

  /// Corrections, and factors of the tangent, so far.
  int iterations() const { return iterations_; }
  int factors() const { return solver_.factors_made() + other_factors_; }

 private:
  void factor(const PathDirection& normal);
  DenseMatrix solve_beside(const DenseMatrix& B);
  Vector solve_held(const Vector& b);
  double drive(const DenseMatrix& modes) const;
  bool is_balanced_beside(const DenseMatrix& modes) const;
  StepOutcome corrected(const Placement& from, const PathDirection& direction, double s, bool end_of_step);
  EigenPairs pairs_near_zero(int count, double scale);
  int number_below(double bound);
  std::pair<double, Vector> soft_mode();
  std::optional<PathPoint> point_of_factor(const PathDirection& along);
  PathDirection correction(const PathDirection& normal);
  PathDirection solved_bordered(const Vector& R, double c) const;
  PathDirection singular_correction(const PathDirection& normal);
  int sign_of_determinant(const PathDirection& tangent) const;
  PathDirection tangent(const PathDirection& along);
  PathDirection singular_tangent(const PathDirection& along);

  StaticBody& body_;
  TangentSolver& solver_;
  const NewtonSettings& settings_;
  double weight_;                     // squared movement that is imposed per load factor  [length^2]
  int unstable_ = 0;                  // at the last factor
  std::optional<Deflated> singular_;  // the same
  bool bordered_ = false, full_is_singular_ = false;  // the same, where outside moments act
  std::uint64_t factored_at_ = 0;                     // placement_number
  const DenseMatrix* held_ = nullptr;                 // modes along which the body does not move now
  DenseMatrix of_held_;                               // K^-1 of them, at the last factor
  NearZeroSearch near_zero_;
  int iterations_ = 0, other_factors_ = 0;
};

}  // namespace vbond
