#include "vbond/statics/detail/newton.hpp"

#include <fmt/format.h>

#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/core/memory.hpp"

namespace vbond {
namespace {

/// Lets the factor of the symmetric part precondition the full tangent.
class FactorPreconditioner {
 public:
  using MatrixType = SparseMatrix;
  void use(const Factor& factor) { factor_ = &factor; }
  template <class M>
  FactorPreconditioner& analyzePattern(const M&) {
    return *this;
  }
  template <class M>
  FactorPreconditioner& factorize(const M&) {
    return *this;
  }
  template <class M>
  FactorPreconditioner& compute(const M&) {
    return *this;
  }
  template <class B>
  Vector solve(const B& b) const {
    return factor_->solve(b);
  }
  Eigen::ComputationInfo info() const { return Eigen::Success; }

 private:
  const Factor* factor_ = nullptr;
};

/// A linear step turns bonds by angles; beyond this it is no guide.  [rad]
constexpr double largest_change = 0.5;

/// Walls likewise: half a radius, and nothing comes through one unseen.
double change_of(const StaticBody& body, const Vector& x) {
  return larger(body.largest_bond_change(x), body.largest_wall_change(x));
}

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

/// Whether a balance by multigrid is surely the quicker one. Both take as long where a factor takes some 7e3
/// operations for each entry of the tangent (blocks of 14^3 particles, docs/decisions/statics.md); it must be
/// three times that, since slender bodies take multigrid longer.
bool multigrid_pays(const Factor& factor, const SparseMatrix& K) {
  constexpr double operations_per_entry = 2e4;
  return factor.operations() > operations_per_entry * static_cast<double>(K.nonZeros());
}

/// To what part of what is unbalanced a correction is worth solving for: to a hundredth of what is accepted,
/// and not beyond what curvature is likely to leave.
double accuracy_for(const StaticBody& body, const NewtonSettings& settings) {
  return std::clamp(1e-2 * settings.tolerance / body.residual(), 1e-6, 1e-2);
}

}  // namespace

bool in_balance(const StaticBody& body, const NewtonSettings& settings) {
  return body.residual() <= std::max(settings.tolerance, body.residual_of_rounding());
}

bool balanced(const StaticBody& body, const NewtonSettings& settings, const std::vector<double>& residuals) {
  constexpr double close = 100.0;
  if (in_balance(body, settings)) return true;
  const std::size_t n = residuals.size();
  const bool stalled = n >= 3 && residuals[n - 1] > 0.3 * residuals[n - 3];
  return stalled && residuals.back() <= close * body.residual_of_rounding();
}

struct TangentSolver::ConjugateGradients {
  SparseMatrix A;
  Eigen::ConjugateGradient<SparseMatrix, Eigen::Lower | Eigen::Upper, Eigen::IncompleteCholesky<double>>
      method;
};

/// One preconditioner for all tangents of a balance, as long as it does: made anew where gradients take twice
/// the iterations for a digit that they took first, and where they end without a solution.
struct TangentSolver::ByMultigrid {
  Multigrid preconditioner;
  const StaticBody* body = nullptr;
  const SparseMatrix* A = nullptr;
  double shift = 0, made_shift = 0;
  double first_price = 0, price = 0;  // iterations per digit, of the first solution and of the last
  bool fresh = false;                 // made for this tangent

  void take(const StaticBody& of, double by) {
    body = &of;
    A = &of.tangent();
    shift = by;
    fresh = false;
  }
  void make() {
    make(shift);
    fresh = true;
  }
  void make(double by) {
    preconditioner.make(*A, by, body->unknowns(), body->state().r);
    made_shift = by;
    first_price = price = 0.0;
  }
  bool is_due() const {
    return !preconditioner.at_hand() || made_shift != shift || (!fresh && price > 2.0 * first_price);
  }
  Vector inverse(const Vector& r) const { return preconditioner.solve(r); }
  Vector times(const Vector& p) const {
    Vector y = A->transpose() * p;  // symmetric: rows are quicker
    if (shift > 0.0) y += shift * p;
    return y;
  }

  Vector solve(const Vector& b, double accuracy) {
    if (is_due()) make();
    if (std::optional<Vector> x = gradients(b, accuracy)) return std::move(*x);
    if (fresh) return {};
    make();
    return gradients(b, accuracy).value_or(Vector());
  }
  std::optional<Vector> gradients(const Vector& b, double accuracy) {
    constexpr double most = 1000;
    GradientsMade made;
    const std::optional<Vector> x =
        conjugate_gradients([this](const Vector& p) { return times(p); },
                            [this](const Vector& r) { return inverse(r); }, b, {0.0, accuracy}, most, &made);
    if (x && made.left < 1.0) price = static_cast<double>(made.alpha.size()) / -std::log10(made.left);
    if (first_price == 0.0) first_price = price;
    return x;
  }

  /// The preconditioner must be definite also where the tangent is not: then it is that of one with a shift.
  Multigrid::Lowest lowest(int most) {
    if (!preconditioner.at_hand()) make();
    const double size = max_norm(A->diagonal());
    for (double by = 1e-4 * size;; by *= 10.0) try {
        return preconditioner.lowest(*A, most);
      } catch (const NoConvergence&) {
        if (by > size) throw;
        make(by);
      }
  }
};

TangentSolver::TangentSolver(LinearSolver wanted, FactorUse factors) : wanted_(wanted), factors_(factors) {}
TangentSolver::~TangentSolver() = default;

void TangentSolver::prepare(const StaticBody& body) {
  if (body.pattern_version() == analysed_) return;
  constexpr double share_of_memory = 0.6;  // the rest: the matrix, the state, and everybody else
  analysed_ = body.pattern_version();
  drop_kept();
  iterative_.reset();
  multigrid_.reset();
  if (wanted_ == LinearSolver::multigrid && !has_multigrid())
    throw NoEquilibrium(body.stage().name, "this build has no multigrid",
                        "build with the preset petsc, or use solver = \"automatic\"");
  bool direct = wanted_ == LinearSolver::automatic || wanted_ == LinearSolver::direct;
  bool multigrid = wanted_ == LinearSolver::multigrid;
  if (direct) {
    factor_.analyse(body.tangent());
    if (wanted_ == LinearSolver::automatic) {
      const bool fits = factor_.bytes() <= share_of_memory * memory_limit();
      const bool may = has_multigrid() && body.stage().kind == StageKind::equilibrium;
      multigrid = may && (!fits || multigrid_pays(factor_, body.tangent()));
      direct = fits && !multigrid;
    }
  }
  if (multigrid)
    multigrid_ = std::make_unique<ByMultigrid>();
  else if (!direct)
    iterative_ = std::make_unique<ConjugateGradients>();
}

bool TangentSolver::factor_definite(const StaticBody& body, double shift) {
  prepare(body);
  lost_ = false;
  if (multigrid_) {
    multigrid_->take(body, shift);
    return true;
  }
  if (!iterative_) {
    drop_kept();
    const bool definite = factor_.factor_definite(body.tangent(), shift);
    if (definite && shift == 0.0 && may_keep() && !body.is_unsymmetric()) kept_.begin(body.tangent());
    return definite;
  }
  SparseMatrix& A = iterative_->A = body.tangent();
  if (shift > 0.0) A.diagonal().array() += shift;
  iterative_->method.setTolerance(1e-12);
  iterative_->method.setMaxIterations(20 * A.rows());
  iterative_->method.compute(A);
  return iterative_->method.info() == Eigen::Success;
}

std::optional<int> TangentSolver::factor(const StaticBody& body) {
  prepare(body);
  if (iterative()) {
    factor_definite(body);
    return std::nullopt;
  }
  if (TangentSolver::factor_definite(body)) return 0;
  return factor_.factor_indefinite(body.tangent());
}

bool TangentSolver::may_keep() const {
  constexpr double least = 5.0;  // below that a factor costs no more than one equation solved by iteration
  return factors_ == FactorUse::kept ||
         (factors_ == FactorUse::kept_if_cheaper && factor_.cost_in_solutions() >= least);
}

void TangentSolver::note_break(std::vector<int> unknowns) {
  if (kept_.at_hand()) breaks_.push_back(std::move(unknowns));
}

void TangentSolver::drop_kept() {
  kept_.drop();
  breaks_.clear();
  present_ = nullptr;
}

bool TangentSolver::kept_for(const StaticBody& body) {
  prepare(body);
  lost_ = false;
  if (!kept_.at_hand() || body.is_unsymmetric()) return false;
  present_ = &body.tangent();
  for (const std::vector<int>& unknowns : std::exchange(breaks_, {}))
    if (kept_.at_hand()) kept_.follow(*present_, unknowns);
  return kept_.at_hand() && !kept_.is_due();
}

bool TangentSolver::take_definite(const StaticBody& body) {
  any_signs_ = false;
  return kept_for(body) || factor_definite(body);
}

bool TangentSolver::take(const StaticBody& body) {
  any_signs_ = true;
  return kept_for(body) || factor(body) || iterative();
}

bool TangentSolver::is_definite(const StaticBody& body) {
  any_signs_ = false;
  if (kept_for(body) && kept_.shows_definite(*present_)) return true;
  return factor_definite(body);
}

Vector TangentSolver::solve(const Vector& b, double accuracy) {
  if (lost_) return {};
  if (multigrid_) return multigrid_->solve(b, accuracy);
  if (!iterative_ && !present_) return factor_.solve(b);
  if (!iterative_) {
    if (std::optional<Vector> x = kept_.solve(*present_, b, accuracy)) return std::move(*x);
    const SparseMatrix& A = *std::exchange(present_, nullptr);
    drop_kept();
    if (factor_.factor_definite(A)) {
      kept_.begin(A);
      return factor_.solve(b);
    }
    lost_ = !any_signs_ || !factor_.factor_indefinite(A);
    return lost_ ? Vector() : factor_.solve(b);
  }
  const Vector x = iterative_->method.solve(b);
  return iterative_->method.info() == Eigen::Success ? x : Vector();
}

Multigrid::Lowest TangentSolver::lowest(const StaticBody& body, int most) {
  prepare(body);
  if (!multigrid_) throw std::logic_error("TangentSolver: lowest() is for multigrid");
  multigrid_->take(body, 0.0);
  return multigrid_->lowest(most);
}

Vector TangentSolver::solve_full(const StaticBody& body, const Vector& b, double accuracy) {
  if (!body.is_unsymmetric() || iterative()) return solve(b, accuracy);
  const SparseMatrix K = body.full_tangent();
  Eigen::BiCGSTAB<SparseMatrix, FactorPreconditioner> method;
  method.preconditioner().use(factor_);
  method.setTolerance(1e-13);
  method.setMaxIterations(200);
  method.compute(K);
  const Vector x = method.solve(b);
  // otherwise with the symmetric part alone: corrections are then less good, but what is out of balance
  // judges them
  return method.error() < 1e-6 ? x : solve(b);
}

NewtonOutcome correct(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                      const std::function<bool()>& interrupted) {
  constexpr double growth =
      10.0;  // of the residual from one iteration to the next: first steps may overshoot
  NewtonOutcome outcome;
  std::vector<double>& residuals = outcome.residuals;
  for (int k = 0; k <= settings.iterations; ++k) {
    residuals.push_back(body.residual());
    if (balanced(body, settings, residuals)) {
      outcome.converged = true;
      return outcome;
    }
    if (interrupted && interrupted()) {
      outcome.interrupted = true;
      outcome.why = "interrupted";
      return outcome;
    }
    if (!std::isfinite(residuals.back())) {
      outcome.why = why_not_finite(body);
      return outcome;
    }
    if (k > 1 && !(residuals.back() < growth * residuals[residuals.size() - 2])) {
      outcome.why = fmt::format("the unbalanced force grows, to {:.2g} of the largest", residuals.back());
      return outcome;
    }
    const auto singular = [&] {
      outcome.why =
          "the tangent is singular: " + body.unknowns().name(solver.last_factor().singular_unknown());
      return outcome;
    };
    if (!solver.take(body)) return singular();
    const Vector x = solver.solve_full(body, body.unbalanced(), accuracy_for(body, settings));
    if (x.size() == 0 && !solver.iterative()) return singular();
    if (x.size() == 0 || !x.allFinite() || !(change_of(body, x) <= largest_change)) {
      outcome.why = "a correction turns bonds too far";
      return outcome;
    }
    body.move(x, body.load_factor());
  }
  outcome.why = fmt::format("{} iterations", settings.iterations);
  return outcome;
}

namespace {

/// One iteration of minimise: a direction that goes downhill, and how far.
class Descent {
 public:
  Descent(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings)
      : body_(body), solver_(solver), settings_(settings) {
    const SparseMatrix& K = body.tangent();
    mean_stiffness_ = K.rows() > 0 ? K.diagonal().cwiseAbs().mean() : 1.0;
    // of contacts alone that just begin to touch: none, and steps of the length scale will do
    if (mean_stiffness_ == 0.0) mean_stiffness_ = max_norm(body.unbalanced()) / body.unknowns().length();
  }

  /// False if nothing lower, or better balanced, was found in the direction.
  bool step() {
    const Vector x = direction();
    return x.size() > 0 && search(x);
  }

 private:
  Vector direction() {
    const Vector& g = body_.unbalanced();
    const auto downhill = [&g](const Vector& x) { return x.size() > 0 && x.allFinite() && x.dot(g) > 0.0; };
    const bool ready = shift_ == 0.0 ? solver_.take_definite(body_) : solver_.factor_definite(body_, shift_);
    if (!ready && !find_shift()) return {};
    if (shift_ == 0.0)
      if (const Vector x = solver_.solve_full(body_, g, accuracy_for(body_, settings_)); downhill(x))
        return limited(body_, x);
    Vector x = solver_.solve(g);
    while (!downhill(x) && find_shift()) x = solver_.solve(g);  // conjugate gradients tell only now
    return downhill(x) ? limited(body_, x) : Vector();
  }

  /// The least shift, within a factor of 10, that makes the tangent positive definite; above the present one.
  bool find_shift() {
    for (double shift = std::max(100.0 * shift_, least_shift()); shift < 1e6 * mean_stiffness_;
         shift *= 100.0) {
      if (!solver_.factor_definite(body_, shift)) continue;
      shift_ = 0.1 * shift;
      if (solver_.factor_definite(body_, shift_)) return true;
      shift_ = shift;
      return solver_.factor_definite(body_, shift_);
    }
    return false;
  }
  double least_shift() const { return 1e-12 * mean_stiffness_; }

  bool search(const Vector& x) {
    const Placement from = body_.placement();
    const double energy = body_.potential(), rounding = body_.rounding_of_potential();
    const double slope = x.dot(body_.unbalanced()), residual = body_.residual();
    double length = 1.0;
    for (int halvings = 0; halvings < 40; ++halvings, length *= 0.5) {
      const double change = try_at(length, x, from, energy);
      // near balance the potential says nothing any more: then the residual decides
      const bool lower = change <= -1e-4 * length * slope;
      const bool unknowable = std::abs(length * slope) <= 1e3 * rounding;
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
  double mean_stiffness_ = 1.0;
  double shift_ = 0.0;
};

}  // namespace

NewtonOutcome minimise(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                       const std::function<bool()>& interrupted) {
  NewtonOutcome outcome;
  Descent descent(body, solver, settings);
  for (int k = 0; k <= settings.iterations; ++k) {
    outcome.residuals.push_back(body.residual());
    if (balanced(body, settings, outcome.residuals)) {
      outcome.converged = true;
      return outcome;
    }
    if (interrupted && interrupted()) {
      outcome.interrupted = true;
      outcome.why = "interrupted";
      return outcome;
    }
    if (!std::isfinite(outcome.residuals.back())) {
      outcome.why = why_not_finite(body);
      return outcome;
    }
    if (descent.step()) continue;
    outcome.converged = body.residual() <= 100.0 * body.residual_of_rounding();
    outcome.why = fmt::format("no way downhill at an unbalanced force of {:.2g} of the largest",
                              outcome.residuals.back());
    return outcome;
  }
  outcome.why = fmt::format("{} iterations, unbalanced force {:.2g} of the largest", settings.iterations,
                            outcome.residuals.back());
  return outcome;
}

NewtonOutcome settle(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                     const std::function<bool()>& interrupted, int& iterations) {
  if (body.has_moment_part()) {
    const Placement from = body.placement();
    NewtonOutcome outcome = correct(body, solver, settings, interrupted);
    iterations += outcome.iterations();
    if (outcome.converged || outcome.interrupted) return outcome;
    body.restore(from);
  }
  NewtonOutcome outcome = minimise(body, solver, settings, interrupted);
  iterations += outcome.iterations();
  if (outcome.converged || outcome.interrupted || !body.flows()) return outcome;
  // flow that has no potential of its own, as shear of bonds that stretching weakens: downhill is near only
  NewtonOutcome last = correct(body, solver, settings, interrupted);
  iterations += last.iterations();
  return last.converged || last.interrupted ? last : outcome;
}

}  // namespace vbond
