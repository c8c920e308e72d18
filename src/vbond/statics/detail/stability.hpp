#pragma once
#include <optional>

#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/newton.hpp"

namespace vbond {

/// What the tangent stiffness says of a balance.
struct Stability {
  /// Eigenvalues that are negative by more than their error. Nothing where that is not known: beside outside
  /// moments that have no potential.
  std::optional<int> unstable = 0;
  bool neutral = false;   ///< the lowest eigenvalue is zero to within its error
  bool definite = false;  ///< the solver stands at this tangent, and it is positive definite
  /// Beside outside moments: the determinant of the whole tangent is negative, so that some motion grows
  /// without swinging. If it is not, nothing is said: two such motions, or swings that grow, are not seen.
  bool diverges = false;
  std::optional<EigenPairs>
      lowest;  ///< pair, by multigrid all negative ones; else only if it is not definite
};

/// Judges the balance at which the body stands; factors its tangent. Throws NoConvergence, and NoEquilibrium
/// if the tangent is not finite.
Stability judge_stability(const StaticBody& body, TangentSolver& solver);

/// The smallest eigenvalue of the tangent just judged, nothing where it is not known.  [force/length]
/// Throws NoEquilibrium if it is not finite.
std::optional<double> smallest_eigenvalue(const StaticBody& body, const TangentSolver& solver,
                                          const Stability& stability);

/// Whether a tangent with this smallest eigenvalue is neutral to rounding although its factor is definite.
bool is_neutral(const StaticBody& body, const Stability& stability, double smallest_eigenvalue);

}  // namespace vbond
