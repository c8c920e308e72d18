#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/core/crossing.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/statics/detail/breaking_body.hpp"
#include "vbond/statics/detail/kinds.hpp"

namespace vbond {
namespace {

/// How near to 1 the utilisation is brought by the load factor.
constexpr double critical_error = 1e-10;
/// By how much the books may be off, as a part of the largest energy in them, before that is told.
constexpr double books_error = 1e-3;
/// A step is made shorter where a larger part of what it turns over is missing in the books, down to a part
/// of the longest step. If the shorter one leads nowhere the longer one is taken, but not if so much is
/// missing that it has jumped.
constexpr double books_error_of_step = 0.25 * books_error, least_for_books = 1e-3, jump = 0.03;

double use_of(const std::optional<BondUse>& most) {
  return most ? most->utilisation : 0.0;
}
double use_of(const Balance& b) {
  return use_of(b.most);
}
bool is_past(const Balance& b) {
  return use_of(b) >= 1.0 - same_use;
}

BrokenBond broken_bond(const BondUse& use, const BondEvent& event) {
  const Failure<double>& f = event.failure;
  BrokenBond broken;
  broken.use = use;
  broken.shares = {f.tension, f.shear, f.bending, f.torsion, f.compression};
  broken.section = {event.loads.N, event.loads.V, event.loads.M_b, event.loads.M_t};
  broken.middle = event.middle;
  broken.direction = event.direction;
  broken.held = event.energy;
  return broken;
}

/// Goes along the load factor and breaks one bond at a time.
class Fracture {
 public:
  Fracture(const Model& model, const StaticStage& stage, State balanced, const StaticHooks& hooks,
           StaticResult& result)
      : stage_(stage),
        settings_(stage.fracture),
        hooks_(hooks),
        result_(result),
        found_(result.fracture),
        walk_(model, stage, std::move(balanced), hooks, result) {
    begin();
  }
  /// Where it was stopped.
  Fracture(const Model& model, const StaticStage& stage, State now, const FractureUnderWay& then,
           const StaticHooks& hooks, StaticResult& result)
      : stage_(stage),
        settings_(stage.fracture),
        hooks_(hooks),
        result_(result),
        found_(result.fracture),
        walk_(model, stage, std::move(now), then, hooks, result),
        now_(walk_.here()),
        told_at_(result.points) {
    take_up(then.numbers);
    note_free_turns(walk_.body(), hooks_, result_);
    if (hooks_.goes_on) hooks_.goes_on(point_at(walk_.body(), PointKind::regular, 0, result_));
  }

  State run() {
    while (result_.ended.empty()) {
      tell_where_it_stands();
      if (hooks_.interrupted && hooks_.interrupted())
        result_.ended = "interrupted";
      else if (way_)
        step_on();
      else if (is_past(now_))
        break_one();
      else if (now_.at.load_factor >= settings_.end)
        end("load factor", "");
      else
        set_out(settings_.end);
    }
    if (breaking_) end_break();
    if (std::abs(found_.books.error()) * found_.books.largest >
        books_error * found_.books.largest + rounding_of_books())
      tell_missing();
    result_.solver = walk_.solver().name();
    result_.factors = walk_.factors();
    return std::move(walk_).take_state();
  }

 private:
  void begin() {
    refuse_rigid_motions(walk_.body());
    if (walk_.body().unknowns().size() > 0) walk_.prepare_solver();
    now_ = walk_.here();
    if (!now_.most) tell(stage_, hooks_, "no bond has a strength: nothing can break");
    found_.books.initial = found_.books.stored = now_.stored;
    dissipated_before_ = now_.dissipated;
    note_balance(PointKind::regular);
  }

  /// All that take_up(), and the walk, need to go on from here.
  void tell_where_it_stands() {
    if (!hooks_.under_way || std::exchange(told_at_, result_.points) == result_.points) return;
    FractureUnderWay now;
    FractureUnderWay::Numbers& n = now.numbers;
    n.dissipated_before = dissipated_before_, n.largest_reaction = largest_reaction_;
    n.avalanche_factor = avalanche_factor_, n.in_avalanche = in_avalanche_;
    n.has_before = before_.has_value();
    if (before_) n.before_factor = before_->load_factor, n.before_use = before_->use;
    n.on_way = way_.has_value();
    if (way_) n.way_to = way_->to, n.way_limit = way_->limit;
    n.breaking = breaking_;
    n.peak_pushes = peak_pushes_;
    n.worst_from = worst_.from, n.worst_to = worst_.to, n.worst_energy = worst_.energy;
    now.found = result_;
    now.held = floating_held(stage_);
    walk_.note(now);
    hooks_.under_way(std::move(now));
  }
  void take_up(const FractureUnderWay::Numbers& n) {
    dissipated_before_ = n.dissipated_before, largest_reaction_ = n.largest_reaction;
    avalanche_factor_ = n.avalanche_factor, in_avalanche_ = static_cast<int>(n.in_avalanche);
    if (n.has_before) before_ = {n.before_factor, n.before_use};
    if (n.on_way) way_ = {n.way_to, n.way_limit};
    breaking_ = n.breaking;
    peak_pushes_ = n.peak_pushes;
    worst_ = {n.worst_from, n.worst_to, n.worst_energy};
  }

  void end(const std::string& how, const std::string& reason) {
    result_.ended = how;
    found_.reason = reason;
    if (!reason.empty()) tell(stage_, hooks_, reason);
  }

  void lose_stability(const std::string& where) {
    const bool untouched = walk_.load_factor() == 0.0 && !walk_.body().model().walls.empty();
    end("lost stability", fmt::format("load factor {:.9g}: {}{}", walk_.load_factor(), where,
                                      untouched ? "; walls that just touch have no stiffness yet: press the "
                                                  "body first by a stage of kind = \"equilibrium\""
                                                : ""));
  }

  double longest_step() const { return settings_.end / std::max(1, stage_.steps); }

  /// Along the load factor towards `to`, until the largest utilisation is 1.
  void set_out(double to) {
    if (!walk_.is_stable()) return lose_stability("the balance is not stable any more");
    way_ = {to, longest_step()};
  }
  void arrive() {
    way_.reset();
    if (breaking_) end_break();
  }

  /// A step of the way, which begins at a stable balance and ends at one.
  void step_on() {
    const double to = way_->to, largest = longest_step(), smallest = 1e-7 * largest;
    const bool up = to > now_.at.load_factor;
    double& limit = way_->limit;
    std::optional<Step> longer;  // the last from here whose books did not close
    while (result_.ended.empty()) {
      if (hooks_.interrupted && hooks_.interrupted()) return void(result_.ended = "interrupted");
      const double from = now_.at.load_factor;
      const double wanted = std::min({limit, std::abs(expected_step()), walk_.longest_step()});
      const double step = std::min(std::max(wanted, smallest), std::abs(to - from));
      const double next = step < std::abs(to - from) ? from + (up ? step : -step) : to;
      std::optional<Step> made = step_to(next);
      if (!made && hooks_.interrupted && hooks_.interrupted()) return void(result_.ended = "interrupted");
      if (made && step > least_for_books * largest && !closes(*made, books_error_of_step)) {
        if (closes(*made, jump)) longer = std::move(made);
        made.reset();
      } else if (!made && longer) {
        made = std::exchange(longer, std::nullopt);
        walk_.restore(made->to);
        walk_.is_stable();
        made->to = walk_.here();  // with the rate that a checkpoint holds
      }
      if (!made) {
        walk_.restore(now_);
        limit = 0.5 * step;
        if (limit < smallest) return lose_stability("no stable balance is found beyond it");
        if (!walk_.is_stable()) return lose_stability("the balance is not stable any more");
        continue;
      }
      note_missing(*made);
      const bool may_grow = closes(*made, 0.5 * books_error_of_step);  // it grows with the step, or faster
      before_ = {now_.at.load_factor, use_of(now_)};
      now_ = std::move(made->to);
      add_work(made->work[0]);
      walk_.add_work_of_walls(made->work);
      const bool critical = up ? is_past(now_) : use_of(now_) <= 1.0 + same_use;
      note_balance(critical                               ? PointKind::critical
                   : now_.at.load_factor == settings_.end ? PointKind::end
                                                          : PointKind::regular);
      if (critical || now_.at.load_factor == to) return arrive();
      if (may_grow) limit = std::min(largest, 2.0 * limit);
      return;
    }
  }

  /// From the last balance to one close by, and the work on the way.
  struct Step {
    Balance to;
    Vector work;  // of all, then of each wall
  };
  /// To this load factor, or to where a bond comes to its strength before it. Nothing: no stable balance is
  /// found there.
  std::optional<Step> step_to(double load_factor) {
    if (!walk_.step_to(load_factor) || !stop_at_strength() || !walk_.is_stable() ||
        !walk_.came_smoothly(now_.at))
      return std::nullopt;
    Balance there = walk_.here();
    Vector work = walk_.work_between(now_, there, found_.books.largest);
    return Step{std::move(there), std::move(work)};
  }

  /// The change of the load factor after which the largest utilisation is 1, if it goes on as in the last
  /// step, or in proportion to the load factor if there was none.
  double expected_step() const {
    const double f = now_.at.load_factor, u = use_of(now_);
    double slope = f > 0.0 ? u / f : 0.0;
    if (before_ && before_->load_factor != f) slope = (u - before_->use) / (f - before_->load_factor);
    const double step = (1.0 - u) / slope;
    const bool rising = slope > 0.0 && std::isfinite(step);
    return rising ? step : settings_.end;
  }

  /// The body stands at a balance after now_. If the largest utilisation passes 1 between them, it is brought
  /// to where it is 1. False if no balance is found there.
  bool stop_at_strength() {
    const Placement there = walk_.body().placement();
    const Sample first{now_.at.load_factor, use_of(now_) - 1.0},
        last{there.load_factor, use_of(walk_.most_used()) - 1.0};
    if (std::abs(last.value) <= critical_error || std::signbit(first.value) == std::signbit(last.value))
      return true;
    const auto value = [&](double f) -> std::optional<double> {
      if (!walk_.balance_between(now_.at, there, f)) return std::nullopt;
      return use_of(walk_.most_used()) - 1.0;
    };
    const Crossed c = crossing(first, last, critical_error, value);
    if (!c.found) return false;
    const double f = c.s == c.lo.s ? c.hi.s : c.s;  // beyond rather than before, so that it gets there
    return walk_.load_factor() == f || value(f).has_value();
  }

  /// The bond with the largest utilisation goes; then the balance without it.
  void break_one() {
    const BondId k = now_.most->bond;
    const State& state = walk_.body().state();
    const Bond& bond = state.bonds[k];
    const BondEvent event = breaking_event(bond, k, state.clock.step, state.r[bond.i], bond_pose(bond, state),
                                           history_of_bond(state, k));
    BrokenBond broken = broken_bond(*now_.most, event);
    broken.point = result_.points;
    broken.load = walk_.load();
    const double factor = now_.at.load_factor;
    if (found_.avalanches == 0 || factor > avalanche_factor_ * (1.0 + same_use))
      ++found_.avalanches, in_avalanche_ = 0, avalanche_factor_ = factor;
    broken.avalanche = found_.avalanches;
    found_.largest_avalanche = std::max(found_.largest_avalanche, ++in_avalanche_);
    walk_.break_bond(k, event.cause.mode);
    found_.breaks.push_back(std::move(broken));
    find_balance_after();
    breaking_ = true;
    if (result_.ended.empty() && settings_.control == FractureControl::crack &&
        use_of(now_) > 1.0 + same_use && now_.at.load_factor > 0.0)
      set_out(0.0);
    if (!way_) end_break();
  }

  void end_break() {
    breaking_ = false;
    BrokenBond& after = found_.breaks.back();
    after.work = found_.books.work;
    after.stored = now_.stored;
    if (!result_.ended.empty()) return;
    after.load_factor_after = now_.at.load_factor;
    after.load_after = walk_.load();
    constexpr double nothing = 1e-9;  // of the largest: rounding
    const std::optional<double> left = walk_.largest_reaction();
    if (left && now_.at.load_factor > 0.0 && *left <= nothing * largest_reaction_)
      end("parted",
          fmt::format("load factor {:.9g}: the body has parted, no load is left", walk_.load_factor()));
    else if (static_cast<int>(found_.breaks.size()) >= settings_.most_breaks)
      end("breaks", "");
    else if (settings_.load_drop &&
             along_peak(*after.load_after) <= (1.0 - *settings_.load_drop) * found_.peak_load)
      end("load drop", "");
  }

  /// A part that a wall has pushed off as it settled is held where it has come to lie.
  bool come_to_rest() {
    if (!walk_.settle()) return false;
    if (walk_.is_stable()) return true;
    if (walk_.body().model().walls.empty()) return false;
    return !walk_.hold_free_parts() && walk_.settle() && walk_.is_stable();
  }

  /// The balance that follows the break of a bond at the same load factor, and the energy it has released.
  void find_balance_after() {
    const double spent = now_.spent();
    const Placement from = walk_.body().placement();
    if (const std::optional<std::string> driven = walk_.hold_free_parts()) {
      now_ = walk_.here();
      book_release(spent - now_.spent());
      return end("parted",
                 fmt::format("load factor {:.9g}: the body has parted, loads drive off what nothing "
                             "holds any more: {}",
                             walk_.load_factor(), *driven));
    }
    // with a kept factor the way down may have ended at a saddle that a new one would have shown
    const auto come_to_rest_anew = [&] {
      walk_.body().restore(from);
      walk_.drop_kept_factor();
      return come_to_rest();
    };
    const bool kept = walk_.has_kept_factor();
    if (!come_to_rest() && !(kept && come_to_rest_anew())) {
      if (hooks_.interrupted && hooks_.interrupted()) return void(result_.ended = "interrupted");
      walk_.body().restore(from);
      now_ = walk_.here();
      book_release(spent - now_.spent());
      return lose_stability(
          fmt::format("no stable balance follows the break of bond {}", found_.breaks.back().use.bond.value));
    }
    const Balance unbroken = std::exchange(now_, walk_.here());
    before_.reset();
    const double work = walk_.work_of_jump(unbroken, now_);
    add_work(work);
    book_release(spent + work - now_.spent());
    note_balance(PointKind::broken);
  }

  /// What the work of a step has not become.
  double missing(const Step& s) const { return s.work[0] - (s.to.spent() - now_.spent()); }
  /// Whether that is no more than this part of what it turns over.
  bool closes(const Step& s, double part) {
    const double turned_over = std::abs(s.work[0]) + std::abs(s.to.spent() - now_.spent());
    return std::abs(missing(s)) <= part * turned_over + rounding_of_books();
  }
  /// What sums over many balances leave, and rounding of energies.
  double rounding_of_books() {
    return 1e-10 * found_.books.largest + 10.0 * walk_.body().rounding_of_potential();
  }
  void note_missing(const Step& s) {
    if (std::abs(missing(s)) > std::abs(worst_.energy))
      worst_ = {now_.at.load_factor, s.to.at.load_factor, missing(s)};
  }
  void tell_missing() const {
    tell(stage_, hooks_,
         fmt::format(
             "the energy books are off by {:.2g} of the largest energy in them, most of it between load "
             "factors {:.6g} and {:.6g}: the body may have jumped there, or flowed in steps that are too "
             "long; more steps (steps = {}) make them shorter",
             std::abs(found_.books.error()), worst_.from, worst_.to, 4 * std::max(1, stage_.steps)));
  }

  void book_energies() {
    found_.books.stored = now_.stored;
    found_.books.dissipated = now_.dissipated - dissipated_before_;
  }

  void note_balance(PointKind kind) {
    refuse_pressure_without_energy(walk_.body());
    constexpr double roundings = 1e3;  // as in dynamics: less is no energy that an error can be compared with
    book_energies();
    found_.books.largest = std::max(
        {found_.books.largest, std::abs(now_.stored), roundings * walk_.body().rounding_of_potential()});
    note_peak(walk_.load());
    report_point(walk_.body(), kind, walk_.unstable(), hooks_, result_);
    result_.unstable = walk_.unstable();
  }

  void note_peak(double load) {
    largest_reaction_ = std::max(largest_reaction_, walk_.largest_reaction().value_or(0.0));
    if (!(std::abs(load) > found_.peak_load)) return;
    found_.peak_load = std::abs(load);
    peak_pushes_ = load < 0.0;
    found_.peak_load_factor = walk_.load_factor();
  }

  /// A load in the sense of the largest one.
  double along_peak(double load) const { return peak_pushes_ ? -load : load; }

  void add_work(double work) {
    found_.books.work += work;
    found_.books.largest = std::max(found_.books.largest, std::abs(found_.books.work));
  }

  void book_release(double energy) {
    found_.breaks.back().released = energy;
    found_.books.released += energy;
    book_energies();
  }

  const StaticStage& stage_;
  const FractureSettings& settings_;
  const StaticHooks& hooks_;
  StaticResult& result_;
  FractureResult& found_;
  BreakingBody walk_;
  Balance now_;
  struct Use {
    double load_factor, use;
  };
  std::optional<Use> before_;  // of the balance before; nothing after a break
  struct Way {
    double to, limit;  // load factor; of its change in a step
  };
  std::optional<Way> way_;
  bool breaking_ = false;  // a bond has broken, and the load goes down before all is known of that
  int told_at_ = 0;        // point of tell_where_it_stands()
  int in_avalanche_ = 0;
  double avalanche_factor_ = 0;
  double dissipated_before_ = 0;  // the stage
  double largest_reaction_ = 0;   // of any support
  bool peak_pushes_ = false;      // whether the largest load was negative
  struct {
    double from = 0, to = 0, energy = 0;
  } worst_;  // step of the books
};

}  // namespace

StaticOutcome break_at_rest(const Model& model, const StaticStage& stage, State state,
                            const StaticHooks& hooks, const FractureUnderWay* then) {
  if (then) {
    StaticStage from = stage;
    from.cell_stress_at_start = then->numbers.cell_stress_at_start;
    return run_from_balance(from, std::move(state), then->found,
                            [&](const StaticStage& as, State now, StaticResult& result) {
                              return Fracture(model, as, std::move(now), *then, hooks, result).run();
                            });
  }
  return run_from_constant_loads(model, stage, std::move(state), hooks,
                                 [&](const StaticStage& from, State balanced, StaticResult& result) {
                                   return Fracture(model, from, std::move(balanced), hooks, result).run();
                                 });
}

}  // namespace vbond
