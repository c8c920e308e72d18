#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {
namespace {

/// Longest predictor: bonds turn by no more than this.  [rad]
constexpr double largest_prediction = 0.3;

int snapped_bonds(const State& s) {
  return static_cast<int>(std::count_if(s.bonds.begin(), s.bonds.end(), [&s](const Bond& b) {
    return bond_range(b, bond_shape(bond_pose(b, s), b.R_i, b.R_j)) == BondRange::snapped;
  }));
}

/// Walks the load factor from 0 to 1.
class LoadSteps {
 public:
  LoadSteps(StaticBody& body, const StaticHooks& hooks, StaticResult& result)
      : body_(body), hooks_(hooks), result_(result), solver_(body.stage().newton.solver) {}

  void run() {
    double step = 1.0 / std::max(1, body_.stage().steps);
    const double longest = step;
    while (body_.load_factor() < 1.0) {
      if (hooks_.interrupted && hooks_.interrupted()) {
        result_.ended = "interrupted";
        return;
      }
      const Placement from = body_.placement();
      const int snapped = snapped_bonds(body_.state());
      const double reached = advance(step);
      const NewtonOutcome outcome = settle();
      const bool last_resort = step < 1e-4 * longest;
      if (outcome.converged && (snapped_bonds(body_.state()) <= snapped || last_resort)) {
        accept(outcome);
        step = std::min(longest, 2.0 * std::max(step, reached));
        continue;
      }
      body_.restore(from);
      step = 0.5 * std::min(step, reached);
      if (last_resort) give_up(outcome.why);
    }
    result_.ended = "converged";
  }

 private:
  /// Along the tangent, at most by `step` of the load factor and not past the next of the load factors that
  /// the stage asks for, k / steps; returns how far it went.
  double advance(double step) {
    const double now = body_.load_factor(), steps = std::max(1, body_.stage().steps);
    const double mark = (std::floor(now * steps + 1e-9) + 1.0) / steps;
    step = std::min(step, mark - now);
    Vector x = Vector::Zero(body_.unknowns().size());
    if (solver_.factor_definite(body_)) {
      const Vector predicted = solver_.solve_full(body_, body_.load_direction());
      if (predicted.size() > 0 && predicted.allFinite()) x = predicted;
    }
    const double change = body_.largest_bond_change(x);
    if (change * step > largest_prediction) step = largest_prediction / change;
    const double next = now + step > mark - 1e-12 ? mark : now + step;
    body_.move(step * x, next);
    return step;
  }

  /// Downhill, or where applied moments have no potential to go down: straight on, if that leads anywhere.
  NewtonOutcome settle() {
    NewtonOutcome outcome;
    if (body_.has_applied_moments()) {
      const Placement from = body_.placement();
      outcome = correct(body_, solver_, body_.stage().newton);
      result_.iterations += outcome.iterations();
      if (outcome.converged) return outcome;
      body_.restore(from);
    }
    outcome = minimise(body_, solver_, body_.stage().newton);
    result_.iterations += outcome.iterations();
    return outcome;
  }

  /// A balance was found: is it stable? If not it is left, downhill, unless the stage wants it kept.
  void accept(NewtonOutcome outcome) {
    constexpr int most_tries = 3;
    std::optional<int> unstable = count_unstable();
    for (int k = 0; k < most_tries && unstable.value_or(0) > 0; ++k) {
      if (body_.stage().at_saddle == AtSaddle::keep) break;
      tell(
          fmt::format("load factor {:.6g}: the balance is unstable ({} negative eigenvalues of the tangent) "
                      "and is left along the lowest mode",
                      body_.load_factor(), *unstable));
      result_.left_saddle = true;
      outcome = leave_saddle();
      if (!outcome.converged) give_up("after leaving an unstable balance: " + outcome.why);
      unstable = count_unstable();
    }
    result_.residuals = outcome.residuals;
    result_.unstable = unstable;
    report_point(body_, body_.load_factor() < 1.0 ? PointKind::regular : PointKind::end, unstable, hooks_,
                 result_);
  }

  /// Negative eigenvalues that are more than rounding; nothing where conjugate gradients were used. Under
  /// applied moments in space a definite symmetric part is enough to be stable, but not needed.
  std::optional<int> count_unstable() {
    const std::optional<int> negative = solver_.factor(body_);
    if (solver_.iterative()) return std::nullopt;
    if (negative == 0) return 0;
    if (body_.has_applied_moments()) return std::nullopt;
    const SparseMatrix& K = body_.tangent();
    lowest_ = eigenpairs_near_zero(K, std::min(negative.value_or(0) + 3, body_.unknowns().size()));
    const double neutral = 1e-12 * K.diagonal().cwiseAbs().maxCoeff();
    const auto values = lowest_.values.array();
    const auto near = static_cast<int>((values < -neutral).count());
    return negative && *negative > static_cast<int>((values < 0.0).count()) ? *negative : near;
  }

  /// Downhill along the most negative mode, its largest component positive.
  NewtonOutcome leave_saddle() {
    constexpr double nudge = 0.02;  // rad: far above rounding, far below a change of shape
    Eigen::Index lowest = 0, largest = 0;
    lowest_.values.minCoeff(&lowest);
    Vector x = lowest_.vectors.col(lowest);
    x.cwiseAbs().maxCoeff(&largest);
    x *= std::copysign(nudge / std::max(body_.largest_bond_change(x), 1e-300), x[largest]);
    body_.move(x, body_.load_factor());
    return settle();
  }

  void tell(const std::string& text) const {
    if (hooks_.tell) hooks_.tell(text);
  }

  [[noreturn]] void give_up(const std::string& why) const {
    throw NoEquilibrium(
        body_.stage().name,
        fmt::format("no balance found beyond load factor {:.6g}: {}", body_.load_factor(), why),
        "the body may not carry this load (kind = \"path\" follows it past a limit point); more steps, or a "
        "larger newton.iterations, help where the way is only difficult");
  }

  StaticBody& body_;
  const StaticHooks& hooks_;
  StaticResult& result_;
  TangentSolver solver_;
  EigenPairs lowest_;

 public:
  const TangentSolver& solver() const { return solver_; }
};

}  // namespace

void refuse_rigid_motions(const StaticBody& body) {
  const RigidMotions free = free_rigid_motions(body.model(), body.state(), body.unknowns());
  if (free.names.empty()) return;
  std::string text;
  constexpr std::size_t named = 6;
  for (std::size_t k = 0; k < std::min(named, free.names.size()); ++k)
    text += (k > 0 ? ", " : "") + free.names[k];
  if (free.names.size() > named) text += fmt::format(" and {} more", free.names.size() - named);
  throw NoEquilibrium(body.stage().name, "parts of the body can move freely: " + text,
                      "hold them by supports that exert no force in balance, such as fix = [\"rx\"] on one "
                      "particle; kind = \"modes\" takes free bodies as they are");
}

void report_point(StaticBody& body, PointKind kind, std::optional<int> unstable, const StaticHooks& hooks,
                  StaticResult& result) {
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
  refuse_rigid_motions(body);
  body.relieve();
  StaticOutcome outcome;
  LoadSteps steps(body, hooks, outcome.result);
  steps.run();
  outcome.result.solver = steps.solver().name();
  if (!steps.solver().iterative() && body.unknowns().size() > 0)
    outcome.result.smallest_eigenvalue = eigenvalue_near_zero(body.tangent(), steps.solver().last_factor());
  outcome.state = std::move(body).take_state();
  return outcome;
}

State balance_of_constant_loads(const Model& model, const StaticStage& stage, State state,
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
  if (body.residual() > std::max(stage.newton.tolerance, body.residual_of_rounding())) {
    refuse_rigid_motions(body);
    body.relieve();
    StaticHooks quiet{{}, hooks.tell, hooks.interrupted};
    StaticResult own;
    LoadSteps(body, quiet, own).run();
    result.iterations += own.iterations;
  }
  State balanced = std::move(body).take_state();
  balanced.clock = clock;
  return balanced;
}

}  // namespace vbond
