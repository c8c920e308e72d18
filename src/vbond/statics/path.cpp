#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/path_goal.hpp"
#include "vbond/statics/detail/path_step.hpp"
#include "vbond/statics/detail/softest.hpp"

namespace vbond {

namespace {

// A step is taken again at half its length if in it the path turns by more than this, a bond turns by more
// than this, or the load factor is further off the trapezoidal rule than this part of the slopes at both
// ends: then it has gone back and forth within the step. A cubic snap-through is found out below 1/6, however
// long the step. What is small against the load factors so far is let go.
constexpr double largest_path_turn = 0.6;   // [rad]
constexpr double largest_bond_turns = 0.2;  // [rad]; bonds have wrong rest states half a turn away
constexpr double largest_load_error = 0.15;
constexpr double least_load_error = 0.01;
// What the next step aims at.
constexpr double wanted_path_turn = 0.3;  // [rad]
constexpr double wanted_bond_turn = 0.1;  // [rad]
constexpr double wanted_corrections = 4;
// Of the body's size: the longest step unless told, and the shortest.
constexpr double automatic_step = 0.02;
constexpr double shortest_step = 1e-8;
// Stability on either side of a special point is looked at this far from it, over the length of the step.
constexpr double aside = 1e-4;
// On a branch it is further off: eigenvalues grow with the square of the distance, and shall be more than
// rounding.
constexpr double aside_on_branch = 1e-2;

double size_of(const State& state) {
  return box_around(state.r).diagonal();
}

/// Negative eigenvalues; nothing where they do not tell what is stable.
std::optional<int> unstable_at(const PathPoint& p) {
  return p.has_potential ? std::optional<int>(p.unstable) : std::nullopt;
}

class PathWalk {
 public:
  PathWalk(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks,
           StaticResult result);
  StaticOutcome walk() &&;

 private:
  void start();
  void take_step();
  void go_along(PathStep& step, const PathNode& start, const PathNode& end);
  bool pass(PathStep& step, const PathNode& start, const PathNode& end);
  PathNode advance(PathStep& step, double s);
  void arrive(const PathStep& step, const PathPoint& end);
  std::string objection(const PathStep& step, const PathNode& end) const;
  void choose_next_step(const PathStep& step, const PathNode& end, int corrections);
  double longest(const PathDirection& d) const;

  bool pass_between(PathStep& step, PathNode lo, PathNode hi);
  const Goal* shorten_to_goal(PathStep& step, const PathNode& lo, PathNode& hi);
  void turn_off(const PathNode& critical, int together);
  void end_at(const PathNode& end, const Goal& goal);

  PathNode found(std::optional<PathNode> node) const;
  void report(PointKind kind, std::optional<int> unstable);
  void report_special(PointKind kind, const PathNode& node, int before, int after);
  [[noreturn]] void refuse_start();
  void refuse_branch_without_potential(const PathPoint& p) const;
  [[noreturn]] void give_up(const std::string& why) const;

  const StaticStage& stage_;
  const PathSettings& settings_;
  const StaticHooks& hooks_;
  StaticResult result_;
  StaticBody body_;
  TangentSolver solver_;
  ArcLength arc_;
  std::vector<Goal> goals_;
  double size_;           // of the body  [length]
  double shortest_ = 0;   // step  [arc-length]
  double next_ = 0;       // length of the next step  [arc-length]
  double load_scale_;     // largest |load factor| so far
  PathPoint here_;        // where the path has come to
  int bifurcations_ = 0;  // passed
  bool turned_off_ = false;
};

PathWalk::PathWalk(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks,
                   StaticResult result)
    : stage_(stage),
      settings_(stage.path),
      hooks_(hooks),
      result_(std::move(result)),
      body_(model, stage, std::move(state)),
      solver_(stage.newton.solver),
      arc_(body_, solver_, stage.newton),
      goals_(goals_of(stage.path)),
      size_(size_of(body_.state())),
      load_scale_(std::abs(stage.path.first_step)) {}

StaticOutcome PathWalk::walk() && {
  start();
  while (result_.ended.empty()) {
    if (hooks_.interrupted && hooks_.interrupted())
      result_.ended = "interrupted";
    else
      take_step();
  }
  result_.solver = solver_.name();
  if (result_.unstable == 0)  // then the one nearest to zero is the smallest
    result_.smallest_eigenvalue = eigenpairs_near_zero(body_.tangent(), 1).values[0];
  return {std::move(result_), std::move(body_).take_state()};
}

void PathWalk::start() {
  refuse_rigid_motions(body_);
  const int size = body_.unknowns().size();
  if (size == 0) throw NoEquilibrium(stage_.name, "nothing is free to move", "hold fewer degrees of freedom");
  std::optional<PathPoint> point = arc_.point_here({Vector::Zero(size), 1.0});
  if (solver_.iterative())
    throw NoEquilibrium(stage_.name,
                        stage_.newton.solver == LinearSolver::iterative
                            ? "a path needs the direct solver"
                            : "a path needs the direct solver, and its factor does not fit into memory",
                        "use solver = \"direct\", follow the path of a smaller body, or use kind = "
                        "\"equilibrium\"");
  if (!point) refuse_start();
  here_ = std::move(*point);
  refuse_branch_without_potential(here_);
  if (settings_.first_step < 0.0) here_.tangent = {-here_.tangent.u, -here_.tangent.f};
  next_ = std::min(std::abs(settings_.first_step / here_.tangent.f), longest(here_.tangent));
  shortest_ = std::min(shortest_step * size_, 1e-3 * next_);
  report(PointKind::regular, unstable_at(here_));
  for (const Goal& g : goals_) {
    if (g.gap(here_.at) < 0.0) continue;
    if (!g.load_factor)
      result_.ended = g.name;
    else if (hooks_.tell)  // no mistake where the path comes back
      hooks_.tell(
          fmt::format("stage \"{}\": load factor {:.6g} of stop is passed at the start: the path ends "
                      "there only when it has been on the other side",
                      stage_.name, *g.load_factor));
  }
}

/// Why there is no tangent of the path at its start.
void PathWalk::refuse_start() {
  if (solver_.factor(body_))
    throw NoEquilibrium(stage_.name, "nothing changes with the load factor",
                        "give a load or a support that is in proportion to the load factor, on what is free");
  throw NoEquilibrium(
      stage_.name,
      "the tangent stiffness is singular at load factor 0, first of all in: " + softest_names(body_),
      "hold them, or give the bonds stiffness against them");
}

// ---- one step ----

void PathWalk::take_step() {
  PathStep step(body_, arc_, here_, here_.tangent);
  const PathNode end = advance(step, std::min(next_, longest(here_.tangent)));
  go_along(step, {0.0, step.start()}, end);
}

/// To the end of the step, unless something within it ends the path or takes it elsewhere.
void PathWalk::go_along(PathStep& step, const PathNode& start, const PathNode& end) {
  refuse_branch_without_potential(end.point);
  const bool goes_on = pass(step, start, end);
  result_.iterations += step.iterations();
  if (goes_on) arrive(step, end.point);
}

/// Reports what lies within the step. True if the path goes on at its end.
bool PathWalk::pass(PathStep& step, const PathNode& start, const PathNode& end) {
  if (std::signbit(start.point.tangent.f) == std::signbit(end.point.tangent.f))
    return pass_between(step, start, end);
  PathNode limit = found(step.limit_point(start, end));
  const int before = step.unstable_beside(limit, limit.s - aside * end.s, start);
  const int after = step.unstable_beside(limit, limit.s + aside * end.s, end);
  limit.point.unstable = before;
  if (!pass_between(step, start, limit)) return false;
  report_special(PointKind::limit_point, limit, before, after);
  limit.point.unstable = after;
  return result_.ended.empty() && pass_between(step, limit, end);
}

/// The end of the step, s long or, as long as there are objections, half as long as before.
PathNode PathWalk::advance(PathStep& step, double s) {
  for (;; s *= 0.5) {
    StepOutcome outcome = step.to(s);
    if (outcome.point) {
      PathNode end{s, std::move(*outcome.point)};
      outcome.why = objection(step, end);
      if (outcome.why.empty()) {
        choose_next_step(step, end, outcome.iterations);
        return end;
      }
    }
    if (0.5 * s < shortest_) give_up(outcome.why);
  }
}

void PathWalk::arrive(const PathStep& step, const PathPoint& end) {
  here_ = end;
  body_.restore(here_.at);
  load_scale_ = std::max(load_scale_, std::abs(here_.at.load_factor));
  result_.residuals = step.last_residuals();
  report(PointKind::regular, unstable_at(here_));
}

/// Why a step to where the body stands now may have left the path; empty if nothing speaks against it.
std::string PathWalk::objection(const PathStep& step, const PathNode& end) const {
  const Placement& from = step.start().at;
  const double turn = arc_.angle(step.direction(), end.point.tangent);
  if (turn > largest_path_turn) return fmt::format("the path turns by {:.2g} rad", turn);
  if (const auto k = newly_snapped(body_.state(), from)) {
    const Bond& b = body_.state().bonds[*k];
    return fmt::format("bond {} (particles {}, {}) snaps", k->value, b.i.value, b.j.value);
  }
  const double bonds = largest_bond_turn(body_.state(), from);
  if (bonds > largest_bond_turns) return fmt::format("a bond turns by {:.2g} rad", bonds);
  const double f0 = step.direction().f, f1 = end.point.tangent.f;
  const double error = std::abs(end.point.at.load_factor - from.load_factor - 0.5 * end.s * (f0 + f1));
  if (error > largest_load_error * end.s * (std::abs(f0) + std::abs(f1)) + least_load_error * load_scale_)
    return "the load factor goes back and forth";
  return "";
}

void PathWalk::choose_next_step(const PathStep& step, const PathNode& end, int corrections) {
  const double turn = arc_.angle(step.direction(), end.point.tangent);
  const double bonds = largest_bond_turn(body_.state(), step.start().at);
  const double growth =
      std::min({std::sqrt(wanted_corrections / std::max(1, corrections)),
                wanted_path_turn / std::max(turn, 1e-3), wanted_bond_turn / std::max(bonds, 1e-3)});
  next_ = end.s * std::clamp(growth, 0.5, 2.0);
}

/// The longest step in this direction: the particle that moves most goes as far as it may.  [arc-length]
double PathWalk::longest(const PathDirection& d) const {
  const double most = settings_.largest_step > 0.0 ? settings_.largest_step : automatic_step * size_;
  double largest2 = 0.0;
  const Unknowns& unknowns = body_.unknowns();
  for (const ParticleId p : body_.state().r.ids()) {
    Vec3d m;
    for (int k = 0; k < 3; ++k)
      if (const int at = unknowns.of(p, k); at != Unknowns::held) component(m, k) = d.u[at];
    largest2 = std::max(largest2, norm2(m));
  }
  for (const StaticSupport& support : stage_.supports)
    largest2 = std::max(largest2, sq(d.f) * norm2(support.displacement));
  return most / std::max(std::sqrt(largest2), 1e-3);
}

// ---- what lies within a step ----

/// The same from one node of the step to another between which the load factor does not turn back.
bool PathWalk::pass_between(PathStep& step, PathNode lo, PathNode hi) {
  const Goal* goal = shorten_to_goal(step, lo, hi);
  while (lo.point.has_potential && hi.point.has_potential && lo.point.unstable != hi.point.unstable) {
    PathNode critical = found(step.critical_point(lo, hi));
    const int before = lo.point.unstable;
    int after = step.unstable_beside(critical, critical.s + aside * (hi.s - lo.s), hi);
    if (after == before) after = hi.point.unstable;  // there and back so close by: all that is left at once
    report_special(PointKind::bifurcation, critical, before, after);
    if (!result_.ended.empty()) return false;
    ++bifurcations_;
    if (settings_.branch && !turned_off_ && bifurcations_ == settings_.branch->bifurcation) {
      turn_off(critical, std::abs(after - before));
      return false;
    }
    critical.point.unstable = after;
    lo = std::move(critical);
  }
  if (goal) end_at(hi, *goal);
  return goal == nullptr;
}

/// The first goal between the nodes, to which the second is then moved; nothing if there is none.
const Goal* PathWalk::shorten_to_goal(PathStep& step, const PathNode& lo, PathNode& hi) {
  const Goal* reached = nullptr;
  for (const Goal& g : goals_) {
    const double beyond = g.gap(hi.point.at);
    if (!(g.gap(lo.point.at) < 0.0 && beyond >= 0.0)) continue;
    reached = &g;
    if (beyond > g.small)
      hi = found(step.zero_of([&g](const PathPoint& p) { return g.gap(p.at); }, lo, hi, g.small));
  }
  return reached;
}

/// Off along a mode of the critical point: the direction is the part of the mode that is normal to the path
/// so far, so that the plane on which the first point is sought does not meet that path again. At the
/// critical point itself the branch's tangent and the signs of eigenvalues are left to rounding: those beside
/// it stand for them.
void PathWalk::turn_off(const PathNode& critical, int together) {
  const BranchSwitch& branch = *settings_.branch;
  if (branch.mode > together)
    throw NoEquilibrium(stage_.name,
                        fmt::format("mode {} of bifurcation {} is wanted, where {} become unstable at once",
                                    branch.mode, branch.bifurcation, together),
                        fmt::format("choose a mode from 1 to {}", together));
  body_.restore(critical.point.at);
  const EigenPairs near = eigenpairs_near_zero(body_.tangent(), together);
  PathDirection off{std::copysign(1.0, branch.sense) * mode_of_cluster(near.vectors, branch.mode), 0.0};
  const double along = arc_.dot(off, here_.tangent);
  off = arc_.unit({off.u - along * here_.tangent.u, off.f - along * here_.tangent.f});
  PathStep step(body_, arc_, critical.point, off);
  const PathNode end = advance(step, longest(off));
  turned_off_ = true;
  PathNode start{0.0, step.to(aside_on_branch * end.s).point.value_or(end.point)};
  start.point.at = critical.point.at;
  go_along(step, start, end);
}

/// The last point. A load factor is met to the last bit: the balance is corrected at it.
void PathWalk::end_at(const PathNode& end, const Goal& goal) {
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

PathNode PathWalk::found(std::optional<PathNode> node) const {
  if (!node) give_up("the tangent stiffness is singular");
  return std::move(*node);
}

// ---- what is told ----

void PathWalk::report(PointKind kind, std::optional<int> unstable) {
  result_.unstable = unstable;
  report_point(body_, kind, unstable, hooks_, result_);
  if (result_.points >= settings_.most_points) result_.ended = "points";
}

/// At the point itself one eigenvalue or more are zero, not negative.
void PathWalk::report_special(PointKind kind, const PathNode& node, int before, int after) {
  body_.restore(node.point.at);
  SpecialPoint special{kind, node.point.at.load_factor, 0, {}, {}};
  std::string text =
      fmt::format("{} at load factor {:.10g}", kind == PointKind::limit_point ? "limit point" : "bifurcation",
                  special.load_factor);
  std::optional<int> unstable;
  if (node.point.has_potential) {
    special.unstable_before = before, special.unstable_after = after;
    unstable = std::min(before, after);
    text += fmt::format(": {} -> {} negative eigenvalues of the tangent", before, after);
  }
  report(kind, unstable);
  special.point = result_.points;
  result_.special_points.push_back(special);
  if (hooks_.tell) hooks_.tell(text);
}

/// Without a potential bifurcations are not looked for, and the path would go past the one to turn off at.
void PathWalk::refuse_branch_without_potential(const PathPoint& p) const {
  if (!settings_.branch || turned_off_ || p.has_potential) return;
  throw NoEquilibrium(
      stage_.name,
      fmt::format(
          "a bifurcation is wanted, but at load factor {:.6g} a moment from outside acts on particles "
          "that are free to turn, by a load or by a support that holds some of their turns",
          p.at.load_factor),
      "such a moment has no potential, and bifurcations under it are not found: apply a couple of forces, or "
      "leave branch out");
}

void PathWalk::give_up(const std::string& why) const {
  throw NoEquilibrium(
      stage_.name,
      fmt::format("no balance found beyond point {} of the path, load factor {:.9g}: {}", result_.points,
                  result_.load_factor, why),
      "the points up to there stand; a smaller path.largest_step helps if the way is difficult");
}

}  // namespace

StaticOutcome follow_path(const Model& model, const StaticStage& stage, State state,
                          const StaticHooks& hooks) {
  StaticResult result;
  std::optional<State> balanced = balance_of_constant_loads(model, stage, state, hooks, result);
  if (!balanced) return interrupted_outcome(std::move(result), std::move(state));
  return PathWalk(model, stage, std::move(*balanced), hooks, std::move(result)).walk();
}

}  // namespace vbond
