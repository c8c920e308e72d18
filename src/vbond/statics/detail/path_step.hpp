#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "vbond/statics/detail/arc_length.hpp"
#include "vbond/statics/detail/crossing.hpp"

namespace vbond {

/// A balance within a step.
struct PathNode {
  double s = 0;  ///< arc-length since the start of the step
  PathPoint point;
};

/// A step along a path as a curve: each arc-length s has its balance, found anew from the start of the step.
/// What happens within the step is located as the zero of a function on that curve.
class PathStep {
 public:
  /// direction: unit vector.
  PathStep(StaticBody& body, ArcLength& arc, PathPoint start, PathDirection direction)
      : body_(body), arc_(arc), start_(std::move(start)), direction_(std::move(direction)) {}

  const PathPoint& start() const { return start_; }
  const PathDirection& direction() const { return direction_; }

  /// The balance at arc-length s, where the body is then.
  StepOutcome to(double s);

  /// The place between lo and hi at which a function of the balance crosses zero; |value| <= small is taken
  /// for zero. Nothing if the tangent stiffness is singular to the last bit there and all around.
  using Value = std::function<double(const PathPoint&)>;
  std::optional<PathNode> zero_of(const Value& value, const PathNode& lo, const PathNode& hi, double small);
  /// Where the load factor is stationary.
  std::optional<PathNode> limit_point(const PathNode& lo, const PathNode& hi);
  /// The first place at which the number of negative eigenvalues changes.
  std::optional<PathNode> critical_point(const PathNode& lo, const PathNode& hi);
  /// Negative eigenvalues at s, beside a special point whose own number is left to rounding; those of `end`
  /// if that is between the special point and s, or if nothing is found at s.
  int unstable_beside(const PathNode& special, double s, const PathNode& end);

  /// Of Newton's method, all together.
  int iterations() const { return iterations_; }
  const std::vector<double>& last_residuals() const { return last_residuals_; }

 private:
  std::optional<PathNode> zero_between(const Sample& lo, const Sample& hi, const Value& value, double small);

  StaticBody& body_;
  ArcLength& arc_;
  PathPoint start_;
  PathDirection direction_;
  int iterations_ = 0;
  std::vector<double> last_residuals_;
};

}  // namespace vbond
