#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/rigid.hpp"
#include "vbond/statics/detail/rounding.hpp"
#include "vbond/statics/detail/valley.hpp"

namespace vbond {
namespace {

/// Longest predictor: bonds turn by no more than this.  [rad]
constexpr double largest_prediction = 0.3;

int snapped_bonds(const State& s) {
  return static_cast<int>(std::count_if(s.bonds.begin(), s.bonds.end(), [&s](const Bond& b) {
    return bond_range(b, bond_shape(bond_pose(b, s), b.R_i, b.R_j)) == BondRange::snapped;
  }));
}

/// An orthonormal basis of what these orthonormal columns span, and x, which is nearly among them: x first.
DenseMatrix with_first(const Vector& x, const DenseMatrix& columns) {
  const DenseMatrix rest = columns - x * (x.transpose() * columns);
  const Eigen::JacobiSVD<DenseMatrix> svd(rest, Eigen::ComputeThinU);
  DenseMatrix all(x.size(), std::max<Eigen::Index>(1, columns.cols()));
  all << x, svd.matrixU().leftCols(all.cols() - 1);
  return all;
}

/// A load step: where it began, where the tangent there says that it ends, and how much of the load factor
/// that is.
struct Way {
  Placement from, predicted;
  double length = 0;
  bool foreseen = false;  ///< the body was stable at the start, so that there is a prediction
};

/// Walks the load factor from 0 to 1.
class LoadSteps {
 public:
  LoadSteps(StaticBody& body, const StaticHooks& hooks, StaticResult& result)
      : body_(body), hooks_(hooks), result_(result), solver_(body.stage().newton.solver) {}

  void run() {
    begin();
    double step = 1.0 / std::max(1, body_.stage().steps);
    const double longest = step;
    while (body_.load_factor() < 1.0) {
      const int snapped = snapped_bonds(body_.state());
      const Way way = advance(step);
      const NewtonOutcome outcome = settle();
      const bool last_resort = step < 1e-4 * longest;
      if (outcome.interrupted) return interrupted(way.from);
      if (!outcome.converged || (snapped_bonds(body_.state()) > snapped && !last_resort)) {
        retry(way, step);
        if (last_resort)
          give_up(fmt::format("no balance found beyond load factor {:.6g}: {}", way.from.load_factor,
                              outcome.why));
        continue;
      }
      count_unstable();
      if (may_be_a_jump(way)) {
        const std::optional<bool> back = comes_back(way.from);
        if (!back) return interrupted(way.from);
        if (*back && way.length > longest / 64) {  // the jump may be in one half of the step
          retry(way, step);
          continue;
        }
        if (!*back) tell_jump(way.from);
        count_unstable();
      }
      if (!accept(outcome)) return interrupted(way.from);
      step = std::min(longest, 2.0 * std::max(step, way.length));
    }
    result_.smallest_eigenvalue = smallest_eigenvalue();
    judge_smallest();
    result_.ended = "converged";
  }
  const TangentSolver& solver() const { return solver_; }

 private:
  /// The first point: where the body comes from.
  void begin() {
    try {
      count_unstable();
    } catch (const NoConvergence&) {  // only told here: what it is like under load is what counts
      unstable_.reset();
    }
    report_point(body_, PointKind::regular, unstable_, hooks_, result_);
  }

  void interrupted(const Placement& last_balance) {
    body_.restore(last_balance);
    result_.ended = "interrupted";
  }

  /// Back, for a step half as long.
  void retry(const Way& way, double& step) {
    body_.restore(way.from);
    factored_here_ = false;
    step = 0.5 * std::min(step, way.length);
  }

  /// Along the tangent, at most by `step` of the load factor and not past the next of the load factors that
  /// the stage asks for, k / steps.
  Way advance(double step) {
    Way way{body_.placement(), {}, 0, false};
    const double now = body_.load_factor(), steps = std::max(1, body_.stage().steps);
    const double mark = (std::floor(now * steps + 1e-9) + 1.0) / steps;
    step = std::min(step, mark - now);
    Vector x = Vector::Zero(body_.unknowns().size());
    if (std::exchange(factored_here_, false) || solver_.factor_definite(body_)) {
      const Vector predicted = solver_.solve_full(body_, body_.load_direction());
      way.foreseen = predicted.size() == x.size() && predicted.allFinite();
      if (way.foreseen) x = predicted;
    }
    const double change = body_.largest_bond_change(x);
    if (std::isfinite(change) && change * step > largest_prediction) step = largest_prediction / change;
    const double next = now + step > mark - 1e-12 ? mark : now + step;
    body_.move(step * x, next);
    way.predicted = body_.placement();
    way.length = step;
    return way;
  }

  /// Downhill, or where outside moments have no potential to go down: straight on, if that leads anywhere.
  NewtonOutcome settle() {
    if (body_.has_moment_part()) {
      const Placement from = body_.placement();
      const NewtonOutcome outcome = correct(body_, solver_, body_.stage().newton, hooks_.interrupted);
      result_.iterations += outcome.iterations();
      if (outcome.converged || outcome.interrupted) return outcome;
      body_.restore(from);
    }
    return go_downhill();
  }

  NewtonOutcome go_downhill(int patience = 1) {
    NewtonSettings settings = body_.stage().newton;
    settings.iterations *= patience;
    NewtonOutcome outcome = minimise(body_, solver_, settings, hooks_.interrupted);
    result_.iterations += outcome.iterations();
    return outcome;
  }

  /// A balance that is unstable is left, downhill, unless the stage wants it kept. False if
  /// interrupted.
  bool accept(NewtonOutcome outcome) {
    constexpr int most_tries = 3;
    for (int k = 0; k < most_tries && unstable_.value_or(0) > 0; ++k) {
      if (body_.stage().at_saddle == AtSaddle::keep) break;
      result_.left_saddle = true;
      outcome = leave_saddle();
      if (outcome.interrupted) return false;
    }
    result_.residuals = outcome.residuals;
    result_.unstable = unstable_;
    result_.neutral = neutral_;
    result_.jumped = jumped_;
    if (neutral_) tell_neutral();
    report_point(body_, body_.load_factor() < 1.0 ? PointKind::regular : PointKind::end, unstable_, hooks_,
                 result_);
    return true;
  }

  double distance_to_here(const Placement& p) const {
    return distance(p, body_.placement(), body_.unknowns().length());
  }

  /// Whether balance lies far from where the tangent at the start, or the one here, says that it should be. A
  /// smooth step goes as far as both say, but for its curvature: twice as far is no such step.
  bool may_be_a_jump(const Way& way) {
    constexpr double far = 2.0;
    if (!way.foreseen) return false;
    const Placement here = body_.placement();
    const double went = distance_to_here(way.from);
    if (went > far * distance(way.from, way.predicted, body_.unknowns().length())) return true;
    if (!definite_) return false;
    const Vector x = solver_.solve_full(body_, body_.load_direction());
    body_.move((way.from.load_factor - here.load_factor) * x, way.from.load_factor);
    const double expected = distance_to_here(here);
    body_.restore(here);
    return went > far * expected;
  }

  /// Whether the body goes back to where it came from when the load does; nothing if interrupted. One that
  /// has moved on from stable balance to stable balance does, to the tolerance of balance: a part in a
  /// thousand of the way is more than that, and less than any jump.
  std::optional<bool> comes_back(const Placement& from) {
    constexpr double same = 1e-3;
    const Placement here = body_.placement();
    const double went = distance_to_here(from);
    body_.move(Vector::Zero(body_.unknowns().size()), from.load_factor);
    const NewtonOutcome back = settle();
    const bool same_place = !back.converged || distance_to_here(from) <= same * went;
    body_.restore(here);
    if (back.interrupted) return std::nullopt;
    return same_place;
  }

  void tell_jump(const Placement& from) {
    jumped_ = true;
    tell(fmt::format(
        "between load factors {:.6g} and {:.6g} the body jumped, in a step that moved it by up to "
        "{:.3g}: taken back to the first it does not come back; kind = \"path\" follows what "
        "lies between",
        from.load_factor, body_.load_factor(), distance_to_here(from)));
  }

  /// Negative eigenvalues that are more than their error, and the lowest of them with its mode. Not known
  /// where conjugate gradients were used.
  void count_unstable() {
    unstable_ = 0;
    neutral_ = false;
    lowest_.reset();
    const std::optional<int> negative = solver_.factor(body_);
    if (solver_.iterative()) unstable_.reset();
    definite_ = factored_here_ = negative == 0;
    if (solver_.iterative() || definite_) return;
    const SparseMatrix& K = body_.tangent();
    if (K.norm() == 0.0) {  // where contacts just begin to touch
      neutral_ = true;
      return;
    }
    Factor factor;
    factor.analyse(K);
    body_.has_moment_part() ? judge_beside_moments(factor, negative) : judge_by_lowest(factor, negative);
  }

  void judge_by_lowest(Factor& factor, std::optional<int> negative) {
    const SparseMatrix& K = body_.tangent();
    lowest_ = lowest_pair(factor, eigenvalue_error(K));
    const double lowest = lowest_->values[0], error = eigenvalue_error(K, lowest_->vectors.col(0));
    neutral_ = std::abs(lowest) <= error;
    if (lowest < -error)
      unstable_ = std::max(1, factor.factor_indefinite(K, error).value_or(negative.value_or(1)));
  }

  /// Eigenvalues of the whole tangent lie within its antisymmetric part of those of the symmetric one: under
  /// outside moments only those below that are counted, and if there are others below zero nothing is known.
  void judge_beside_moments(Factor& factor, std::optional<int> negative) {
    const SparseMatrix& K = body_.tangent();
    const double margin = std::max(eigenvalue_error(K), body_.moment_part());
    lowest_ = lowest_pair(factor, margin);
    if (lowest_->values[0] < -margin) {
      unstable_ = std::max(1, factor.factor_indefinite(K, margin).value_or(negative.value_or(1)));
      return;
    }
    lowest_.reset();
    neutral_ = !negative;
    unstable_.reset();
  }

  /// The lowest eigenvalue, below which it is looked for from this far below zero on, and its mode. The value
  /// is the one that the mode gives, which is free of the rounding on the way to it.
  EigenPairs lowest_pair(Factor& factor, double margin) const {
    const SparseMatrix& K = body_.tangent();
    const double size = K.norm();
    double below = 10.0 * margin;
    while (!factor.factor_definite(K, below)) {
      below *= 10.0;
      if (!(below < 1e3 * size)) give_up("the tangent stiffness is not finite: " + body_.first_not_finite());
    }
    EigenPairs lowest = smallest_eigenpairs(K, 1, -below);
    const Vector x = lowest.vectors.col(0);
    lowest.values[0] = x.dot(K * x);
    return lowest;
  }

  /// The last balance may be neutral although its tangent could be factored as positive definite.
  void judge_smallest() {
    const std::optional<double>& smallest = result_.smallest_eigenvalue;
    if (!smallest) return;
    if (!std::isfinite(*smallest))
      give_up("the tangent stiffness is not finite: " + body_.first_not_finite());
    const SparseMatrix& K = body_.tangent();
    constexpr double far = 1e3;  // no mode's error is so many times that of all
    if (!definite_ || *smallest > far * eigenvalue_error(K)) return;
    const EigenPairs nearest = eigenpairs_near_zero(K, 1);
    if (nearest.values[0] > eigenvalue_error(K, nearest.vectors.col(0))) return;
    result_.neutral = true;
    tell_neutral();
  }

  void tell_neutral() const {
    const EigenPairs zero = eigenpairs_near_zero(body_.tangent(), 1);
    tell(fmt::format("load factor {:.6g}: the balance is neutral, some motion meets no stiffness: {}",
                     body_.load_factor(), body_.unknowns().names_of_largest(zero.vectors.col(0))));
  }

  /// Downhill along the most negative mode, its largest component positive, and counts again. If that fails
  /// the unstable balance is kept as the last point.
  NewtonOutcome leave_saddle() {
    constexpr double nudge = 0.02;  // of the length scale: far above rounding, far below a change of shape
    const Placement saddle = body_.placement();
    const int unstable = unstable_.value();
    const double lowest = lowest_->values[0];
    const Vector x = lowest_->vectors.col(0);
    Eigen::Index largest = 0;
    x.cwiseAbs().maxCoeff(&largest);
    const double first = nudge * body_.unknowns().length() / x[largest];
    constexpr int patience = 5;  // just above a critical load the valley is long and flat
    NewtonOutcome outcome = from_beside(saddle, first * x, 1);
    if (still_unstable(outcome)) {
      const DenseMatrix modes = unstable_modes(saddle, x, lowest, unstable);
      const ValleyWalk walk = walk_down_valley(body_, solver_, modes, lowest, first, hooks_.interrupted);
      result_.iterations += walk.iterations;
      if (walk.found) outcome = correct_and_count();
      if (still_unstable(outcome)) outcome = from_beside(saddle, first * x, patience);
    }
    if (!outcome.converged && !outcome.interrupted) {
      body_.restore(saddle);
      report_point(body_, PointKind::regular, unstable, hooks_, result_);
      give_up(fmt::format(
          "the balance at load factor {:.6g} is unstable, and none was found downhill from it: {}",
          saddle.load_factor, outcome.why));
    }
    tell(fmt::format(
        "load factor {:.6g}: the balance is unstable ({} negative eigenvalues of the tangent) and "
        "was left along its lowest mode; the next one downhill is up to {:.3g} away",
        saddle.load_factor, unstable, distance_to_here(saddle)));
    return outcome;
  }

  NewtonOutcome settle_and_count(int patience) {
    const NewtonOutcome outcome = go_downhill(patience);
    if (outcome.converged) count_unstable();
    return outcome;
  }

  /// From next to a balance, which may be too flat to be gone down to: straight, and downhill if that fails.
  NewtonOutcome correct_and_count() {
    const Placement here = body_.placement();
    const NewtonOutcome outcome = correct(body_, solver_, body_.stage().newton, hooks_.interrupted);
    result_.iterations += outcome.iterations();
    if (outcome.converged) count_unstable();
    if (!still_unstable(outcome)) return outcome;
    body_.restore(here);
    return settle_and_count(1);
  }

  NewtonOutcome from_beside(const Placement& saddle, const Vector& x, int patience) {
    body_.restore(saddle);
    body_.move(x, saddle.load_factor);
    return settle_and_count(patience);
  }

  bool still_unstable(const NewtonOutcome& way) const {
    return !way.interrupted && (!way.converged || unstable_.value_or(0) > 0);
  }

  /// Back at the saddle: its lowest mode x, and the others that are unstable.
  DenseMatrix unstable_modes(const Placement& saddle, const Vector& x, double lowest, int unstable) {
    constexpr int most = 6;
    body_.restore(saddle);
    const double bound = lowest - std::abs(lowest);
    return with_first(x, smallest_eigenpairs(body_.tangent(), std::min(unstable, most), bound).vectors);
  }

  std::optional<double> smallest_eigenvalue() const {
    if (solver_.iterative() || body_.unknowns().size() == 0) return std::nullopt;
    if (lowest_) return lowest_->values[0];
    if (definite_) return eigenvalue_near_zero(body_.tangent(), solver_.last_factor());
    if (!neutral_) return std::nullopt;
    return eigenpairs_near_zero(body_.tangent(), 1).values[0];
  }

  void tell(const std::string& text) const {
    if (hooks_.tell) hooks_.tell(text);
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
  bool jumped_ = false;               // so far
  std::optional<int> unstable_;       // of the last balance
  bool neutral_ = false;              // the same
  bool definite_ = false;             // the solver's factor is that of its tangent
  bool factored_here_ = false;        // and it still is
  std::optional<EigenPairs> lowest_;  // if it is unstable
};

}  // namespace

void refuse_nothing_free(const StaticBody& body) {
  if (body.unknowns().size() > 0) return;
  throw NoEquilibrium(body.stage().name, "nothing is free to move",
                      "paths, critical loads and modes are of degrees of freedom that are free: hold fewer");
}

void refuse_rigid_motions(const StaticBody& body) {
  const RigidMotions free = free_rigid_motions(body.model(), body.state(), body.unknowns());
  if (free.names.empty()) return;
  std::string text;
  constexpr std::size_t named = 6;
  for (std::size_t k = 0; k < std::min(named, free.names.size()); ++k)
    text += (k > 0 ? ", " : "") + free.names[k];
  if (free.names.size() > named) text += fmt::format(" and {} more", free.names.size() - named);
  throw NoEquilibrium(
      body.stage().name, "parts of the body can move freely: " + text,
      "a support may be missing; a motion that no load drives can be held on one particle, such "
      "as the spin of a rod along x by fix = [\"rx\"]; kind = \"modes\" takes free bodies as they are");
}

void refuse_not_finite(const StaticBody& body) {
  if (body.places_are_finite() && std::isfinite(body.residual()) && std::isfinite(body.energies().total()))
    return;
  throw NoEquilibrium(
      body.stage().name,
      fmt::format("at load factor {:.6g}: {}", body.load_factor(), body.first_not_finite()),
      "particles that are bonded must stand apart, and loads and stiffnesses be far from the largest number");
}

void report_point(StaticBody& body, PointKind kind, std::optional<int> unstable, const StaticHooks& hooks,
                  StaticResult& result) {
  refuse_not_finite(body);
  ++body.clock().step;
  ++body.clock().stage_step;
  ++result.points;
  result.load_factor = body.load_factor();
  if (hooks.point)
    hooks.point({body.state(), body.load_factor(), kind, unstable, body.energies(),
                 [&body](const std::vector<ParticleId>& particles) { return body.reaction(particles); }});
}

StaticOutcome find_equilibrium(const Model& model, const StaticStage& stage, State state,
                               const StaticHooks& hooks) {
  StaticBody body(model, stage, std::move(state));
  refuse_not_finite(body);
  refuse_rigid_motions(body);
  body.relieve();
  StaticOutcome outcome;
  LoadSteps steps(body, hooks, outcome.result);
  steps.run();
  outcome.result.solver = steps.solver().name();
  outcome.state = std::move(body).take_state();
  return outcome;
}

std::optional<State> balance_of_constant_loads(const Model& model, const StaticStage& stage, State state,
                                               const StaticHooks& hooks, StaticResult& result) {
  StaticStage constant = stage;
  const Clock clock = state.clock;  // this balance is not a point of the stage
  constant.at_saddle = AtSaddle::keep;
  constant.steps = 1;
  const auto grows = [](const StaticLoad& l) { return !l.constant; };
  constant.loads.erase(std::remove_if(constant.loads.begin(), constant.loads.end(), grows),
                       constant.loads.end());
  if (!stage.constant_gravity) constant.gravity = {};
  for (StaticSupport& s : constant.supports) s.displacement = s.rotation = {};
  StaticBody body(model, constant, std::move(state));
  refuse_nothing_free(body);
  refuse_not_finite(body);
  if (!in_balance(body, stage.newton)) {
    refuse_rigid_motions(body);
    body.relieve();
    StaticHooks quiet{{}, {}, hooks.interrupted};
    if (hooks.tell)
      quiet.tell = [&hooks](const std::string& text) {
        hooks.tell("while the constant loads come on: " + text);
      };
    StaticResult own;
    LoadSteps(body, quiet, own).run();
    result.iterations += own.iterations;
    if (own.ended == "interrupted") return std::nullopt;
  }
  State balanced = std::move(body).take_state();
  balanced.clock = clock;
  return balanced;
}

StaticOutcome interrupted_outcome(StaticResult result, State state) {
  result.ended = "interrupted";
  state.v.assign(state.r.size(), {});
  state.omega.assign(state.r.size(), {});
  return {std::move(result), std::move(state)};
}

}  // namespace vbond
