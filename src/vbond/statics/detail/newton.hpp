#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// Solves with the tangent of a body as it stands. Factors are made anew at each call of a factor function;
/// the order of elimination only when the pattern has changed.
class TangentSolver {
 public:
  explicit TangentSolver(LinearSolver wanted);
  ~TangentSolver();

  /// Chooses between factor and conjugate gradients, by memory where both would do, and finds the order of
  /// elimination, unless it has done so for this pattern.
  void prepare(const StaticBody& body);
  /// Factors tangent() + shift I; false if that is not positive definite. With conjugate gradients that is
  /// noticed only in solve().
  bool factor_definite(const StaticBody& body, double shift = 0.0);
  /// Factors tangent() whatever its signs; returns the number of negative eigenvalues, nothing if singular
  /// (or if it is solved by conjugate gradients, which do not tell).
  std::optional<int> factor(const StaticBody& body);
  /// After either: (tangent() + shift I)^-1 b. Empty if conjugate gradients do not converge.
  Vector solve(const Vector& b) const;
  /// After either, without a shift: the same with full_tangent(), which differs where moments act.
  Vector solve_full(const StaticBody& body, const Vector& b) const;
  /// True if the factor does not fit into memory, or was not wanted: conjugate gradients are used.
  bool iterative() const { return iterative_ != nullptr; }
  const char* name() const { return iterative() ? "iterative" : "direct"; }
  const Factor& last_factor() const { return factor_; }

 private:
  struct ConjugateGradients;
  LinearSolver wanted_;
  Factor factor_;
  int analysed_ = 0;  // pattern_version
  std::unique_ptr<ConjugateGradients> iterative_;
};

/// A predicted step along the load factor turns bonds by no more than this.  [rad]
inline constexpr double largest_prediction = 0.3;

/// How Newton's method went at one load factor.
struct NewtonOutcome {
  bool converged = false;
  bool interrupted = false;
  std::vector<double> residuals;  ///< StaticBody::residual() before each correction and at the end
  std::string why;                ///< not converged: what stood in the way, e.g. "60 iterations"
  int iterations() const { return static_cast<int>(residuals.size()) - 1; }
};

/// As well as was asked for, or to rounding.
bool in_balance(const StaticBody& body, const NewtonSettings& settings);

/// Balanced as well as was asked for, or as rounding lets it be known: residuals, the last being that of the
/// body as it stands, have stopped falling close to what rounding leaves.
bool balanced(const StaticBody& body, const NewtonSettings& settings, const std::vector<double>& residuals);

/// Plain Newton at the body's load factor, from a state near balance; stable or not. For points on a known
/// path: it gives up when residuals grow, and the body is then where it gave up.
NewtonOutcome correct(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                      const std::function<bool()>& interrupted = {});

/// The balance that a body comes to which is let go as it stands: downhill, or where outside moments have no
/// potential to go down first straight on. Adds to iterations.
NewtonOutcome settle(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                     const std::function<bool()>& interrupted, int& iterations);

/// Newton with a line search downhill in the potential, the tangent shifted where it is not positive
/// definite, so that it goes to a minimum and not to a saddle. It may still stop at a balance that is
/// unstable, if it meets one exactly (a straight column): ask solver.factor().
NewtonOutcome minimise(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                       const std::function<bool()>& interrupted = {});

}  // namespace vbond
