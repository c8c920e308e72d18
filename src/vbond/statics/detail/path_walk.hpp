#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vbond/statics/detail/path_step.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond {

/// One step of a walk: from where it began to its end, and what lies between.
struct PathLeg {
  PathStep step;
  PathNode start, end;
  std::vector<CriticalPoint> critical;  ///< in the order in which the path meets them
};

/// Follows the balance of a body with the load factor, by arc-length, step by step through everything that is
/// critical. The only place where the length of steps is chosen and judged: `path` and `buckling` are two
/// ways to look at this walk.
///
/// A step is taken again, shorter, if something speaks against it: no balance, a turn of the path or of a
/// bond that is too large, a bond that snaps, a load factor that goes back and forth, a way aside or an
/// eigenvalue that jumps over zero, which mean that the step has left the path for another one, or an
/// eigenvalue that may pass zero and come back.
class PathWalk {
 public:
  /// Keeps references. largest_step: the longest movement of a particle in a step, or rotation times the
  /// length scale  [length]; 0: a share of the body's size.
  PathWalk(StaticBody& body, TangentSolver& solver, const NewtonSettings& newton, double largest_step);

  /// The point where the body stands; nothing if the load factor changes nothing. first_step: change of the
  /// load factor, its sign the way to go.
  const PathPoint* start(double first_step);
  bool is_singular() const { return arc_.is_singular(); }

  /// The next step from here(); nothing if there is none, and why_not() says what stands in the way. What is
  /// not wanted may be left out of the critical points on it.
  std::optional<PathLeg> next(const LookFor& wanted = {});
  /// The first step off along a direction from a critical point.
  std::optional<PathLeg> turn_off(const CriticalPoint& at, const Vector& mode);
  const std::string& why_not() const { return why_not_; }
  /// What stands in the way is a bond that would snap.
  bool stopped_by_a_bond() const { return snapping_; }
  /// Moves on to the end of a leg; the body is then there.
  void arrive(const PathLeg& leg);

  const PathPoint& here() const { return here_; }
  /// Of Newton's method, and of the tangent, so far.
  int iterations() const { return arc_.iterations(); }
  int factors() const { return arc_.factors(); }

 private:
  enum class Way { round_gaps, over_gaps, off_along_branch };
  std::optional<PathLeg> leg(PathStep step, double s, Way way);
  std::optional<PathNode> attempt(PathStep& step, double s, bool beware_of_dips);
  double look_at(const CriticalPoint& gap);
  PathLeg leg_over_gap();
  void forget_gap();
  double length_to(const CriticalPoint& gap) const;
  bool goes_over_known_gap(const PathPoint& start, const PathPoint& end) const;
  const CriticalPoint* first_wide_gap(const std::vector<CriticalPoint>& critical) const;
  void add_what_is_passed(PathLeg& leg);
  std::string objection(const PathStep& step, const PathNode& end, const PathDirection& deviation);
  double way_error(const PathStep& step, const PathNode& end, const PathDirection& deviation) const;
  void choose_next_step(const PathStep& step, const PathNode& end, int corrections);
  double longest(const PathDirection& d) const;

  StaticBody& body_;
  ArcLength arc_;
  double largest_step_;    // [length]
  double size_;            // of the body  [length]
  double shortest_ = 0;    // step  [arc-length]
  double next_ = 0;        // length of the next step  [arc-length]
  double load_scale_ = 0;  // largest |load factor| so far
  PathPoint here_;
  std::string why_not_;
  bool snapping_ = false;
  LookFor wanted_;
  std::optional<CriticalPoint> wide_gap_;  // ahead
  /// The last step over it, which is taken if there is no other way.
  struct OverGap {
    PathLeg leg;
    Softest soft_end;
    double next;
  };
  std::optional<OverGap> over_gap_;
  int looks_at_gap_ = 0;
  Softest soft_here_, soft_end_;  // at here_, and at the end of the last attempt
};

/// Starts a walk where its body stands. Throws NoEquilibrium if parts of the body can move freely, if nothing
/// is free to move or nothing changes with the load factor, if the tangent stiffness is singular, or as
/// TangentSolver::prepare() does.
const PathPoint& start_walk(const StaticBody& body, TangentSolver& solver, PathWalk& walk, double first_step);

/// Takes steps until one ends the search for critical loads, or it is interrupted.
template <class TakeStep>
void walk_until_ended(const PathWalk& walk, const StaticHooks& hooks, StaticResult& result,
                      const TakeStep& take_step) {
  while (result.ended.empty()) {
    result.searched_to = walk.here().at.load_factor;
    if (hooks.interrupted && hooks.interrupted())
      result.ended = "interrupted";
    else
      take_step();
  }
}

}  // namespace vbond
