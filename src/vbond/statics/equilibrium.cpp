// Balances from load factor 0 to 1: LoadSteps::run and what it calls, in this order.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/saddle.hpp"
#include "vbond/statics/detail/work.hpp"
#include "vbond/terms/walls/detail/rest_walls.hpp"

namespace vbond {
namespace {

int snapped_bonds(const State& s) {
  int snapped = 0;
  for (const BondId k : s.bonds.ids())
    snapped += bond_range(s.bonds[k], bond_shape(s, k)) == BondRange::snapped;
  return snapped;
}

/// A load step: where it began, where the tangent there says that it ends, and how much of the load factor
/// that is.
struct Way {
  Placement from, predicted;
  double length = 0;
  int snapped = 0;        ///< bonds, at the start
  bool foreseen = false;  ///< the body was stable at the start, so that there is a prediction
  bool jumped = false;    ///< the body did, and that has been told
};

/// Walks the load factor from 0 to 1.
class LoadSteps {
 public:
  LoadSteps(StaticBody& body, const StaticHooks& hooks, StaticResult& result)
      : body_(body), hooks_(hooks), result_(result), solver_(body.stage().newton.solver) {}

  /// Balance after balance. A load step that leads to none, or to one that the body would not come to, is
  /// taken back, and tried with half its length.
  void run() {
    begin();
    while (body_.load_factor() < 1.0) {
      Way way = predict();                         // the load step, along the tangent
      const bool accepted = find_balance(way) &&   // residual, tangent, solution, line search: newton.cpp
                            came_smoothly(way) &&  // stability; no jump
                            closes(way) &&         // the work on the way is what bonds have taken up
                            leave_saddles(way);    // downhill, where the balance is unstable
      if (interrupted_) return stop_at(way.from);
      if (accepted)
        go_on_from_here();  // books, and what is told of a point
      else
        retry(way);
    }
    judge_the_last();
    result_.ended = "converged";
  }
  const TangentSolver& solver() const { return solver_; }

 private:
  /// The first point: where the body comes from.
  void begin() {
    try {
      judge();
    } catch (const NoConvergence&) {  // only told here: what it is like under load is what counts
      stability_.unstable.reset();
    }
    report_point(body_, PointKind::regular, stability_.unstable, hooks_, result_);
    if (body_.terms().of<RestWalls>().moves() || body_.flows()) before_ = stand_of(body_);
  }

  /// Of the load factors that the stage asks for, k / steps.
  double next_mark() const {
    const double steps = std::max(1, body_.stage().steps);
    return (std::floor(body_.load_factor() * steps + 1e-9) + 1.0) / steps;
  }

  /// Along the tangent, at most by step_ of the load factor and not past the next mark.
  Way predict() {
    Way way{body_.placement(), {}, 0, snapped_bonds(body_.state())};
    const double now = body_.load_factor(), mark = next_mark();
    double step = std::min(step_, mark - now);
    Vector x = Vector::Zero(body_.unknowns().size());
    const bool at_hand = std::exchange(factored_here_, false);
    if (solver_.factors_full(body_) || at_hand || solver_.factor_definite(body_)) {
      const Vector predicted = solver_.solve_full(body_, body_.load_direction());
      way.foreseen = predicted.size() == x.size() && predicted.allFinite();
      if (way.foreseen) x = predicted;
    }
    const double change = body_.largest_bond_change(x);
    if (std::isfinite(change) && change * step > largest_prediction) step = largest_prediction / change;
    while (body_.largest_change_of_terms(step * x, step) > largest_prediction) step *= 0.5;
    body_.move(step * x, now + step > mark - 1e-12 ? mark : now + step);
    way.predicted = body_.placement();
    way.length = step;
    return way;
  }

  /// False where there is none near by, or only one with more bonds that have snapped over. If steps have
  /// become so short that there is no other way one is looked for far off as well, and then without the
  /// relief.
  bool find_balance(Way& way) {
    const bool last_resort = step_ < 1e-4 * longest_;
    outcome_ = settle(last_resort ? Reach::far : Reach::near);
    if (const auto fault = body_.fault_of_terms()) outcome_.converged = false, outcome_.why = *fault;
    interrupted_ = outcome_.interrupted;
    if (interrupted_) return false;
    if (last_resort && !outcome_.converged &&
        !let_go(way, fmt::format("beyond load factor {:.6g} no balance was found", way.from.load_factor))) {
      if (interrupted_) return false;
      give_up_beyond(way);
    }
    return outcome_.converged && (last_resort || snapped_bonds(body_.state()) <= way.snapped);
  }

  NewtonOutcome settle(Reach reach) {
    return vbond::settle(body_, solver_, body_.stage().newton, hooks_.interrupted, result_.iterations, reach);
  }

  /// The last resort: drops the relief and looks for a balance again, from the last one on. The relief is no
  /// load. It keeps its direction, and may push for ever what has come off the place where it was in balance.
  /// False: no relief is left, or there is no balance without it either. `found` is what was found with it.
  bool let_go(Way& way, const std::string& found) {
    constexpr int patience = 5;  // what comes off goes far
    constexpr double felt = 10;  // times what a balance may leave
    const NewtonOutcome before = outcome_;
    body_.restore(way.from);
    if (!(body_.relief_here() > felt * body_.stage().newton.tolerance)) return false;
    StaticBody::Relief relief = body_.relieve({});
    const Vector stays = Vector::Zero(body_.unknowns().size());
    const double now = body_.load_factor(), mark = next_mark();
    double step = mark - now;
    while (larger(body_.largest_bond_change(stays, step), body_.largest_change_of_terms(stays, step)) >
           largest_prediction)
      step *= 0.5;
    body_.move(stays, now + step > mark - 1e-12 ? mark : now + step);
    NewtonSettings settings = body_.stage().newton;
    settings.iterations *= patience;
    outcome_ = vbond::settle(body_, solver_, settings, hooks_.interrupted, result_.iterations, Reach::far);
    if (const auto fault = body_.fault_of_terms()) outcome_.converged = false, outcome_.why = *fault;
    interrupted_ = outcome_.interrupted;
    if (!outcome_.converged) {
      outcome_ = before;
      body_.relieve(std::move(relief));
      return false;
    }
    step_ = larger(step_, step);
    judge();
    jumped_ = way.jumped = true;
    tell(fmt::format(
        "{} beside the forces that were out of balance at the start, which fade: the body went back to load "
        "factor {:.6g}, was let go without them, and jumped by up to {:.3g}",
        found, way.from.load_factor, distance_to_here(way.from)));
    return true;
  }

  void judge() {
    stability_ = judge_stability(body_, solver_);
    factored_here_ = stability_.definite;
  }

  /// Judges the balance. False if the body has jumped there and a shorter step may tell where from.
  bool came_smoothly(Way& way) {
    judge();
    if (way.jumped || !may_be_a_jump(way)) return true;
    const bool back = comes_back(way.from);
    if (interrupted_ || (back && is_long(way))) return false;  // the jump may be in one half of the step
    if (!back) tell_jump(way);
    judge();
    return true;
  }

  bool is_long(const Way& way) const { return way.length > longest_ / 64; }

  /// Whether balance lies far from where the tangent at the start, or the one here, says that it should be. A
  /// smooth step goes as far as both say, but for its curvature: twice as far is no such step.
  bool may_be_a_jump(const Way& way) {
    constexpr double far = 2.0, rounding = 1e-9;
    if (!way.foreseen) return false;
    const Placement here = body_.placement();
    const double went = distance_to_here(way.from);
    if (went <= rounding * body_.unknowns().length()) return false;
    if (went > far * distance(way.from, way.predicted, body_.unknowns().length())) return true;
    if (!stability_.definite && !solver_.factors_full(body_)) return false;
    const Vector x = solver_.solve_full(body_, body_.load_direction());
    if (x.size() == 0) return false;
    body_.move((way.from.load_factor - here.load_factor) * x, way.from.load_factor);
    const double expected = distance_to_here(here);
    body_.restore(here);
    return went > far * expected;
  }

  double distance_to_here(const Placement& p) const {
    return distance(p, body_.placement(), body_.unknowns().length());
  }

  /// Whether the body goes back to where it came from when the load does. One that has moved on from stable
  /// balance to stable balance does, to the tolerance of balance: a part in a thousand of the way is more
  /// than that, and less than any jump.
  bool comes_back(const Placement& from) {
    constexpr double same = 1e-3;
    const Placement here = body_.placement();
    const double went = distance_to_here(from);
    body_.move(Vector::Zero(body_.unknowns().size()), from.load_factor);
    const NewtonOutcome back = settle(Reach::near);
    const bool same_place = !back.converged || distance_to_here(from) <= same * went;
    body_.restore(here);
    interrupted_ = back.interrupted;
    return same_place;
  }

  void tell_jump(Way& way) {
    jumped_ = way.jumped = true;
    tell(fmt::format(
        "between load factors {:.6g} and {:.6g} the body jumped, in a step that moved it by up to "
        "{:.3g}: taken back to the first it does not come back; kind = \"path\" follows what "
        "lies between",
        way.from.load_factor, body_.load_factor(), distance_to_here(way.from)));
  }

  /// Whether what bonds that flow have stored and dissipated in a step is the work on the way, or, where it
  /// may not be shorter, is told not to be. A jump that leads to where the tangent may well have led shows by
  /// that.
  bool closes(const Way& way) {
    constexpr double part = 0.01;
    if (!body_.flows() || way.jumped) return true;
    const double missing = work_.missing(before_, stand_of(body_), part);
    factored_here_ = false;
    if (missing == 0.0) return true;
    if (is_long(way)) return false;
    if (!std::exchange(told_missing_, true))
      tell(fmt::format(
          "between load factors {:.6g} and {:.6g} bonds store and dissipate less or more than the "
          "work, by {:.2g} of it: the body may have jumped, or flows in steps that are too long; "
          "more steps (steps = {}) make them shorter",
          way.from.load_factor, body_.load_factor(), missing, 4 * std::max(1, body_.stage().steps)));
    return true;
  }

  /// Unless the stage wants an unstable balance kept. False: no other is found, but a shorter step may come
  /// to one.
  bool leave_saddles(Way& way) {
    constexpr int most_tries = 3;
    const bool may_fail = body_.flows() && is_long(way);
    for (int k = 0; k < most_tries && stability_.unstable.value_or(0) > 0; ++k) {
      if (body_.stage().at_saddle == AtSaddle::keep) break;
      if (!leave_saddle(way, may_fail)) return false;
    }
    return true;
  }

  /// Downhill, or back and then on without the relief. If it may not fail and does, the unstable balance is
  /// the last point.
  bool leave_saddle(Way& way, bool may_fail) {
    const Placement saddle = body_.placement();
    const int unstable = stability_.unstable.value();
    outcome_ = vbond::leave_saddle(body_, solver_, stability_, hooks_.interrupted, result_.iterations);
    if (!outcome_.converged && !outcome_.interrupted) go_downhill_from(way.from, saddle.load_factor);
    factored_here_ = stability_.definite;
    interrupted_ = outcome_.interrupted;
    if (interrupted_ || (!outcome_.converged && may_fail)) return false;
    if (!outcome_.converged) {
      const std::string found =
          fmt::format("the balance at load factor {:.6g} is unstable, and none was found downhill from it",
                      saddle.load_factor);
      if (let_go(way, found + ",")) return true;
      if (interrupted_) return false;
      body_.restore(saddle);
      report_point(body_, PointKind::regular, unstable, hooks_, result_);
      give_up(fmt::format("{}: {}", found, outcome_.why));
    }
    result_.left_saddle = true;
    tell(fmt::format(
        "load factor {:.6g}: the balance is unstable ({} negative eigenvalues of the tangent) and "
        "was left along its lowest mode; the next one downhill is up to {:.3g} away",
        saddle.load_factor, unstable, distance_to_here(saddle)));
    return true;
  }

  /// Where it came from under this load: a way downhill that need not pass the unstable balance.
  void go_downhill_from(const Placement& from, double load_factor) {
    body_.restore(from);
    body_.move(Vector::Zero(body_.unknowns().size()), load_factor);
    const NewtonOutcome there = minimise(body_, solver_, body_.stage().newton, hooks_.interrupted);
    result_.iterations += there.iterations();
    if (there.converged) judge();
    if (there.interrupted || (there.converged && stability_.unstable.value_or(0) == 0)) outcome_ = there;
  }

  void stop_at(const Placement& last_balance) {
    body_.restore(last_balance);
    result_.ended = "interrupted";
  }

  /// Back, for a step half as long.
  void retry(const Way& way) {
    body_.restore(way.from);
    factored_here_ = false;
    step_ = 0.5 * std::min(step_, way.length);
  }

  /// The next point.
  void go_on_from_here() {
    add_work_of_walls();
    result_.residuals = outcome_.residuals;
    result_.unstable = stability_.unstable;
    result_.neutral = stability_.neutral;
    result_.jumped = jumped_;
    if (stability_.neutral) tell_neutral();
    tell_of_moments();
    report_point(body_, body_.load_factor() < 1.0 ? PointKind::regular : PointKind::end, stability_.unstable,
                 hooks_, result_);
    if (body_.flows() && !body_.terms().of<RestWalls>().moves()) before_ = stand_of(body_);
    step_ = std::min(longest_, 2.0 * step_);
  }

  /// What walls have done since the last balance.
  void add_work_of_walls() {
    if (!body_.terms().of<RestWalls>().moves()) return;
    Stand now = stand_of(body_);
    largest_energy_ = std::max({largest_energy_, std::abs(before_.stored), std::abs(now.stored)});
    const Vector work = work_.between(before_, now, largest_energy_);
    factored_here_ = false;
    body_.terms().of<RestWalls>().add_work(work.tail(now.power_of_walls.size()));
    before_ = std::move(now);
  }

  void judge_the_last() {
    result_.smallest_eigenvalue = smallest_eigenvalue(body_, solver_, stability_);
    if (!result_.smallest_eigenvalue || result_.neutral) return;
    result_.neutral = is_neutral(body_, stability_, *result_.smallest_eigenvalue);
    if (result_.neutral) tell_neutral();
  }

  /// What is known of a balance whose moments from outside have no potential.
  void tell_of_moments() {
    if (stability_.unstable || !stability_.diverges || std::exchange(told_divergence_, true)) return;
    tell(
        fmt::format("load factor {:.6g}: the determinant of the tangent is negative: the balance is "
                    "unstable, and is kept: {} no potential that would show a way down from it",
                    body_.load_factor(),
                    body_.friction_part() > 0.0      ? "friction of cracked bonds has"
                    : body_.terms().without_energy() ? "pressure at a free edge has"
                                                     : "moments of fixed direction have"));
  }

  void tell_neutral() const {
    const EigenPairs zero = stability_.lowest ? *stability_.lowest : eigenpairs_near_zero(body_.tangent(), 1);
    tell(fmt::format("load factor {:.6g}: the balance is neutral, some motion meets no stiffness: {}",
                     body_.load_factor(), body_.unknowns().names_of_largest(zero.vectors.col(0))));
  }

  void tell(const std::string& text) const { vbond::tell(body_.stage(), hooks_, text); }

  [[noreturn]] void give_up_beyond(const Way& way) {
    body_.restore(way.from);
    const std::string loose = free_motions_in_words(body_), of_cell = loose_cell_in_words(body_);
    give_up(fmt::format("no balance found beyond load factor {:.6g}: {}{}{}", way.from.load_factor,
                        outcome_.why, loose.empty() ? "" : "; " + loose, of_cell));
  }

  [[noreturn]] void give_up(const std::string& finding) const {
    throw NoEquilibrium(
        body_.stage().name, finding,
        "the body may not carry this load (kind = \"path\" follows it past a limit point); more steps, or a "
        "larger newton.iterations, help where the way is only difficult");
  }

  StaticBody& body_;
  const StaticHooks& hooks_;
  StaticResult& result_;
  TangentSolver solver_;
  WorkOnTheWay work_{body_, solver_, result_};
  const double longest_ = 1.0 / std::max(1, body_.stage().steps);
  double step_ = longest_;      // how much of the load factor to try next
  NewtonOutcome outcome_;       // of the balance at hand
  Stability stability_;         // and what the tangent says of it
  bool factored_here_ = false;  // the solver's factor is still that of its tangent
  bool interrupted_ = false;
  bool jumped_ = false;        // so far
  bool told_missing_ = false;  // work
  bool told_divergence_ = false;
  Stand before_;               // the last balance, where walls move or bonds flow
  double largest_energy_ = 0;  // so far
};

}  // namespace

StaticOutcome find_equilibrium(const Model& model, const StaticStage& stage, State state,
                               const StaticHooks& hooks) {
  StaticBody body(model, stage, std::move(state));
  refuse_not_finite(body);
  refuse_rigid_motions(body);
  body.relieve();
  StaticOutcome outcome;
  LoadSteps steps(body, hooks, outcome.result);
  steps.run();
  tell_of_pressure(body, hooks);
  outcome.result.solver = steps.solver().name();
  outcome.result.solver_iterations = steps.solver().iterations();
  outcome.state = std::move(body).take_state();
  return outcome;
}

std::optional<Balanced> balance_of_constant_loads(const Model& model, const StaticStage& stage, State state,
                                                  const StaticHooks& hooks, StaticResult& result) {
  StaticStage constant = stage;
  const Clock clock = state.clock;  // this balance is not a point of the stage
  constant.at_saddle = AtSaddle::keep;
  constant.steps = 1;
  const auto grows = [](const PointLoad& l) { return !l.constant; };
  constant.loads.erase(std::remove_if(constant.loads.begin(), constant.loads.end(), grows),
                       constant.loads.end());
  if (!stage.constant_gravity) constant.gravity = {};
  for (Support& s : constant.supports) s.velocity = s.angular_velocity = {};
  for (Pressure& p : constant.pressures)
    if (!p.constant) p.pressure = 0.0;
  constant.heating.clear();
  constant.walls.clear();
  constant.cell = {};
  StaticBody body(model, constant, std::move(state));
  if (stage.kind != StageKind::fracture) refuse_nothing_free(body);  // bonds break all the same
  refuse_not_finite(body);
  if (!in_balance(body, stage.newton) && !body.rests_to_rounding()) {
    refuse_rigid_motions(body);
    body.relieve();
    StaticHooks quiet{{}, {}, hooks.interrupted};
    const bool loaded = !constant.loads.empty() || constant.gravity != Vec3d{} ||
                        std::any_of(constant.pressures.begin(), constant.pressures.end(),
                                    [](const Pressure& p) { return p.pressure != 0.0; });
    if (hooks.tell)
      quiet.tell = [&hooks, loaded](const std::string& text) {
        hooks.tell((loaded ? "while the constant loads come on: " : "while the body comes to rest: ") + text);
      };
    StaticResult own;  // of strength and of free turns the stage tells at its own points
    own.most_used = BondUse{.utilisation = std::numeric_limits<double>::infinity()};
    own.free_turns = static_cast<int>(body.unknowns().free_turns().size());
    LoadSteps(body, quiet, own).run();
    result.iterations += own.iterations;
    if (own.ended == "interrupted") return std::nullopt;
  }
  Balanced balanced{{}, body.turns_of_grips()};
  balanced.state = std::move(body).take_state();
  balanced.state.clock = clock;
  return balanced;
}

}  // namespace vbond
