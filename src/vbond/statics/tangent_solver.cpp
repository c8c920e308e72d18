#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/core/memory.hpp"
#include "vbond/statics/detail/eigen_search.hpp"
#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/detail/rounding.hpp"

namespace vbond {
namespace {

/// Whether a balance by multigrid is surely the quicker one. Both take as long where a factor takes some 7e3
/// operations for each entry of the tangent (blocks of 14^3 particles, docs/decisions/statics.md); it must be
/// three times that, since slender bodies take multigrid longer.
bool multigrid_pays(const Factor& factor, const StaticBody& body) {
  constexpr double operations_per_entry = 2e4;
  return factor.operations() > operations_per_entry * static_cast<double>(body.tangent().nonZeros());
}

/// What multigrid cannot do needs factors.
bool suits_multigrid(const StaticBody& body) {
  return body.stage().kind != StageKind::fracture && !body.has_free_grips() && !body.has_free_cell();
}

}  // namespace

TangentSolver::TangentSolver(LinearSolver wanted, FactorUse factors, std::shared_ptr<Crew> crew)
    : wanted_(wanted), factors_(factors), kept_(factor_, std::move(crew)) {}
TangentSolver::~TangentSolver() = default;

TangentSolver::Choice TangentSolver::choose(const StaticBody& body) {
  constexpr double share_of_memory = 0.6;  // the rest: the matrix, the state, and everybody else
  if (wanted_ == LinearSolver::multigrid) return Choice::multigrid;
  factor_.analyse(body.tangent());
  if (wanted_ == LinearSolver::direct) return Choice::direct;
  const bool fits = factor_.bytes() <= share_of_memory * memory_limit();
  if (has_multigrid() && suits_multigrid(body) && (!fits || multigrid_pays(factor_, body)))
    return Choice::multigrid;
  return fits ? Choice::direct : Choice::none;
}

bool TangentSolver::would_be_quicker_by_multigrid(const StaticBody& body) const {
  return !has_multigrid() && suits_multigrid(body) && multigrid_pays(factor_, body);
}

void TangentSolver::prepare(const StaticBody& body) {
  if (!kept_.at_hand()) find_order(body);
}

void TangentSolver::find_order(const StaticBody& body) {
  if (body.pattern_version() == analysed_) return;
  drop_kept();
  multigrid_.reset();
  const std::string& stage = body.stage().name;
  if (wanted_ == LinearSolver::multigrid && !has_multigrid())
    throw NoEquilibrium(stage, "this build has no multigrid",
                        "build with the preset petsc, or use solver = \"automatic\"");
  if (wanted_ == LinearSolver::multigrid && body.stage().kind == StageKind::fracture)
    throw NoEquilibrium(stage, "fracture needs the factors of the tangent", "use solver = \"automatic\"");
  if (wanted_ == LinearSolver::multigrid && body.has_free_grips())
    throw NoEquilibrium(stage, "rigid groups that are free in part need the factors of the tangent",
                        "use solver = \"automatic\"");
  if (wanted_ == LinearSolver::multigrid && body.has_free_cell())
    throw NoEquilibrium(stage, "a cell that gives way to a stress needs the factors of the tangent",
                        "use solver = \"automatic\"");
  const Choice choice = choose(body);
  if (choice == Choice::none)
    throw NoEquilibrium(stage,
                        fmt::format("the factor of the tangent, {:.3g} GiB, does not fit into memory",
                                    factor_.bytes() / 0x1p30),
                        "fewer particles, or vbond-petsc, which solves large bodies by multigrid "
                        "(docs/install.md; not those of "
                        "fracture); with newton = {solver = \"direct\"} it is tried all the same");
  if (choice == Choice::multigrid) multigrid_ = std::make_unique<ByMultigrid>();
  analysed_ = body.pattern_version();
}

bool TangentSolver::factor_definite(const StaticBody& body, double shift) {
  find_order(body);
  lost_ = any_signs_ = false;
  if (multigrid_) {
    multigrid_->take(body, shift);
    return true;
  }
  drop_kept();
  const bool definite = factor_.factor_definite(body.tangent(), shift);
  if (definite && shift == 0.0 && may_keep() && !body.is_unsymmetric()) keep(body);
  return definite;
}

void TangentSolver::keep(const StaticBody& body) {
  kept_.begin(body.tangent());
  const State& s = body.state();
  kept_of_ = std::make_shared<const KeptFactorUnderWay::Place>(
      KeptFactorUnderWay::Place{s.r, s.q, s.cell, body.load_factor(), body.breaks(), body.pattern()});
}

KeptFactorUnderWay TangentSolver::kept_under_way() const {
  KeptFactorUnderWay now = kept_.under_way();
  if (kept_.at_hand()) now.made_at = kept_of_;
  return now;
}

void TangentSolver::go_on_with_kept(StaticBody& body, const KeptFactorUnderWay& then,
                                    const std::vector<BondId>& broken) {
  kept_.draw_on_from(then.random);
  if (!then.made_at) return;
  const KeptFactorUnderWay::Place& at = *then.made_at;
  body.make_room_for(at.pattern, false);
  body.stand_as_then({at.r, at.q, at.load_factor, at.cell}, broken);
  find_order(body);
  if (by_multigrid() || !factor_.factor_definite(body.tangent()) || !kept_.go_on_from(body.tangent(), then))
    return drop_kept();  // of another machine: a new one will do
  kept_of_ = then.made_at;
}

std::optional<int> TangentSolver::factor(const StaticBody& body) {
  find_order(body);
  if (multigrid_) return counted_by_multigrid(body);
  if (TangentSolver::factor_definite(body)) return 0;
  return factor_.factor_indefinite(body.tangent());
}

std::optional<int> TangentSolver::counted_by_multigrid(const StaticBody& body) {
  multigrid_->take(body, 0.0);
  any_signs_ = true;
  const Lowest& lowest = multigrid_->lowest();
  if (!(lowest.values[lowest.size() - 1] > 0.0) && lowest.size() < body.unknowns().size())
    throw NoConvergence(fmt::format(
        "multigrid: at least {} eigenvalues of the tangent are negative; solver = \"direct\" counts more",
        lowest.size()));
  const double zero = Deflated::zero(body.tangent());
  if ((lowest.values.array().abs() <= lowest.errors.array().max(zero)).any()) return std::nullopt;
  return static_cast<int>((lowest.values.array() < 0.0).count());
}

// Of those taken out some are known to be negative all the same.
Deflated TangentSolver::deflated(const StaticBody& body) {
  if (!multigrid_) return Deflated(body.tangent(), &factor_);
  const SparseMatrix& K = body.tangent();
  const Lowest& lowest = multigrid_->lowest();
  const auto zero = lowest.errors.array().max(Deflated::zero(K));
  const Eigen::Index first = (lowest.values.array() < -zero).count(),
                     number = (lowest.values.array() <= zero).count() - first;
  const auto negative =
      (lowest.values.array() < -lowest.errors.array().max(4.0 * eigenvalue_error(K))).count();
  return {lowest.vectors.middleCols(first, number), lowest.values.segment(first, number),
          static_cast<int>(negative), [this, first, number](const Vector& b) {
            return multigrid_->solve_beside(b, first, number, full_accuracy);
          }};
}

EigenPairs TangentSolver::near_zero(const StaticBody& body, int count) {
  find_order(body);
  if (!multigrid_) return eigenpairs_near_zero(body.tangent(), count, &factor_);
  const int size = body.unknowns().size();
  multigrid_->take(body, 0.0);  // the last vectors are at hand: looking again takes little
  for (int looked_at = count;; looked_at = std::min(2 * looked_at, size)) {
    const Lowest& lowest = multigrid_->lowest(looked_at);
    Found found;
    for (Eigen::Index k = 0; k < lowest.size(); ++k)
      found.add(std::abs(lowest.values[k]), lowest.values[k], lowest.vectors.col(k));
    found.sort();
    const bool all =
        found.size() >= count && lowest.values[lowest.size() - 1] >= found.key[std::size_t(count - 1)];
    if (all || lowest.size() >= size) return found.part(0, count);
  }
}

bool TangentSolver::may_keep() const {
  constexpr double least = 5.0;  // below that a factor costs no more than one equation solved by iteration
  return factors_ == FactorUse::kept ||
         (factors_ == FactorUse::kept_if_cheaper && factor_.cost_in_solutions() >= least);
}

void TangentSolver::note_change(const std::vector<int>& unknowns, const DenseMatrix& change) {
  if (!unknowns.empty() && kept_.at_hand() && !kept_.is_due()) kept_.follow(unknowns, change);
}

void TangentSolver::drop_kept() {
  kept_.drop();
  kept_of_.reset();
  present_ = nullptr;
}

bool TangentSolver::kept_for(const StaticBody& body) {
  prepare(body);
  lost_ = false;
  if (!kept_.at_hand() || body.is_unsymmetric() || kept_.is_due()) return false;
  present_ = &body.tangent();
  present_body_ = &body;
  kept_.follow(*present_);
  return kept_.at_hand();
}

bool TangentSolver::take_definite(const StaticBody& body) {
  any_signs_ = false;
  return kept_for(body) || factor_definite(body);
}

bool TangentSolver::take(const StaticBody& body) {
  if (kept_for(body)) {
    any_signs_ = true;
    return true;
  }
  const bool can = by_multigrid() ? factor_definite(body) : factor(body).has_value();
  any_signs_ = true;
  return can;
}

Vector TangentSolver::solve_roughly(const StaticBody& body, const Vector& b) {
  if (!kept_.at_hand() || body.is_unsymmetric() || kept_.is_due()) return {};
  return kept_.solve_roughly(b);
}

TangentSolver::Judged TangentSolver::judge(const StaticBody& body, const Vector& b, double accuracy) {
  any_signs_ = false;
  if (kept_for(body))
    if (std::optional<Vector> x = kept_.solve_if_definite(*present_, b, accuracy))
      return {true, std::move(x)};
  return {factor_definite(body), std::nullopt};
}

Vector TangentSolver::solve(const Vector& b, double accuracy) {
  if (lost_) return {};
  if (multigrid_) return any_signs_ ? multigrid_->solve_any(b, accuracy) : multigrid_->solve(b, accuracy);
  if (!present_) return factor_.solve(b);
  if (std::optional<Vector> x = kept_.solve(*present_, b, accuracy)) return std::move(*x);
  const SparseMatrix& A = *std::exchange(present_, nullptr);
  drop_kept();
  find_order(*present_body_);
  if (factor_.factor_definite(A)) {
    keep(*present_body_);
    return factor_.solve(b);
  }
  lost_ = !any_signs_ || !factor_.factor_indefinite(A);
  return lost_ ? Vector() : factor_.solve(b);
}

std::optional<DenseMatrix> TangentSolver::solve_columns_kept(const StaticBody& body, const DenseMatrix& B,
                                                             const DenseMatrix& X, double accuracy) {
  if (!kept_for(body)) return {};
  return kept_.solve_columns(body.tangent(), B, X, accuracy);
}

ByMultigrid& TangentSolver::multigrid_at(const StaticBody& body) {
  prepare(body);
  if (!multigrid_) throw std::logic_error("TangentSolver: multigrid_at() is for multigrid");
  multigrid_->take(body, 0.0);
  return *multigrid_;
}

}  // namespace vbond
