#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/path_goal.hpp"
#include "vbond/statics/detail/path_walk.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/statics/detail/softest.hpp"

namespace vbond {

namespace {

/// Negative eigenvalues; nothing where they do not tell what is stable.
std::optional<int> unstable_at(const PathPoint& p) {
  return p.has_potential ? std::optional<int>(p.unstable) : std::nullopt;
}

/// Walks a path to one of its goals, and tells what lies on the way.
class PathStage {
 public:
  PathStage(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks,
            StaticResult& result);
  State run() &&;

 private:
  void start();
  void take_step();
  void sum_up();
  void go_along(const PathLeg& leg);
  const Goal* shorten_to_goal(PathStep& step, const PathNode& lo, PathNode& hi) const;
  void turn_off(const CriticalPoint& c);
  void end_at(const PathNode& end, const Goal& goal);

  void report(PointKind kind, std::optional<int> unstable);
  void report(const CriticalPoint& c);
  void tell_crossing(const PathLeg& leg) const;
  void refuse_branch_without_potential(const PathPoint& p) const;
  [[noreturn]] void give_up(const std::string& why) const;

  const StaticStage& stage_;
  const PathSettings& settings_;
  const StaticHooks& hooks_;
  StaticResult& result_;
  StaticBody body_;
  TangentSolver solver_;
  PathWalk walk_;
  std::vector<Goal> goals_;
  Placement reported_;    // the last point
  int bifurcations_ = 0;  // passed
  bool turned_off_ = false;
};

PathStage::PathStage(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks,
                     StaticResult& result)
    : stage_(stage),
      settings_(stage.path),
      hooks_(hooks),
      result_(result),
      body_(model, stage, std::move(state)),
      solver_(stage.newton.solver),
      walk_(body_, solver_, stage.newton, stage.path.largest_step),
      goals_(goals_of(stage.path)),
      reported_(body_.placement()) {}

State PathStage::run() && {
  try {
    start();
    while (result_.ended.empty()) take_step();
  } catch (const Interrupted&) {
    result_.ended = "interrupted";
    body_.restore(reported_);
  } catch (...) {
    sum_up();
    throw;
  }
  sum_up();
  tell_of_pressure(body_, hooks_);
  if (result_.ended == "interrupted") return std::move(body_).take_state();
  if (result_.unstable == 0)  // then the one nearest to zero is the smallest
    result_.smallest_eigenvalue = solver_.near_zero(body_, 1).values[0];
  return std::move(body_).take_state();
}

/// What the walk has taken, whichever way it ends.
void PathStage::sum_up() {
  result_.solver = solver_.name();
  result_.solver_iterations += solver_.iterations();
  result_.iterations += walk_.iterations();
  result_.factors = walk_.factors();
}

void PathStage::take_step() {
  if (hooks_.interrupted && hooks_.interrupted()) {
    result_.ended = "interrupted";
    return;
  }
  const std::optional<PathLeg> leg = walk_.next({.goals = &goals_});
  if (!leg) give_up(walk_.why_not());
  go_along(*leg);
}

void PathStage::start() {
  const PathPoint& here = start_walk(body_, solver_, walk_, settings_.first_step);
  refuse_branch_without_potential(here);
  report(PointKind::regular, unstable_at(here));
  for (const Goal& g : goals_) {
    if (g.gap(here.at) < 0.0) continue;
    if (!g.load_factor)
      result_.ended = g.name;
    else  // no mistake where the path comes back
      tell(stage_, hooks_,
           fmt::format(
               "load factor {:.6g} of stop is passed at the start: the path ends there only when it has "
               "been on the other side",
               *g.load_factor));
  }
}

/// To the end of the leg, unless something on it ends the path or takes it elsewhere.
void PathStage::go_along(const PathLeg& leg) {
  refuse_branch_without_potential(leg.end.point);
  PathStep step = leg.step;
  PathNode lo = leg.start;
  for (const CriticalPoint& c : leg.critical) {
    PathNode hi = c.node;
    if (const Goal* goal = shorten_to_goal(step, lo, hi)) return end_at(hi, *goal);
    report(c);
    if (!result_.ended.empty()) return;
    if (c.kind == PointKind::bifurcation && !c.turns_off() && settings_.branch && !turned_off_ &&
        ++bifurcations_ == settings_.branch->bifurcation)
      return turn_off(c);
    lo = c.node;
  }
  tell_crossing(leg);
  PathNode hi = leg.end;
  if (const Goal* goal = shorten_to_goal(step, lo, hi)) return end_at(hi, *goal);
  walk_.arrive(leg);
  result_.residuals = leg.end.residuals;
  report(PointKind::regular, unstable_at(leg.end.point));
}

/// The first goal between the nodes, to which the second is then moved; nothing if there is none.
const Goal* PathStage::shorten_to_goal(PathStep& step, const PathNode& lo, PathNode& hi) const {
  const Goal* reached = nullptr;
  for (const Goal& g : goals_) {
    const double beyond = g.gap(hi.point.at);
    if (!(g.gap(lo.point.at) < 0.0 && beyond >= 0.0)) continue;
    reached = &g;
    if (!(beyond > g.small)) continue;
    std::optional<PathNode> at =
        step.zero_of([&g](const PathPoint& p) { return g.gap(p.at); }, lo, hi, g.small);
    if (!at) give_up("no balance is found between two that are next to each other");
    hi = std::move(*at);
  }
  return reached;
}

/// Off along a mode of the critical point.
void PathStage::turn_off(const CriticalPoint& c) {
  const BranchSwitch& branch = *settings_.branch;
  if (branch.mode > c.together())
    throw NoEquilibrium(stage_.name,
                        fmt::format("mode {} of bifurcation {} is wanted, where {} become unstable at once",
                                    branch.mode, branch.bifurcation, c.together()),
                        fmt::format("choose a mode from 1 to {}", c.together()));
  body_.restore(c.node.point.at);
  const EigenPairs near = solver_.near_zero(body_, c.together());
  turned_off_ = true;
  const std::optional<PathLeg> leg =
      walk_.turn_off(c, std::copysign(1.0, branch.sense) * mode_of_cluster(near.vectors, branch.mode));
  if (!leg) give_up(walk_.why_not());
  go_along(*leg);
}

/// The last point. A load factor is met to the last bit: the balance is corrected at it.
void PathStage::end_at(const PathNode& end, const Goal& goal) {
  body_.restore(end.point.at);
  if (goal.load_factor) {
    body_.move(Vector::Zero(body_.unknowns().size()), *goal.load_factor);
    const NewtonOutcome outcome = correct(body_, solver_, stage_.newton);
    result_.iterations += outcome.iterations();
    result_.residuals = outcome.residuals;
    if (!outcome.converged) give_up(outcome.why);
  }
  report(PointKind::end, unstable_at(end.point));
  result_.ended = goal.name;
}

void PathStage::report(PointKind kind, std::optional<int> unstable) {
  result_.unstable = unstable;
  reported_ = body_.placement();
  report_point(body_, kind, unstable, hooks_, result_);
  if (result_.points >= settings_.most_points) result_.ended = "points";
}

/// At the point itself one eigenvalue or more are zero, not negative.
void PathStage::report(const CriticalPoint& c) {
  body_.restore(c.node.point.at);
  SpecialPoint special{c.kind, c.load_factor, 0, {}, {}, c.gap};
  std::string text = in_words(c);
  std::optional<int> unstable;
  if (c.node.point.has_potential) {
    special.unstable_before = c.before, special.unstable_after = c.after;
    unstable = std::min(c.before, c.after);
    text += fmt::format(": {} -> {} negative eigenvalues of the tangent", c.before, c.after);
  }
  report(c.kind, unstable);
  special.point = result_.points;
  result_.special_points.push_back(special);
  tell(stage_, hooks_, text);
}

/// Without a potential bifurcations are not located. What is seen of one is that the determinant of the
/// tangent changes its sign where the load factor does not turn back.
void PathStage::tell_crossing(const PathLeg& leg) const {
  const PathPoint &a = leg.start.point, &b = leg.end.point;
  const bool turns = std::signbit(a.tangent.f) != std::signbit(b.tangent.f);
  if ((a.has_potential && b.has_potential) || turns || a.sign * b.sign >= 0) return;
  tell(stage_, hooks_,
       fmt::format(
           "between load factors {:.6g} and {:.6g} the determinant of the tangent becomes {}: another "
           "path may cross there, which is not located, as {} no potential",
           a.at.load_factor, b.at.load_factor, b.sign < 0 ? "negative, and the balance unstable" : "positive",
           body_.has_free_cell()            ? "the stress on a cell that strains has"
           : body_.terms().without_energy() ? "pressure at a free edge has"
                                            : "moments from outside have"));
}

/// Without a potential bifurcations are not looked for, and the path would go past the one to turn off at.
void PathStage::refuse_branch_without_potential(const PathPoint& p) const {
  if (!settings_.branch || turned_off_ || p.has_potential) return;
  if (body_.has_free_cell())
    throw NoEquilibrium(
        stage_.name,
        "a bifurcation is wanted, but components of the cell give way to a stress, which has no potential",
        "strain the cell, or leave branch out");
  refuse_pressure_without_energy(body_);
  throw NoEquilibrium(
      stage_.name,
      fmt::format(
          "a bifurcation is wanted, but at load factor {:.6g} a moment from outside acts on particles "
          "that are free to turn, by a load or by a support that holds some of their turns",
          p.at.load_factor),
      "such a moment has no potential, and bifurcations under it are not found: apply a couple of forces, or "
      "leave branch out");
}

void PathStage::give_up(const std::string& why) const {
  throw NoEquilibrium(
      stage_.name,
      fmt::format("no balance found beyond point {} of the path, load factor {:.9g}: {}", result_.points,
                  result_.load_factor, why),
      "the points up to there stand; a smaller largest_step of the stage helps if the way is difficult");
}

}  // namespace

StaticOutcome follow_path(const Model& model, const StaticStage& stage, State state,
                          const StaticHooks& hooks) {
  return run_from_constant_loads(model, stage, std::move(state), hooks,
                                 [&](const StaticStage& from, State balanced, StaticResult& result) {
                                   return PathStage(model, from, std::move(balanced), hooks, result).run();
                                 });
}

}  // namespace vbond
