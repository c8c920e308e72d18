#include "vbond/statics/detail/path_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vbond/statics/detail/deflated.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/statics/detail/rounding.hpp"

namespace vbond {

namespace {

// An eigenvalue this small beside its values at the ends of the step is taken for zero; the load factor is
// then worked out for zero itself, on a line through two looks. The line is off by its curvature times the
// product of their eigenvalues: where that is more than this, only one look is close, and another is taken at
// the zero of the line.
constexpr double small_eigenvalue = 1e-8, small_product = 1e-15;
// One that is larger where it changes its sign has jumped over zero.
constexpr double gap_of_eigenvalue = 1e-6;
// A path that turns by more than this at a critical point has turned off there  [rad]; where it is back is
// found to this part of the step.
constexpr double largest_turn_within = 0.8, width_of_turn = 1e-3;
// Zeros of several eigenvalues closer than this, over the length of the step, are one place.
constexpr double same_place = 1e-7;
// Stability on either side of a limit point is looked at this far from it, over the length of the step.
constexpr double aside = 1e-4;
// Where an eigenvalue is less than the first of these times its values at the ends of the step, balances are
// sought without a movement along its mode and those of eigenvalues below ten times as much, or below the
// second.
constexpr double near_to_zero = 1e-2, least_soft = 1e-3;
// If something drives these modes, the path itself is looked at on either side, so far away in parts of the
// load factor, nearer and nearer: there the eigenvalue must be as large as by its slope, but for the last. If
// it is so everywhere, there is no gap.
constexpr double parts_around[] = {largest_gap, 1e-5, 1e-6, 1e-7, 1e-8};
constexpr double bend_beside_gap = 0.25;
constexpr double sides[] = {-1.0, 1.0};

/// Where the value is zero on the line through the two looks that are nearest to that. Values are known to
/// `error`: a line through two that differ by little more is no guide beyond them.
PathStep::ZeroOfLine zero_of_line(std::vector<PathStep::Look> looks, double error) {
  using Look = PathStep::Look;
  std::stable_sort(looks.begin(), looks.end(),
                   [](const Look& a, const Look& b) { return std::abs(a.value) < std::abs(b.value); });
  const Look& a = looks.front();  // the same place may have been looked at twice
  const auto other = std::find_if(looks.begin(), looks.end(), [&](const Look& x) { return x.s != a.s; });
  const Look& b = other != looks.end() ? *other : a;
  const double rise = b.value - a.value, share = a.value / rise, product = std::abs(a.value * b.value);
  const double slope = rise / (b.s - a.s), load_slope = (b.load_factor - a.load_factor) / (b.s - a.s);
  const double farthest = std::abs(rise) > 100.0 * error ? 10.0 : 0.5;
  if (!(std::abs(share) < farthest)) return {a.s, a.load_factor, product, slope, load_slope};
  return {a.s - share * (b.s - a.s), a.load_factor - share * (b.load_factor - a.load_factor), product, slope,
          load_slope};
}

}  // namespace

std::string in_words(const CriticalPoint& c) {
  std::string text =
      fmt::format("{} at load factor {:.10g}",
                  c.kind == PointKind::limit_point ? "limit point" : "bifurcation", c.load_factor);
  if (c.gap > 0.0)
    text += fmt::format(
        " +- {:.1g} (the body is not quite symmetric: {})", c.gap,
        c.turns_off() ? "its path turns off along the branch" : "two paths pass each other there");
  return text;
}

StepOutcome PathStep::to(double s, bool end_of_step) {
  return arc_->step(start_.at, direction_, s, end_of_step);
}

std::optional<PathNode> PathStep::zero_of(const Value& value, const PathNode& lo, const PathNode& hi,
                                          double small) {
  PathNode last;
  const auto at = [&](double s) -> std::optional<double> {
    StepOutcome outcome = to(s);
    if (!outcome.point) return std::nullopt;
    last = {s, std::move(*outcome.point), std::move(outcome.residuals)};
    return value(last.point);
  };
  const Crossed crossed = crossing({lo.s, value(lo.point)}, {hi.s, value(hi.point)}, small, at);
  if (!crossed.found || (last.s != crossed.s && !at(crossed.s))) return {};
  return last;
}

std::optional<std::vector<CriticalPoint>> PathStep::critical_points(const PathNode& lo,
                                                                    const PathNode& end_of_step,
                                                                    const LookFor& wanted) {
  const Pulse::Work work("locating a critical point");
  wanted_ = wanted;
  const PathNode hi = up_to_goal(lo, end_of_step);
  std::vector<CriticalPoint> found;
  if (std::signbit(lo.point.tangent.f) == std::signbit(hi.point.tangent.f)) {
    if (!add_bifurcations(lo, hi, found)) return {};
    return found;
  }
  const std::optional<CriticalPoint> limit = limit_point(lo, hi);
  if (!limit) return {};
  PathNode before = limit->node, after = limit->node;
  before.point.unstable = limit->before;
  after.point.unstable = limit->after;
  if (!add_bifurcations(lo, before, found)) return {};
  found.push_back(*limit);
  if (wanted.beyond_limit_point && !add_bifurcations(after, hi, found)) return {};
  return found;
}

/// The end, or if a goal lies before it the place just beyond that.
PathNode PathStep::up_to_goal(const PathNode& lo, const PathNode& hi) {
  const bool nothing = hi.point.unstable == lo.point.unstable &&
                       std::signbit(lo.point.tangent.f) == std::signbit(hi.point.tangent.f);
  PathNode end = hi;
  if (nothing || !wanted_.goals) return end;
  for (const Goal& g : *wanted_.goals) {
    const auto beyond = [&g](const PathPoint& p) { return g.gap(p.at) - g.small; };
    if (!(g.gap(lo.point.at) < 0.0 && beyond(end.point) > g.small)) continue;
    if (std::optional<PathNode> at = zero_of(beyond, lo, end, g.small)) end = std::move(*at);
  }
  return end;
}

std::optional<CriticalPoint> PathStep::limit_point(const PathNode& lo, const PathNode& hi) {
  const auto slope = [](const PathPoint& p) { return p.tangent.f; };
  const double largest = std::max(std::abs(slope(lo.point)), std::abs(slope(hi.point)));
  // at 1e-8 of the slope at the ends the load factor is off by 1e-16 of its change
  std::optional<PathNode> node = zero_of(slope, lo, hi, 1e-8 * largest);
  if (!node) return {};
  CriticalPoint limit{PointKind::limit_point, std::move(*node)};
  limit.load_factor = limit.node.point.at.load_factor;
  if (std::abs(slope(limit.node.point)) > 1e-3 * largest)
    limit.gap = std::abs(hi.point.at.load_factor - lo.point.at.load_factor);
  const double step = hi.s - lo.s;
  limit.before = unstable_beside(limit.node.s, limit.node.s - aside * step, lo);
  limit.after = unstable_beside(limit.node.s, limit.node.s + aside * step, hi);
  limit.node.point.unstable = std::min(limit.before, limit.after);
  return limit;
}

/// Negative eigenvalues at s, beside a special place whose own number is left to rounding; those of `end` if
/// that is between the special place and s, or if nothing is found at s.
int PathStep::unstable_beside(double special, double s, const PathNode& end) {
  const bool within = special < end.s ? s < end.s : s > end.s;
  if (!within) return end.point.unstable;
  const StepOutcome outcome = to(s);
  return outcome.point ? outcome.point->unstable : end.point.unstable;
}

/// Each eigenvalue by its number, in increasing order, is a continuous function along the path: those whose
/// numbers lie between the numbers of negative ones at the ends have changed their sign.
bool PathStep::add_bifurcations(const PathNode& lo, const PathNode& hi, std::vector<CriticalPoint>& found) {
  if (!lo.point.has_potential || !hi.point.has_potential) return true;
  const bool softens = hi.point.unstable > lo.point.unstable;
  const int change = std::abs(hi.point.unstable - lo.point.unstable);
  std::vector<CriticalPoint> all;
  seen_.clear();
  may_hold_ = true;
  for (int k = 0; k < change; ++k) {
    const int number = softens ? lo.point.unstable + k : lo.point.unstable - 1 - k;
    // a higher eigenvalue does not vanish before a lower one, but may together with it
    const bool beyond = softens && k >= wanted_.losses;
    std::optional<CriticalPoint> zero = zero_of_eigenvalue(number, lo, hi, all, beyond);
    if (!zero && beyond) break;
    if (!zero) return false;
    all.push_back(std::move(*zero));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const CriticalPoint& a, const CriticalPoint& b) { return a.node.s < b.node.s; });
  seen_.clear();
  int unstable = lo.point.unstable;
  double last = -1.0;
  for (CriticalPoint& c : all) {
    const bool same = last >= 0.0 && c.node.s - last <= same_place * (hi.s - lo.s);
    last = c.node.s;
    c.before = unstable;
    c.after = unstable += softens ? 1 : -1;
    c.node.point.unstable = std::min(c.before, c.after);
    if (!same) {
      found.push_back(std::move(c));
      continue;
    }
    CriticalPoint& together = found.back();
    together.after = c.after;
    together.gap = std::max(together.gap, c.gap);
    together.node.point.unstable = std::min(together.before, together.after);
  }
  return true;
}

/// Brings a and b, with values of opposite signs, as near to each other as the looks of searches before this
/// one do.
void PathStep::narrow(int number, double small, Sample& a, Sample& b, std::vector<Look>& looks) const {
  const double low = std::min(a.s, b.s), high = std::max(a.s, b.s);
  std::vector<Look> known;
  for (const Seen& look : seen_)
    if (look.s > low && look.s < high && look.near.has(number) && std::abs(look.near.value(number)) > small)
      known.push_back({look.s, look.near.value(number), look.load_factor});
  std::sort(known.begin(), known.end(), [](const Look& x, const Look& y) { return x.s < y.s; });
  const bool a_first = a.s < b.s;
  Sample &first = a_first ? a : b, &second = a_first ? b : a;
  const bool sign = std::signbit(first.value);
  for (const Look& look : known) {
    looks.push_back(look);
    if (second.s <= look.s) continue;
    (std::signbit(look.value) == sign ? first : second) = {look.s, look.value};
  }
}

// The sign is told by the number of negative eigenvalues. At an end of the stretch another one may have just
// vanished, so that the number is not to be had from the matrix: there the size is no guide if it is small.
std::optional<CriticalPoint> PathStep::zero_of_eigenvalue(int number, const PathNode& lo, const PathNode& hi,
                                                          const std::vector<CriticalPoint>& known,
                                                          bool only_known) {
  const auto value = [this, number](const PathNode& n) {
    return std::copysign(eigenvalue(number, n, 0.0, false), number - n.point.unstable + 0.5);
  };
  Sample a{lo.s, value(lo)}, b{hi.s, value(hi)};
  const double scale = std::max(std::abs(a.value), std::abs(b.value));
  for (Sample* end : {&a, &b})
    end->value = std::copysign(std::max(std::abs(end->value), 0.01 * scale), end->value);
  std::vector<Look> looks = {{a.s, a.value, lo.point.at.load_factor},
                             {b.s, b.value, hi.point.at.load_factor}};
  const double error = eigenvalue_error(body_->tangent());
  const double small = std::max(small_eigenvalue * scale, error);
  for (const CriticalPoint& c : known)
    if (std::abs(eigenvalue(number, c.node, scale, false)) <= small) return c;
  if (only_known) return {};
  narrow(number, small, a, b, looks);
  PathNode last;
  const auto at = [&](double s) -> std::optional<double> {
    StepOutcome outcome = to_near_zero(number, s, scale);
    if (!outcome.point) return std::nullopt;
    last = {s, std::move(*outcome.point)};
    const std::optional<double> signed_value = arc_->eigenvalue(number);  // by multigrid
    const double found = signed_value ? *signed_value : eigenvalue(number, last, scale, true);
    // nearer to zero than a factor can tell the sign the eigenvalue itself is the better guide
    const bool counted = !signed_value && std::abs(found) > Deflated::zero(body_->tangent());
    looks.push_back({s, counted ? std::copysign(found, number - last.point.unstable + 0.5) : found,
                     last.point.at.load_factor});
    return looks.back().value;
  };
  const Crossed crossed = crossing(a, b, small, at);
  if (last.s != crossed.s && !at(crossed.s)) return {};
  const bool met = crossed.found && std::abs(looks.back().value) <= small;
  ZeroOfLine zero = zero_of_line(looks, error);
  const bool between = zero.s > std::min(lo.s, hi.s) && zero.s < std::max(lo.s, hi.s);
  if (met && between && zero.product > small_product * sq(scale) && at(zero.s))
    zero = zero_of_line(looks, error);
  double gap = 0.0;
  if (std::any_of(seen_.begin(), seen_.end(), [](const Seen& look) { return look.driven; })) {
    const std::optional<double> around = met ? gap_around(number, zero, scale) : std::nullopt;
    if (!around) {  // the body's own path alone, then
      may_hold_ = false;
      std::erase_if(seen_, [](const Seen& look) { return look.driven; });
      return zero_of_eigenvalue(number, lo, hi, known, only_known);
    }
    gap = *around;
  }
  CriticalPoint c{PointKind::bifurcation, std::move(last), zero.load_factor};
  const double change = std::abs(hi.point.at.load_factor - lo.point.at.load_factor);
  const double jump = std::max(std::abs(crossed.lo.value), std::abs(crossed.hi.value));
  if (!met && jump > std::max(gap_of_eigenvalue * scale, 100 * error)) c.gap = change * jump / scale;
  if (!crossed.found)  // between two paths that pass each other
    c.gap = std::max(c.gap, std::abs(change * (crossed.hi.s - crossed.lo.s) / (hi.s - lo.s)));
  if (met) c.gap = std::max(gap, gap_of_turn(lo, c.node, hi));
  return c;
}

/// Of a body that is driven along the modes held: how far from the zero its own path has the eigenvalue on
/// either side as the line has it. Nothing if it has not within the widest gap that is looked for.
std::optional<double> PathStep::gap_around(int number, const ZeroOfLine& zero, double scale) {
  std::optional<double> narrowest;
  for (const double part : parts_around) {
    if (part == largest_gap && held_together_ < 2) continue;
    const double gap = part * std::abs(zero.load_factor), away = gap / std::abs(zero.load_slope);
    if (!std::all_of(std::begin(sides), std::end(sides), [&](double side) {
          const StepOutcome outcome = to(zero.s + side * away);
          driven_ = false;
          if (!outcome.point) return false;
          const double by_slope = side * away * zero.slope;
          const double value = eigenvalue(number, {zero.s + side * away, *outcome.point}, scale, true);
          return std::abs(value - by_slope) <= bend_beside_gap * std::abs(by_slope);
        }))
      return narrowest;
    narrowest = gap;
  }
  return 0.0;
}

/// Where the path turns off at a critical point, but goes on as before at both ends of the step, it has gone
/// over to another path between: how far apart the load factors are where it turns. 0 if it does not turn.
double PathStep::gap_of_turn(const PathNode& lo, const PathNode& node, const PathNode& hi) {
  const auto turned = [this](const PathPoint& p) {
    return arc_->angle(direction_, p.tangent) - largest_turn_within;
  };
  double gap = 0.0;
  for (const PathNode* end : {&lo, &hi}) {
    if (turned(node.point) <= 0.0 || turned(end->point) > 0.0) continue;
    PathNode last = *end;
    const auto at = [&](double s) -> std::optional<double> {
      StepOutcome outcome = to(s);
      if (!outcome.point) return std::nullopt;
      const double value = turned(*outcome.point);
      if (value <= 0.0) last = {s, std::move(*outcome.point)};
      return value;
    };
    CrossingSearch<decltype(at)>(0.0, width_of_turn * (hi.s - lo.s), at)
        .between({node.s, turned(node.point)}, {end->s, turned(end->point)});
    gap = std::max(gap, std::abs(last.point.at.load_factor - node.point.at.load_factor));
  }
  return gap;
}

/// The eigenvalue with this number in increasing order, from 0. stands_there: the body does, on this balance.
double PathStep::eigenvalue(int number, const PathNode& node, double scale, bool stands_there) {
  const auto seen = std::find_if(seen_.begin(), seen_.end(),
                                 [&](const Seen& look) { return look.s == node.s && look.near.has(number); });
  if (seen != seen_.end()) return seen->near.value(number);
  if (!stands_there) body_->restore(node.point.at);
  if (const std::optional<double> value = arc_->eigenvalue(number)) return *value;
  seen_.push_back({node.s, node.point.at.load_factor, arc_->near_zero(number, node.point.unstable, scale),
                   stands_there && driven_});
  return seen_.back().near.value(number);
}

/// The balance at s. Next to where the eigenvalue is zero it is sought without a movement along the modes
/// that are about to lose their stiffness, unless they turn out to be driven.
StepOutcome PathStep::to_near_zero(int number, double s, double scale) {
  const Seen* nearest = nullptr;
  for (const Seen& look : seen_)
    if (look.near.has(number) &&
        (!nearest || std::abs(look.near.value(number)) < std::abs(nearest->near.value(number))))
      nearest = &look;
  const double value = nearest ? std::abs(nearest->near.value(number)) : scale;
  if (may_hold_ && value <= near_to_zero * scale) {
    const double soft = std::max(10.0 * value, least_soft * scale);
    const DenseMatrix modes = orthonormal(nearest->near.vectors_within(soft));
    StepOutcome outcome = arc_->step_beside(modes, start_.at, direction_, s);
    driven_ = outcome.driven;
    held_together_ = static_cast<int>(modes.cols());
    if (outcome.point) return outcome;
    may_hold_ = false;
  }
  driven_ = false;
  return to(s);
}

}  // namespace vbond
