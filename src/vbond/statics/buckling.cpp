#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/linear_buckling.hpp"
#include "vbond/statics/detail/path_walk.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/statics/detail/softest.hpp"
#include "vbond/statics/detail/wave_buckling.hpp"

namespace vbond {
namespace {

/// How far a linear estimate may be off the load found for its assumption to hold: that the tangent changes
/// in proportion to the load factor up to there.
constexpr double estimate_holds = 0.1;
/// The first step changes no bond by more than this, and goes no farther than this part of the first linear
/// estimate; later ones are chosen by the walk.
constexpr double first_bond_change = 0.1;
constexpr double first_part = 0.5;
/// Bonds longer or shorter than this times their length at rest are beyond any law.
constexpr double longest_bond = 2.0, shortest_bond = 0.5;
/// A bond within this part of the end of its law's range is at it: where torque or moment are largest the
/// body has a critical point of its law, which is found to less.
constexpr double at_the_end = 1e-6;

double largest_proportional_force(const Model& model, const StaticStage& stage) {
  double largest = 0.0;
  for (const PointLoad& l : stage.loads) {
    if (l.constant) continue;
    Vec3d total = static_cast<double>(l.particles.size()) * l.force;
    for (const ParticleId p : l.particles) total += model.mass[p] * l.force_by_mass;
    largest = std::max(largest, norm(total));
  }
  return largest;
}

bool beyond_its_law(const Bond& b, const State& s) {
  BondShape shape = bond_shape(b, bond_pose(b, s));
  shape.c_i -= at_the_end, shape.c_j -= at_the_end, shape.twist *= 1.0 + at_the_end;
  return bond_range(b, shape) != BondRange::good || shape.length > longest_bond * b.a ||
         shape.length < shortest_bond * b.a;
}

/// Walks the path from load factor 0 and lists the loads at which one more direction becomes unstable.
class CriticalLoads {
 public:
  CriticalLoads(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks,
                StaticResult& result)
      : stage_(stage),
        hooks_(hooks),
        result_(result),
        body_(model, stage, std::move(state)),
        solver_(stage.newton.solver),
        walk_(body_, solver_, stage.newton, stage.path.largest_step) {}

  /// The state at load factor 0.
  State run() &&;

 private:
  void start();
  void take_step();
  void add(const CriticalPoint& c);
  void add_reaction(CriticalLoad& found) const;
  void add_estimates();
  void sum_up();
  void refuse_moments() const;
  void end(const std::string& why, double searched_to) {
    result_.ended = why;
    result_.searched_to = searched_to;
  }
  void tell(const std::string& text) const { vbond::tell(stage_, hooks_, text); }
  bool wants_more() const { return static_cast<int>(result_.critical_loads.size()) < stage_.count; }

  const StaticStage& stage_;
  const StaticHooks& hooks_;
  StaticResult& result_;
  StaticBody body_;
  TangentSolver solver_;
  PathWalk walk_;
  std::vector<double> linear_;
};

State CriticalLoads::run() && {
  const Placement at_zero = body_.placement();
  try {
    start();
    walk_until_ended(walk_, hooks_, result_, [this] { take_step(); });
  } catch (const Interrupted&) {
    result_.ended = "interrupted";
  } catch (...) {
    sum_up();
    throw;
  }
  sum_up();
  result_.unstable = 0;
  body_.restore(at_zero);
  return std::move(body_).take_state();
}

void CriticalLoads::start() {
  refuse_moments();
  const PathPoint& here = start_walk(body_, solver_, walk_, 1.0);
  if (here.unstable > 0)
    throw NoEquilibrium(
        stage_.name,
        fmt::format(
            "at load factor 0, without the proportional loads, the body is not stable, first of all in: {}",
            softest_names(body_, solver_, here.unstable)),
        "hold it, or find a stable balance by an equilibrium stage before this one");
  result_.smallest_eigenvalue = solver_.near_zero(body_, 1).values[0];
  const Vector rate = here.tangent.u / here.tangent.f;
  linear_ = linear_critical_factors(body_, solver_, rate, stage_.count);
  double first = first_bond_change / body_.largest_bond_change(rate, 1.0);
  if (!linear_.empty()) first = std::min(first, first_part * linear_[0]);
  if (stage_.search_to > 0.0) first = std::min(first, stage_.search_to);
  walk_.start(first);
  report_point(body_, PointKind::regular, 0, hooks_, result_);
}

void CriticalLoads::take_step() {
  const std::optional<PathLeg> leg =
      walk_.next({stage_.count - static_cast<int>(result_.critical_loads.size()), false});
  if (!leg && walk_.stopped_by_a_bond()) return end("bond range", result_.searched_to);
  if (!leg)
    throw NoEquilibrium(
        stage_.name,
        fmt::format("no balance found beyond load factor {:.9g}: {}", result_.searched_to, walk_.why_not()),
        fmt::format(
            "{} critical load{} found up to there; a smaller largest_step of the stage helps if the way is "
            "difficult, and kind = \"path\" shows how stability changes",
            result_.critical_loads.size(), result_.critical_loads.size() == 1 ? " was" : "s were"));
  const double limit = stage_.search_to;
  for (const CriticalPoint& c : leg->critical) {
    if (limit > 0.0 && c.load_factor > limit) return end("load factor", limit);
    body_.restore(c.node.point.at);
    if (any_bond_beyond_its_law(body_.state())) return end("bond range", c.load_factor);
    add(c);
    if (!wants_more()) return end("converged", c.load_factor);
    if (c.kind == PointKind::limit_point) {
      tell(fmt::format(
          "the path has a limit point at load factor {:.8g}: critical loads beyond it are not looked "
          "for; kind = \"path\" follows what comes",
          c.load_factor));
      return end("limit point", c.load_factor);
    }
  }
  walk_.arrive(*leg);
  refuse_moments();
  const double here = body_.load_factor();
  report_point(body_, PointKind::regular, walk_.here().unstable, hooks_, result_);
  const State& state = body_.state();
  if (limit > 0.0 && here >= limit) return end("load factor", limit);
  if (any_bond_beyond_its_law(state)) return end("bond range", here);
  if (result_.points >= stage_.path.most_points) end("points", here);
}

/// One critical load for each eigenvalue that becomes negative; where they become positive again there is
/// none.
void CriticalLoads::add(const CriticalPoint& c) {
  body_.restore(c.node.point.at);
  if (c.after > c.before || c.kind == PointKind::limit_point || c.turns_off()) {
    const int together = std::max(1, c.together());
    const EigenPairs near = solver_.near_zero(body_, together);
    for (int k = 1; k <= together && wants_more(); ++k) {
      CriticalLoad& found = result_.critical_loads.emplace_back();
      found.kind = c.kind;
      found.load_factor = c.load_factor;
      found.force = c.load_factor * largest_proportional_force(body_.model(), stage_);
      found.mode = body_.unknowns().shape(mode_of_cluster(near.vectors, k));
      found.gap = c.gap;
      add_reaction(found);
    }
  }
  if (c.gap > 0.0) tell(in_words(c));
  report_point(body_, c.kind, std::min(c.before, c.after), hooks_, result_);
}

/// The body may stand next to the critical point, not at it: that shows in the last digits.
void CriticalLoads::add_reaction(CriticalLoad& found) const {
  const auto moved = std::find_if(stage_.supports.begin(), stage_.supports.end(), moves);
  if (moved == stage_.supports.end()) return;
  found.displacement = found.load_factor * way_of(*moved);
  found.reaction = body_.reaction_along_motion(*moved);
}

void CriticalLoads::add_estimates() {
  const std::size_t both = std::min(linear_.size(), result_.critical_loads.size());
  for (std::size_t k = 0; k < both; ++k) {
    CriticalLoad& c = result_.critical_loads[k];
    if (std::abs(linear_[k] - c.load_factor) <= estimate_holds * c.load_factor) c.estimate = linear_[k];
  }
}

/// What the search has taken, whichever way it ends.
void CriticalLoads::sum_up() {
  add_estimates();
  result_.solver = solver_.name();
  result_.solver_iterations += solver_.iterations();
  result_.iterations += walk_.iterations();
  result_.factors = walk_.factors();
}

void CriticalLoads::refuse_moments() const {
  refuse_pressure_without_energy(body_);
  if (body_.has_moment_part())
    throw NoEquilibrium(body_.stage().name,
                        fmt::format("at load factor {:.6g} a moment from outside acts on particles that are "
                                    "free to turn, by a load or by a support that holds some of their turns",
                                    body_.load_factor()),
                        "such a moment has no potential, and its critical value is not found by this stage: "
                        "apply a couple of forces, or follow the balance by kind = \"path\"");
}

}  // namespace

bool any_bond_beyond_its_law(const State& s) {
  return std::any_of(s.bonds.begin(), s.bonds.end(),
                     [&](const Bond& b) { return !b.broken && beyond_its_law(b, s); });
}

StaticOutcome find_critical_loads(const Model& model, const StaticStage& stage, State state,
                                  const StaticHooks& hooks) {
  return run_from_constant_loads(
      model, stage, std::move(state), hooks,
      [&](const StaticStage& from, State balanced, StaticResult& result) {
        if (!stage.waves.q.empty())
          return find_critical_waves(model, from, std::move(balanced), hooks, result);
        return CriticalLoads(model, from, std::move(balanced), hooks, result).run();
      });
}

}  // namespace vbond
