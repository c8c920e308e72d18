#include "vbond/statics/detail/newton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

Vector limited(const StaticBody& body, Vector x) {
  const double change = change_of(body, x);
  if (change > largest_change) x *= largest_change / change;
  return x;
}

/// In words, if residual() is not finite. It also is not where nothing in the body carries a load.
std::string why_not_finite(const StaticBody& body) {
  const std::string what = body.first_not_finite();
  return what.empty() ? "no bond carries a load any more: some may have softened all through" : what;
}

/// To what part of what is unbalanced a correction is worth solving for: to a hundredth of what is accepted,
/// and not beyond what curvature is likely to leave.
double accuracy_for(const StaticBody& body, const NewtonSettings& settings) {
  return std::clamp(1e-2 * settings.tolerance / body.residual(), 1e-6, 1e-2);
}

/// Corrections by the kept factor alone, which take no tangent, as long as each leaves less than a tenth of
/// what was unbalanced, or a balance, and is_good(where it began) besides; one that does not is taken back.
template <class IsGood>
void correct_roughly(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                     const IsGood& is_good) {
  constexpr double fast = 0.1;
  while (!in_balance(body, settings)) {
    const double residual = body.residual();
    const Vector x = solver.solve_roughly(body, body.unbalanced());
    if (x.size() == 0 || !(change_of(body, x) <= largest_change)) return;
    const Placement from = body.placement();
    body.move(x, from.load_factor);
    if ((body.residual() < fast * residual || in_balance(body, settings)) && is_good(from)) continue;
    body.restore(from);
    return;
  }
}

/// Of one iteration of minimise: a direction that goes downhill, and how far.
class Descent {
 public:
  Descent(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings)
      : body_(body), solver_(solver), settings_(settings) {}

  void correct_roughly() {
    if (shift_ != 0.0) return;
    double energy = body_.potential();
    vbond::correct_roughly(body_, solver_, settings_, [&](const Placement& from) {
      const double change = body_.potential_change(from, std::exchange(energy, body_.potential()));
      return change < 0.0 || is_unknowable(change);
    });
  }

  /// Empty if there is none.
  Vector direction() {
    if (!mean_stiffness_) mean_stiffness_ = mean_stiffness();
    const Vector& g = body_.unbalanced();
    const auto downhill = [&g](const Vector& x) { return x.size() > 0 && x.allFinite() && x.dot(g) > 0.0; };
    const bool ready = shift_ == 0.0 ? solver_.take_definite(body_) : solver_.factor_definite(body_, shift_);
    if (!ready && !find_shift()) return {};
    if (shift_ == 0.0)
      if (const Vector x = solver_.solve_full(body_, g, accuracy_for(body_, settings_)); downhill(x))
        return limited(body_, x);
    Vector x = solver_.solve(g);
    while (!downhill(x) && find_shift()) x = solver_.solve(g);  // multigrid tells only now
    return downhill(x) ? limited(body_, x) : Vector();
  }

  /// Half as far until the potential is lower, or near balance the residual. False: it never is.
  bool search(const Vector& x) {
    const Placement from = body_.placement();
    const double energy = body_.potential();
    const double slope = x.dot(body_.unbalanced()), residual = body_.residual();
    double length = 1.0;
    for (int halvings = 0; halvings < 40; ++halvings, length *= 0.5) {
      const double change = try_at(length, x, from, energy);
      const bool lower = change <= -1e-4 * length * slope;
      const bool unknowable = is_unknowable(length * slope);  // then the residual decides
      const double left = body_.residual();
      if ((lower && std::isfinite(left)) || (unknowable && left < residual)) {
        if (lower && halvings == 0 && shift_ > 0.0) go_farther(x, from, energy, change);
        if (halvings == 0) shift_ = shift_ > least_shift() ? 0.1 * shift_ : 0.0;
        return true;
      }
    }
    body_.restore(from);
    return false;
  }

 private:
  /// Near balance the potential says nothing any more of a step that lowers it by so much.
  bool is_unknowable(double lowering) const {
    return std::abs(lowering) <= 1e3 * body_.rounding_of_potential();
  }

  /// The least shift, within a factor of 10, that makes the tangent positive definite; above the present one.
  bool find_shift() {
    for (double shift = std::max(100.0 * shift_, least_shift()); shift < 1e6 * *mean_stiffness_;
         shift *= 100.0) {
      if (!solver_.factor_definite(body_, shift)) continue;
      shift_ = 0.1 * shift;
      if (solver_.factor_definite(body_, shift_)) return true;
      shift_ = shift;
      return solver_.factor_definite(body_, shift_);
    }
    return false;
  }
  double least_shift() const { return 1e-12 * *mean_stiffness_; }
  double mean_stiffness() const {
    const SparseMatrix& K = body_.tangent();
    const double mean = K.rows() > 0 ? K.diagonal().cwiseAbs().mean() : 1.0;
    // of contacts alone that just begin to touch: none, and steps of the length scale will do
    return mean == 0.0 ? max_norm(body_.unbalanced()) / body_.unknowns().length() : mean;
  }

  double try_at(double length, const Vector& x, const Placement& from, double energy) {
    body_.restore(from);
    body_.move(length * x, from.load_factor);
    return body_.potential_change(from, energy);
  }

  /// The shift makes steps short, along a mode that softens above all: twice as far as long as that is lower.
  void go_farther(const Vector& x, const Placement& from, double energy, double change) {
    const double most = largest_change / change_of(body_, x);
    double length = 1.0;
    while (2.0 * length <= most && length < 0x1p20) {
      const double farther = try_at(2.0 * length, x, from, energy);
      if (!(farther < change)) break;
      change = farther;
      length *= 2.0;
    }
    try_at(length, x, from, energy);
  }

  StaticBody& body_;
  TangentSolver& solver_;
  const NewtonSettings& settings_;
  std::optional<double> mean_stiffness_;  // where the first tangent was asked for
  double shift_ = 0.0;
};

}  // namespace

NewtonOutcome settle(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                     const std::function<bool()>& interrupted, int& iterations, Reach reach) {
  if (body.has_moment_part()) {
    const Placement from = body.placement();
    NewtonOutcome outcome = correct(body, solver, settings, interrupted);
    iterations += outcome.iterations();
    if (outcome.converged || outcome.interrupted) return outcome;
    body.restore(from);
    if (solver.factors_full(body)) {
      outcome = correct_with_care(body, solver, settings, interrupted);
      iterations += outcome.iterations();
      if (outcome.converged || outcome.interrupted || reach == Reach::near) return outcome;
      body.restore(from);
    }
  }
  NewtonOutcome outcome = minimise(body, solver, settings, interrupted);
  iterations += outcome.iterations();
  if (outcome.converged || outcome.interrupted || !body.flows()) return outcome;
  // flow that has no potential of its own, as shear of bonds that stretching weakens: downhill is near only
  NewtonOutcome last = correct(body, solver, settings, interrupted);
  iterations += last.iterations();
  return last.converged || last.interrupted ? last : outcome;
}

NewtonOutcome minimise(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                       const std::function<bool()>& interrupted) {
  Descent descent(body, solver, settings);
  const NewtonStep step = [&](const std::vector<double>& residuals) -> std::optional<NewtonStop> {
    descent.correct_roughly();  // without a tangent, while that leads on
    if (in_balance(body, settings)) return {};
    const Vector x = descent.direction();  // by the tangent, which is shifted until it is positive definite
    if (x.size() > 0 && descent.search(x)) return {};  // as far along x as the potential falls
    return NewtonStop{
        fmt::format("no way downhill at an unbalanced force of {:.2g} of the largest", residuals.back()),
        close_to_rounding(body)};
  };
  return iterate(body, settings, interrupted, step);
}

NewtonOutcome iterate(StaticBody& body, const NewtonSettings& settings,
                      const std::function<bool()>& interrupted, const NewtonStep& step) {
  NewtonOutcome outcome;
  for (int k = 0; k <= settings.iterations; ++k) {
    outcome.residuals.push_back(body.residual());
    outcome.converged = balanced(body, settings, outcome.residuals);
    outcome.interrupted = !outcome.converged && interrupted && interrupted();
    if (outcome.converged || outcome.interrupted) return outcome;
    if (!std::isfinite(outcome.residuals.back())) {
      outcome.why = why_not_finite(body);
      return outcome;
    }
    if (std::optional<NewtonStop> stop = step(outcome.residuals)) {
      outcome.converged = stop->balanced;
      outcome.why = std::move(stop->why);
      return outcome;
    }
  }
  outcome.why = fmt::format("{} iterations, unbalanced force {:.2g} of the largest", settings.iterations,
                            outcome.residuals.back());
  return outcome;
}

bool in_balance(const StaticBody& body, const NewtonSettings& settings) {
  return body.residual() <= std::max(settings.tolerance, body.residual_of_rounding());
}

bool close_to_rounding(const StaticBody& body) {
  return body.residual() <= 100.0 * body.residual_of_rounding();
}

bool balanced(const StaticBody& body, const NewtonSettings& settings, const std::vector<double>& residuals) {
  if (in_balance(body, settings)) return true;
  const std::size_t n = residuals.size();
  const bool stalled = n >= 3 && residuals[n - 1] > 0.3 * residuals[n - 3];
  return stalled && close_to_rounding(body);
}

double change_of(const StaticBody& body, const Vector& x) {
  return larger(body.largest_bond_change(x), body.largest_change_of_terms(x));
}

NewtonOutcome correct(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                      const std::function<bool()>& interrupted) {
  constexpr double growth = 10.0;  // of the residual in an iteration: first steps may overshoot
  const auto singular = [&] {
    NewtonStop stop{"the tangent is singular"};
    if (!solver.factors_full(body))
      stop.why += ": " + body.unknowns().name(solver.last_factor().singular_unknown());
    return stop;
  };
  const NewtonStep step = [&](const std::vector<double>& residuals) -> std::optional<NewtonStop> {
    const std::size_t n = residuals.size();
    if (n > 2 && !(residuals[n - 1] < growth * residuals[n - 2]))
      return NewtonStop{
          fmt::format("the unbalanced force grows, to {:.2g} of the largest", residuals.back())};
    correct_roughly(body, solver, settings, [](const Placement&) { return true; });
    if (in_balance(body, settings)) return {};
    if (!solver.take_full(body)) return singular();
    Vector x;
    try {
      x = solver.solve_full(body, body.unbalanced(), accuracy_for(body, settings));
    } catch (const NoConvergence& e) {  // of multigrid
      return NewtonStop{e.what()};
    }
    if (x.size() == 0 && !solver.by_multigrid()) return singular();
    if (x.size() == 0 || !x.allFinite() || !(change_of(body, x) <= largest_change))
      return NewtonStop{"a correction turns bonds too far"};
    body.move(x, body.load_factor());
    return {};
  };
  return iterate(body, settings, interrupted, step);
}

}  // namespace vbond
