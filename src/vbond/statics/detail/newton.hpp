#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// Solves with the tangent of a body as it stands: the pattern is analysed only when it has changed.
class TangentSolver {
 public:
  explicit TangentSolver(LinearSolver wanted) : wanted_(wanted) {}

  /// Factors tangent() + shift I; false if that is not positive definite.
  bool factor_definite(const StaticBody& body, double shift = 0.0);
  /// Factors tangent() whatever its signs; returns the number of negative eigenvalues, nothing if singular.
  std::optional<int> factor(const StaticBody& body);
  /// After either. With full_tangent() instead of tangent() where moments are applied.
  Vector solve(const StaticBody& body, const Vector& b) const;
  /// True once bodies of this size are solved by conjugate gradients: stability cannot be told then.
  bool iterative() const;
  const Factor& factor() const;

 private:
  LinearSolver wanted_;
  Factor factor_;
  int analysed_ = -1;  // pattern_version
  // completed by the implementation
};

/// How Newton's method went at one load factor.
struct NewtonOutcome {
  bool converged = false;
  std::vector<double> residuals;  ///< StaticBody::residual() before each correction and at the end
  std::string why;                ///< not converged: what stood in the way, e.g. "60 iterations"
};

/// Plain Newton at the body's load factor, from a state near balance; stable or not. For points on a known
/// path: it gives up when residuals grow, and the body is then where it gave up.
NewtonOutcome correct(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings);

/// Newton with a line search downhill in the potential, the tangent shifted where it is not positive
/// definite, so that it goes to a minimum and not to a saddle. It may still stop at a balance that is
/// unstable, if it meets one exactly (a straight column): ask solver.factor().
NewtonOutcome minimise(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings);

}  // namespace vbond
