#include "vbond/statics/detail/path_walk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/bond_turns.hpp"
#include "vbond/statics/detail/kinds.hpp"
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
// The same for the whole way, over the length of the step: a smooth path goes between its directions at both
// ends, and a step that goes aside without turning has gone over to a path beside.
constexpr double largest_way_error = 0.1;
constexpr double least_load_error = 0.01;
// What the next step aims at.
constexpr double wanted_path_turn = 0.3;  // [rad]
constexpr double wanted_bond_turn = 0.1;  // [rad]
constexpr double wanted_corrections = 4;
// A gap up to this part of the load factor is reported as a bifurcation. Beyond it the path is only bent.
constexpr double widest_gap = 3e-3;
// Steps in which stability may be lost and regained are taken again down to this part of their length.
constexpr double shortest_beside_dips = 1.0 / 256;
constexpr const char* close_paths =
    "the path comes close to another one that crosses it, and no step tells them apart";
// A step that ends behind a wide gap is taken again to this part of the way to it.
constexpr double up_to_gap = 0.7;
// Seen from near, a gap may turn out narrower than from far away. After this many looks it is taken for as
// wide as it was seen.
constexpr int most_looks_at_gap = 8;
// Parts of the body's size: the longest step if largest_step is 0, and the shortest step.
constexpr double automatic_step = 0.02;
constexpr double shortest_step = 1e-10;
// At the start of a branch eigenvalues are zero to rounding. Stability there is counted at this part of the
// first step, where they are larger than rounding.
constexpr double aside_on_branch = 1e-2;

/// How far the edges of a cell go at most along a direction.  [length]
double way_of_edges(const StaticBody& body, const PathDirection& d) {
  double change = 0.0, longest = 0.0;
  for (std::size_t k = 0; k < 6; ++k) {
    const CellComponent& c = body.stage().cell.component[k];
    if (c.by == CellComponent::By::strain) change += std::abs(d.f * c.value);
    if (const int unknown = body.unknowns().of_cell(k); unknown != Unknowns::held)
      change += std::abs(d.u[unknown]) / body.unknowns().cell_length();
  }
  for (const CellEdge& e : body.state().cell) longest = std::max(longest, norm(e.along));
  return change * longest;
}

/// An eigenvalue that goes towards zero at the start of a step and away from it at the end may pass zero
/// twice between: so if the tangents at both ends meet beyond zero.
bool may_dip_below_zero(const Softest& start, const Softest& end, double s) {
  const double sign = start.value < 0.0 ? -1.0 : 1.0;
  const double a = sign * start.value, fall = -sign * start.rate, b = sign * end.value,
               rise = sign * end.rate;
  if (!(b > 0.0 && fall > 0.0 && rise > 0.0)) return false;
  const double meet = (a - b + rise * s) / (fall + rise);
  return meet > 0.0 && meet < s && a - fall * meet < 0.0;
}

}  // namespace

PathWalk::PathWalk(StaticBody& body, TangentSolver& solver, const NewtonSettings& newton, double largest_step)
    : body_(body), arc_(body, solver, newton), largest_step_(largest_step), size_(extent_of(body)) {}

const PathPoint* PathWalk::start(double first_step) {
  std::optional<PathPoint> point = arc_.point_here({Vector::Zero(body_.unknowns().size()), 1.0});
  if (!point) return nullptr;
  here_ = std::move(*point);
  if (std::signbit(here_.tangent.f) != std::signbit(first_step))
    here_.tangent = {-here_.tangent.u, -here_.tangent.f};
  soft_here_ = arc_.softest(here_.tangent);
  next_ = std::min(std::abs(first_step / here_.tangent.f), longest(here_.tangent));
  load_scale_ = next_ * std::abs(here_.tangent.f);
  shortest_ = std::min(shortest_step * size_, 1e-3 * next_);
  return &here_;
}

std::optional<PathLeg> PathWalk::next(const LookFor& wanted) {
  wanted_ = wanted;
  const PathStep step(body_, arc_, here_, here_.tangent);
  const double longest_here = longest(here_.tangent), s = std::min(next_, longest_here);
  std::optional<PathLeg> found = leg(step, s, Way::round_gaps);
  if (!found && wide_gap_ && !snapping_) {  // no way round the bend: over it, then
    found = leg(step, std::min(longest_here, std::max(s, length_to(*wide_gap_))), Way::over_gaps);
    if (!found && over_gap_) found = leg_over_gap();
    forget_gap();
  } else if (found && wide_gap_) {
    add_what_is_passed(*found);
  }
  return found;
}

/// A gap that was too wide to be stepped over is followed round the bend. If that brings nothing critical,
/// and the load factor goes on beyond the gap, the path has turned off along the branch.
void PathWalk::add_what_is_passed(PathLeg& leg) {
  const double f = wide_gap_->load_factor;
  if (std::any_of(leg.critical.begin(), leg.critical.end(), [&](const CriticalPoint& c) {
        return c.kind == PointKind::limit_point || std::abs(c.load_factor - f) <= wide_gap_->gap;
      }))
    return forget_gap();
  const double end_of_gap = f + std::copysign(wide_gap_->gap, leg.step.direction().f);
  const auto beyond = [end_of_gap](const PathPoint& p) { return p.at.load_factor - end_of_gap; };
  if (std::signbit(beyond(leg.start.point)) == std::signbit(beyond(leg.end.point))) return;
  const double small = 1e-12 * std::max(load_scale_, std::abs(f));
  if (wide_gap_->gap < widest_gap * std::abs(f)) {
    PathNode at = leg.step.zero_of(beyond, leg.start, leg.end, small).value_or(leg.end);
    const int unstable = at.point.unstable;
    leg.critical.push_back({PointKind::bifurcation, std::move(at), f, unstable, unstable, wide_gap_->gap});
    std::stable_sort(leg.critical.begin(), leg.critical.end(),
                     [](const CriticalPoint& a, const CriticalPoint& b) { return a.node.s < b.node.s; });
  }
  forget_gap();
}

/// The last step that went over the gap, from where it began, less what has been passed since.
PathLeg PathWalk::leg_over_gap() {
  PathLeg leg = std::move(over_gap_->leg);
  soft_end_ = over_gap_->soft_end, next_ = over_gap_->next;
  const double f = here_.at.load_factor, sense = leg.step.direction().f;
  std::erase_if(leg.critical, [&](const CriticalPoint& c) { return (c.load_factor - f) * sense <= 0.0; });
  return leg;
}

void PathWalk::forget_gap() {
  wide_gap_.reset();
  over_gap_.reset();
}

// The direction is the part of the mode that is normal to the path so far, so that the plane on which the
// first point is sought does not meet that path again.
std::optional<PathLeg> PathWalk::turn_off(const CriticalPoint& at, const Vector& mode) {
  over_gap_.reset();
  PathDirection off{mode, 0.0};
  const double along = arc_.dot(off, here_.tangent);
  off = arc_.unit({off.u - along * here_.tangent.u, off.f - along * here_.tangent.f});
  return leg(PathStep(body_, arc_, at.node.point, off), longest(off), Way::off_along_branch);
}

/// A step of length s or shorter, as short as must be.
std::optional<PathLeg> PathWalk::leg(PathStep step, double s, Way way) {
  const bool on_branch = way == Way::off_along_branch;
  const double shortest_for_dips = shortest_beside_dips * s;
  for (;;) {
    const bool last = 0.5 * s < shortest_;
    double next = 0.5 * s;
    std::optional<PathNode> end = attempt(step, s, !on_branch && s > shortest_for_dips && !last);
    if (end) {
      PathNode start{0.0, step.start()};
      // at a critical point tangent and signs are left to rounding: those beside it stand for them
      if (on_branch) start.point = step.to(aside_on_branch * s).point.value_or(end->point);
      start.point.at = step.start().at;
      if (!last && way != Way::over_gaps && goes_over_known_gap(start.point, end->point)) {
        why_not_ = close_paths;
        s = next;
        continue;
      }
      auto critical = step.critical_points(start, *end, wanted_);
      const CriticalPoint* gap = critical && way != Way::over_gaps ? first_wide_gap(*critical) : nullptr;
      why_not_ = gap ? close_paths : "no balance is found between two that are next to each other";
      if (critical && (!gap || last)) {
        return PathLeg{std::move(step), std::move(start), std::move(*end), std::move(*critical)};
      }
      if (gap) {
        next = std::min(next, std::max(look_at(*gap), shortest_));
        over_gap_ =
            OverGap{{step, std::move(start), std::move(*end), std::move(*critical)}, soft_end_, next_};
      }
    }
    if (last) return {};
    s = next;
  }
}

/// Remembers the narrowest look at the gap ahead. Returns the length of a step that ends before it.
double PathWalk::look_at(const CriticalPoint& gap) {
  looks_at_gap_ = wide_gap_ ? looks_at_gap_ + 1 : 1;
  if (!wide_gap_ || gap.gap < wide_gap_->gap) wide_gap_ = gap;
  return up_to_gap * gap.node.s;
}

/// The length of a step that goes well beyond a gap, by the rate of the load factor here.
double PathWalk::length_to(const CriticalPoint& gap) const {
  const double ahead = std::abs(gap.load_factor - here_.at.load_factor) + gap.gap;
  return 4.0 * ahead / std::max(std::abs(here_.tangent.f), 1e-300);
}

/// True if the step goes over the gap already known. Then the search for it, which takes many balances, is
/// left out.
bool PathWalk::goes_over_known_gap(const PathPoint& start, const PathPoint& end) const {
  if (!wide_gap_ || looks_at_gap_ < most_looks_at_gap || start.unstable == end.unstable) return false;
  const double f = wide_gap_->load_factor;
  return std::signbit(start.tangent.f) == std::signbit(end.tangent.f) &&
         (start.at.load_factor < f) == (f < end.at.load_factor);
}

const CriticalPoint* PathWalk::first_wide_gap(const std::vector<CriticalPoint>& critical) const {
  for (const CriticalPoint& c : critical)
    if (c.gap > largest_gap * std::max(load_scale_, std::abs(c.load_factor))) return &c;
  return nullptr;
}

/// The end of a step of length s if nothing speaks against it; else why_not() says what does.
std::optional<PathNode> PathWalk::attempt(PathStep& step, double s, bool beware_of_dips) {
  StepOutcome outcome = step.to(s, true);
  why_not_ = outcome.why;
  snapping_ = false;
  if (!outcome.point) return {};
  PathNode end{s, std::move(*outcome.point), std::move(outcome.residuals)};
  why_not_ = objection(step, end, outcome.deviation);
  if (!why_not_.empty()) return {};
  choose_next_step(step, end, outcome.iterations);
  soft_end_ = arc_.softest(end.point.tangent);
  const bool same_count = end.point.unstable == step.start().unstable;
  if (beware_of_dips && same_count && may_dip_below_zero(soft_here_, soft_end_, s)) {
    why_not_ = "stability may be lost and regained";
    return {};
  }
  return end;
}

void PathWalk::arrive(const PathLeg& leg) {
  here_ = leg.end.point;
  soft_here_ = soft_end_;
  body_.restore(here_.at);
  load_scale_ = std::max(load_scale_, std::abs(here_.at.load_factor));
}

/// Why a step to where the body stands now may have left the path; empty if nothing speaks against it.
std::string PathWalk::objection(const PathStep& step, const PathNode& end, const PathDirection& deviation) {
  const Placement& from = step.start().at;
  const double turn = arc_.angle(step.direction(), end.point.tangent);
  if (!(turn <= largest_path_turn)) return fmt::format("the path turns by {:.2g} rad", turn);
  const auto k = newly_snapped(body_.state(), from);
  snapping_ = k.has_value();
  if (k) {
    const Bond& b = body_.state().bonds[*k];
    return fmt::format("bond {} (particles {}, {}) snaps", k->value, b.i.value, b.j.value);
  }
  const double bonds = largest_bond_turn(body_.state(), from);
  if (!(bonds <= largest_bond_turns)) return fmt::format("a bond turns by {:.2g} rad", bonds);
  const double f0 = step.direction().f, f1 = end.point.tangent.f;
  const double error = std::abs(end.point.at.load_factor - from.load_factor - 0.5 * end.s * (f0 + f1));
  if (!(error <= largest_load_error * end.s * (std::abs(f0) + std::abs(f1)) + least_load_error * load_scale_))
    return "the load factor goes back and forth";
  if (!(way_error(step, end, deviation) <= largest_way_error)) return "the step goes aside to another path";
  return "";
}

/// How far the way from start to end is off the mean of the directions there, as long in the direction of the
/// step, over the length of the step.
double PathWalk::way_error(const PathStep& step, const PathNode& end, const PathDirection& deviation) const {
  const PathDirection &from = step.direction(), &to = end.point.tangent;
  const double along = end.s / (1.0 + arc_.dot(from, to));
  const PathDirection error{deviation.u + (end.s - along) * from.u - along * to.u,
                            deviation.f + (end.s - along) * from.f - along * to.f};
  return std::sqrt(arc_.dot(error, error)) / end.s;
}

void PathWalk::choose_next_step(const PathStep& step, const PathNode& end, int corrections) {
  const double turn = arc_.angle(step.direction(), end.point.tangent);
  const double bonds = largest_bond_turn(body_.state(), step.start().at);
  const double growth =
      std::min({std::sqrt(wanted_corrections / std::max(1, corrections)),
                wanted_path_turn / std::max(turn, 1e-3), wanted_bond_turn / std::max(bonds, 1e-3)});
  next_ = end.s * std::clamp(growth, 0.5, 2.0);
}

/// The longest step in this direction: the particle that moves most, a turn counted times the length scale,
/// goes as far as it may.  [arc-length]
double PathWalk::longest(const PathDirection& d) const {
  const double most = largest_step_ > 0.0 ? largest_step_ : automatic_step * size_;
  double largest2 = std::max(sq(way_of_edges(body_, d)), sq(d.f * body_.imposed_strain() * size_));
  const Unknowns& unknowns = body_.unknowns();
  for (const ParticleId p : body_.state().r.ids()) {
    const Movement m = unknowns.movement(p, d.u);
    largest2 = std::max({largest2, norm2(m.shift), norm2(m.turn)});
  }
  for (const Support& support : body_.stage().supports) {
    largest2 = std::max({largest2, sq(d.f) * norm2(support.velocity),
                         sq(d.f * unknowns.length()) * norm2(support.angular_velocity)});
    for (const ParticleId p : support.particles)
      if (support.rigid) largest2 = std::max(largest2, sq(d.f) * norm2(body_.rate_of(support, p)));
  }
  return most / std::max(std::sqrt(largest2), 1e-3);
}

const PathPoint& start_walk(const StaticBody& body, TangentSolver& solver, PathWalk& walk,
                            double first_step) {
  const std::string& name = body.stage().name;
  refuse_nothing_free(body);
  refuse_rigid_motions(body);
  solver.prepare(body);
  const PathPoint* here = walk.start(first_step);
  if (walk.is_singular())
    throw NoEquilibrium(
        name,
        "the tangent stiffness is singular at load factor 0, first of all in: " + softest_names(body, solver),
        "hold them, or give the bonds stiffness against them");
  if (!here)
    throw NoEquilibrium(name, "nothing changes with the load factor",
                        "give a load or a support that is in proportion to the load factor, on what is free");
  return *here;
}

}  // namespace vbond
