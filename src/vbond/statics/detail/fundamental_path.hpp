#pragma once
#include <optional>
#include <vector>

#include "vbond/statics/detail/kinds.hpp"

namespace vbond {

/// Where K + change K' is singular, K' being the derivative of the tangent K along the path.
struct Crossing {
  double change;    ///< of the load factor
  double known_to;  ///< what rounding of K may make of it
  Vector mode;
};

/// A point of the fundamental path, and the critical loads that are seen from it.
struct PathSample {
  Placement at;
  int unstable = 0;              ///< negative eigenvalues: so many critical loads have been passed
  std::vector<Crossing> behind;  ///< nearest first
  std::vector<Crossing> ahead;   ///< nearest first

  /// Critical load number k, from 0, as seen from here.
  const Crossing* crossing(int k) const;
};

/// The balance that starts at load factor 0, followed with the load factor whether it is stable or not.
class FundamentalPath {
 public:
  FundamentalPath(StaticBody& body, const StaticHooks& hooks, StaticResult& result)
      : body_(body), hooks_(hooks), result_(result), solver_(body.stage().newton.solver) {}

  /// The body at load factor 0 and the first `count` linearised critical loads. Throws NoEquilibrium if it is
  /// not stable there, or if moments without a potential act.
  PathSample begin(int count);
  /// Goes from a sample to this load factor; nothing if interrupted. Throws NoEquilibrium if the path does
  /// not lead there, or if moments without a potential act.
  std::optional<PathSample> look(const PathSample& from, double load_factor, int wanted);

 private:
  void refuse_moments() const;
  bool go_to(double load_factor);
  void step(const Vector& rate, double change);
  SparseMatrix tangent_rate(const Vector& rate);
  std::vector<Crossing> crossings(const Vector& rate, int wanted);
  [[noreturn]] void lost(const Vector& rate, double change);

  StaticBody& body_;
  const StaticHooks& hooks_;
  StaticResult& result_;
  TangentSolver solver_;
};

}  // namespace vbond
