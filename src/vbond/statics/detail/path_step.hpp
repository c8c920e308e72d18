#pragma once
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "vbond/core/crossing.hpp"
#include "vbond/statics/detail/arc_length.hpp"
#include "vbond/statics/detail/path_goal.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// Paths of a body that is not quite symmetric pass each other where they would cross: steps go over that if
/// the gap is no more than this part of the load factor, and follow the path round the bend if it is.
inline constexpr double largest_gap = 1e-4;

/// A balance within a step.
struct PathNode {
  double s = 0;  ///< arc-length since the start of the step
  PathPoint point;
  std::vector<double> residuals{};  ///< before each correction and at the end
};

/// Where stability changes within a step: some eigenvalues pass zero together.
struct CriticalPoint {
  PointKind kind = PointKind::bifurcation;  ///< or limit_point
  PathNode node;              ///< the balance there, or next to it; unstable: min(before, after)
  double load_factor = 0;     ///< where they are zero: `node` may be next to it
  int before = 0, after = 0;  ///< negative eigenvalues on either side
  /// By how much of the load factor the paths on either side miss each other: those of a body that is not
  /// quite symmetric do not cross. 0: they meet.
  double gap = 0;
  int together() const { return std::abs(after - before); }
  /// The path itself turns off along the branch, so that stability does not change.
  bool turns_off() const { return before == after && gap > 0.0; }
};

/// What is located within a step.
struct LookFor {
  /// Once so many eigenvalues have become negative the others are left out.
  int losses = std::numeric_limits<int>::max();
  bool beyond_limit_point = true;
  const std::vector<Goal>* goals = nullptr;  ///< beyond one of them others are left out
};

/// As in "limit point at load factor 0.52".
std::string in_words(const CriticalPoint& c);

/// A step along a path as a curve: each arc-length s has its balance, found anew from the start of the step.
/// What happens within the step is located as the zero of a function on that curve.
class PathStep {
 public:
  /// direction: unit vector.
  PathStep(StaticBody& body, ArcLength& arc, PathPoint start, PathDirection direction)
      : body_(&body), arc_(&arc), start_(std::move(start)), direction_(std::move(direction)) {}

  const PathPoint& start() const { return start_; }
  const PathDirection& direction() const { return direction_; }

  /// The balance at arc-length s, where the body is then; as the end of the step, or on the way.
  StepOutcome to(double s, bool end_of_step = false);

  /// The place between lo and hi at which a function of the balance crosses zero; |value| <= small is taken
  /// for zero. Nothing if a balance is not found somewhere between.
  using Value = std::function<double(const PathPoint&)>;
  std::optional<PathNode> zero_of(const Value& value, const PathNode& lo, const PathNode& hi, double small);

  /// Where stability changes between the two, in the order in which the path meets it; nothing if a balance
  /// is not found somewhere between.
  std::optional<std::vector<CriticalPoint>> critical_points(const PathNode& lo, const PathNode& hi,
                                                            const LookFor& wanted = {});

  /// An eigenvalue on the way, and the load factor there.
  struct Look {
    double s, value, load_factor;
  };
  struct ZeroOfLine {
    double s, load_factor;
    double product;            ///< of the two values
    double slope, load_slope;  ///< of value and load factor, per arc-length
  };

 private:
  /// Eigenvalues next to zero at a place that has been looked at. They serve each search in the step.
  struct Seen {
    double s, load_factor;
    NearZero near;
    bool driven = false;  // the body is held along modes that are driven
  };
  PathNode up_to_goal(const PathNode& lo, const PathNode& hi);
  std::optional<CriticalPoint> limit_point(const PathNode& lo, const PathNode& hi);
  bool add_bifurcations(const PathNode& lo, const PathNode& hi, std::vector<CriticalPoint>& found);
  std::optional<CriticalPoint> zero_of_eigenvalue(int number, const PathNode& lo, const PathNode& hi,
                                                  const std::vector<CriticalPoint>& known, bool only_known);
  double gap_of_turn(const PathNode& lo, const PathNode& node, const PathNode& hi);
  double eigenvalue(int number, const PathNode& node, double scale, bool stands_there);
  StepOutcome to_near_zero(int number, double s, double scale);
  std::optional<double> gap_around(int number, const ZeroOfLine& zero, double scale);
  void narrow(int number, double small, Sample& a, Sample& b, std::vector<Look>& looks) const;
  int unstable_beside(double special, double s, const PathNode& end);

  StaticBody* body_;
  ArcLength* arc_;
  PathPoint start_;
  PathDirection direction_;
  LookFor wanted_;
  std::vector<Seen> seen_;  // within one search for bifurcations
  bool may_hold_ = true;    // modes, in that search
  int held_together_ = 0;   // the number of those held last
  bool driven_ = false;     // the last balance there is that of a body held along modes that are driven
};

}  // namespace vbond
