#include "vbond/statics/detail/breaking_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "vbond/statics/detail/rigid.hpp"

namespace vbond {
namespace {

/// Longest predictor: bonds turn by no more than this.  [rad]
constexpr double largest_prediction = 0.3;
/// Of the work of a step, as a part of it; and of what rounding may do, as a part of the energy in the books.
constexpr double work_error = 1e-10, rounding_error = 1e-12;

bool moves(const StaticSupport& s) {
  return !(s.displacement == Vec3d{} && s.rotation == Vec3d{});
}

/// The unknowns that lead from one placement to another.
Vector way(const StaticBody& body, const Placement& from, const Placement& to) {
  const Unknowns& unknowns = body.unknowns();
  Vector x(unknowns.size());
  for (int k = 0; k < unknowns.size(); ++k) {
    const auto [p, dof] = unknowns.place(k);
    x[k] = dof < 3 ? component(to.r[p] - from.r[p], dof)
                   : unknowns.length() * component(rotation_vector(to.q[p] * conjugate(from.q[p])), dof - 3);
  }
  return x;
}

/// As many unknowns as there are columns, such that no combination of columns leaves all of them where they
/// are: Gauss's elimination, the largest entry first.
std::vector<int> holding_unknowns(const SparseMatrix& columns) {
  std::vector<int> chosen;
  std::vector<Eigen::SparseVector<double>> done;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    Eigen::SparseVector<double> v = columns.col(k);
    for (std::size_t j = 0; j < done.size(); ++j)
      if (const double c = v.coeff(chosen[j]); c != 0.0) v -= c * done[j];
    int pivot = -1;
    double largest = 0.0;
    for (Eigen::SparseVector<double>::InnerIterator it(v); it; ++it)
      if (std::abs(it.value()) > largest)
        largest = std::abs(it.value()), pivot = static_cast<int>(it.index());
    chosen.push_back(pivot);
    done.push_back(v / v.coeff(pivot));
  }
  return chosen;
}

std::string first_of(const std::vector<std::string>& names) {
  std::string text;
  constexpr std::size_t named = 6;
  for (std::size_t k = 0; k < std::min(named, names.size()); ++k) text += (k > 0 ? ", " : "") + names[k];
  if (names.size() > named) text += fmt::format(" and {} more", names.size() - named);
  return text;
}

}  // namespace

BreakingBody::BreakingBody(const Model& model, const StaticStage& stage, State balanced,
                           const StaticHooks& hooks, StaticResult& result)
    : model_(model), hooks_(hooks), result_(result), stage_(std::make_unique<StaticStage>(stage)) {
  begin(std::move(balanced), 0.0);
}

void BreakingBody::begin(State state, double load_factor) {
  body_ = std::make_unique<StaticBody>(model_, *stage_, std::move(state), load_factor);
  solver_ = std::make_unique<TangentSolver>(stage_->newton.solver);
  const auto first = std::find_if(stage_->supports.begin(), stage_->supports.end(), moves);
  moved_ = first != stage_->supports.end() ? &*first : nullptr;
  rate_.resize(0);
}

double BreakingBody::reaction(const StaticSupport& s) const {
  const double along = norm(s.displacement);
  return body_->power_of(s) / (along > 0.0 ? along : norm(s.rotation));
}

double BreakingBody::load() const {
  return moved_ ? reaction(*moved_) : load_factor();
}

std::optional<double> BreakingBody::largest_reaction() const {
  if (!moved_) return std::nullopt;
  double largest = 0.0;
  for (const StaticSupport& s : stage_->supports)
    if (moves(s)) largest = larger(largest, std::abs(reaction(s)));
  return largest;
}

Balance BreakingBody::here() const {
  const double power = (moved_ ? body_->power_of_supports() : 0.0) + body_->power_of_heating();
  return {body_->placement(), power, body_->energies().potential(), body_->dissipated(),
          most_used_bond(body_->state(), load_factor())};
}

bool BreakingBody::is_stable() {
  rate_.resize(0);
  if (body_->unknowns().size() == 0) return true;
  const bool definite = solver_->factor_definite(*body_);
  if (definite || (body_->has_moment_part() && solver_->factor(*body_)))
    rate_ = solver_->solve_full(*body_, body_->load_direction());
  return definite || body_->has_moment_part();
}

double BreakingBody::longest_step() const {
  if (rate_.size() == 0 || !rate_.allFinite()) return std::numeric_limits<double>::infinity();
  const double change = body_->largest_bond_change(rate_, 1.0);
  return std::isfinite(change) ? largest_prediction / change : std::numeric_limits<double>::infinity();
}

bool BreakingBody::correct_here() {
  const NewtonOutcome outcome = correct(*body_, *solver_, stage_->newton, hooks_.interrupted);
  result_.iterations += outcome.iterations();
  result_.residuals = outcome.residuals;
  return outcome.converged;
}

bool BreakingBody::step_to(double load_factor) {
  const Placement from = body_->placement();
  Vector x = Vector::Zero(body_->unknowns().size());
  if (rate_.size() == x.size() && rate_.allFinite()) x = (load_factor - from.load_factor) * rate_;
  body_->move(x, load_factor);
  const Placement predicted = body_->placement();
  if (correct_here() && is_near(from, distance(from, predicted, body_->unknowns().length()))) return true;
  body_->restore(from);
  return false;
}

/// A smooth step goes as far as the tangent says, but for its curvature: twice as far is a jump.
bool BreakingBody::is_near(const Placement& from, double expected) const {
  constexpr double far = 2.0, rounding = 1e-9;
  const double length = body_->unknowns().length();
  return distance(from, body_->placement(), length) <= far * expected + rounding * length;
}

bool BreakingBody::came_smoothly(const Placement& from) {
  if (rate_.size() == 0) return true;
  const Placement here = body_->placement();
  body_->move((from.load_factor - here.load_factor) * rate_, from.load_factor);
  const double expected = distance(here, body_->placement(), body_->unknowns().length());
  body_->restore(here);
  return is_near(from, expected);
}

bool BreakingBody::balance_between(const Placement& a, const Placement& b, double load_factor) {
  const double part = (load_factor - a.load_factor) / (b.load_factor - a.load_factor);
  const Vector x = part * way(*body_, a, b);
  body_->restore(a);
  body_->move(x, load_factor);
  return correct_here();
}

bool BreakingBody::settle() {
  const Placement from = body_->placement();
  const NewtonOutcome outcome =
      vbond::settle(*body_, *solver_, stage_->newton, hooks_.interrupted, result_.iterations);
  result_.residuals = outcome.residuals;
  if (outcome.converged) return true;
  body_->restore(from);
  return false;
}

double BreakingBody::trapezium(const Balance& a, const Balance& b) const {
  const double f_a = a.at.load_factor, f_b = b.at.load_factor;
  return body_->work_of_loads(a.at, b.at, 0.5 * (f_a + f_b)) + 0.5 * (a.power + b.power) * (f_b - f_a);
}

/// Where bonds begin to flow, or to unload, the reaction has a kink, at which sums of higher order are no
/// better: the part of the way that closes worst is halved, until all do together.
double BreakingBody::work_between_kinks(const Balance& a, const Balance& b, double scale) {
  constexpr int most_balances = 100, at_least = 12;  // what does not fall by then is not the sum's to mend
  struct Part {
    Balance from, to;
    double trapezium, work;
    double open() const { return std::abs(work - (to.spent() - from.spent())); }
  };
  const auto part = [this](const Balance& from, const Balance& to) {
    const double sum = trapezium(from, to);
    return Part{from, to, sum, sum};
  };
  const double spent = b.spent() - a.spent();
  const double within =
      work_error * std::abs(spent) + rounding_error * scale + body_->rounding_of_potential();
  std::vector<Part> parts{part(a, b)};
  double open_before = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most_balances; ++k) {
    double open = 0.0;
    for (const Part& p : parts) open += p.open();
    if (open <= within) break;
    if (k % at_least == 0 && open > 0.5 * std::exchange(open_before, open)) break;
    const auto worst = std::max_element(parts.begin(), parts.end(),
                                        [](const Part& x, const Part& y) { return x.open() < y.open(); });
    if (!balance_between(worst->from.at, worst->to.at,
                         0.5 * (worst->from.at.load_factor + worst->to.at.load_factor)))
      break;
    Part first = part(worst->from, here()), second = part(first.to, worst->to);
    const double better = (first.trapezium + second.trapezium - worst->trapezium) / 3.0;
    first.work += 0.5 * better, second.work += 0.5 * better;
    *worst = std::move(first);
    parts.push_back(std::move(second));
  }
  double work = 0.0;
  for (const Part& p : parts) work += p.work;
  restore(b);
  return work;
}

double BreakingBody::work_between(const Balance& a, const Balance& b, double scale) {
  if (body_->flows()) return work_between_kinks(a, b, scale);
  constexpr int most_halvings = 5;
  std::vector<Balance> nodes{a, b};
  std::vector<double> sums{trapezium(a, b)};  // a row of Romberg's scheme, its best last
  const double stored = b.stored - a.stored;
  const auto known = [&] {
    return std::abs(sums.back() - stored) <= work_error * std::abs(stored) + rounding_error * scale;
  };
  for (int halvings = 0; halvings < most_halvings && !known(); ++halvings) {
    std::vector<Balance> finer{nodes.front()};
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      const Placement &from = nodes[k - 1].at, &to = nodes[k].at;
      if (!balance_between(from, to, 0.5 * (from.load_factor + to.load_factor))) break;
      finer.push_back(here());
      finer.push_back(nodes[k]);
    }
    if (finer.size() != 2 * nodes.size() - 1) break;
    nodes = std::move(finer);
    std::vector<double> row{0.0};
    for (std::size_t k = 1; k < nodes.size(); ++k) row[0] += trapezium(nodes[k - 1], nodes[k]);
    for (double power = 4.0; row.size() <= sums.size(); power *= 4.0)
      row.push_back(row.back() + (row.back() - sums[row.size() - 1]) / (power - 1.0));
    sums = std::move(row);
  }
  restore(b);
  return sums.back();
}

std::optional<std::string> BreakingBody::hold_free_parts() {
  constexpr double nothing = 1e-9;  // of the loads that drive a part: rounding
  const RigidMotions free = free_rigid_motions(model_, body_->state(), body_->unknowns());
  if (free.names.empty()) return std::nullopt;
  for (const double factor : {0.0, stage_->fracture.end}) {
    const Vector loads = body_->applied(factor), along = free.basis.transpose() * loads;
    for (Eigen::Index k = 0; k < along.size(); ++k)
      if (std::abs(along[k]) > nothing * loads.norm()) return first_of(free.names);
  }
  tell(*stage_, hooks_,
       fmt::format(
           "load factor {:.6g}: nothing holds a part any more, which is held where it is from now on: {}",
           load_factor(), first_of(free.names)));
  for (const int unknown : holding_unknowns(free.basis)) {
    const auto [particle, dof] = body_->unknowns().place(unknown);
    StaticSupport hold{"", {particle}, {}, {}, {}};
    hold.held[static_cast<std::size_t>(dof)] = true;
    stage_->supports.push_back(std::move(hold));
  }
  ++result_.fracture.released_parts;
  const double factor = load_factor();
  begin(std::move(*body_).take_state(), factor);
  return std::nullopt;
}

}  // namespace vbond
