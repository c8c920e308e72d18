#include "vbond/statics/detail/breaking_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "vbond/model/holds.hpp"
#include "vbond/statics/detail/rigid.hpp"
#include "vbond/statics/detail/rounding.hpp"
#include "vbond/terms/walls/detail/rest_walls.hpp"

namespace vbond {
namespace {

/// Whether a motion is that of a particle, of a piece with no more than a hundredth of the mass, or of what
/// is left of the body, which the pressure on these no longer balances. Others are halves of a body that
/// parts.
bool is_of_a_chip(const StaticBody& body, const SparseMatrix& motions, Eigen::Index which) {
  constexpr double small = 0.01, most_of_it = 0.5;  // of the mass
  const PerParticle<double>& mass = body.model().mass;
  PerParticle<char> moves(mass.size(), 0);
  for (SparseMatrix::InnerIterator entry(motions, which); entry; ++entry)
    moves[body.unknowns().place(static_cast<int>(entry.row())).particle] = 1;
  double all = 0.0, of_these = 0.0;
  for (const ParticleId p : mass.ids()) all += mass[p], of_these += moves[p] != 0 ? mass[p] : 0.0;
  return of_these <= small * all || of_these > most_of_it * all ||
         std::count(moves.begin(), moves.end(), 1) == 1;
}

bool same_place(const Placement& a, const Placement& b) {
  return a.load_factor == b.load_factor && a.r == b.r && a.q == b.q && a.cell == b.cell;
}

/// How far a body is from where supports that are no grips have taken its particles since it stood elsewhere,
/// when the load factor was less by this: along what they hold, and about what is held as a whole. About
/// fewer axes a turn depends on the way there.
double off_supports(const std::vector<Support>& supports, const State& from, double progress,
                    const Placement& now, double length) {
  double farthest = 0.0;
  for (const Hold& h : holds_of(supports)) {
    const Support& s = supports[h.support];
    if (s.rigid) continue;
    const Vec3d off = now.r[h.particle] - from.r[h.particle] - progress * s.velocity;
    for (std::size_t dof = 0; dof < 3; ++dof)
      if (h.held[dof]) farthest = larger(farthest, std::abs(dot(off, axis_of(h.axes.get(), dof))));
    if (!(h.held[3] && h.held[4] && h.held[5])) continue;
    const Quatd belongs = rotation_of(progress * s.angular_velocity) * from.q[h.particle];
    farthest = larger(farthest, length * norm(rotation_vector(now.q[h.particle] * conjugate(belongs))));
  }
  return farthest;
}

}  // namespace

BreakingBody::BreakingBody(const Model& model, const StaticStage& stage, State balanced,
                           const StaticHooks& hooks, StaticResult& result)
    : model_(model),
      hooks_(hooks),
      result_(result),
      crew_(crew_of(hooks)),
      stage_(std::make_unique<StaticStage>(stage)) {
  begin(std::move(balanced), 0.0);
}

BreakingBody::BreakingBody(const Model& model, const StaticStage& stage, State now,
                           const FractureUnderWay& then, const StaticHooks& hooks, StaticResult& result)
    : model_(model),
      hooks_(hooks),
      result_(result),
      crew_(crew_of(hooks)),
      stage_(std::make_unique<StaticStage>(stage)) {
  const FractureUnderWay::Numbers& n = then.numbers;
  for (const HeldPart& part : then.held)
    if (part.why == HeldPart::Why::came_off) hold(part);
  begin(*then.begun, n.held_at);
  body_->set_turns_before(then.turns_of_grips);
  begun_ = then.begun;
  if (body_->unknowns().size() != n.unknowns) refuse_another_stage(then);
  go_on_with_kept_factor(then);
  if (n.flows || *then.pattern != body_->pattern()) body_->make_room_for(*then.pattern, n.flows);
  body_->go_on_from(std::move(now), n.load_factor, n.breaks, then.remembered_before);
  refuse_another_stage(then);
  body_->take_tangent_of(then.remembered_of_tangent);
  if (n.unknowns > 0) prepare_solver();
  // CHOLMOD's first factor in columns after an analysis is L D L^T, taken to L L^T then, which later ones are
  // at once: other last digits. Where none was made before, the first is still to come
  if (n.unknowns > 0 && then.found.factors > 0 && !solver_->has_kept()) solver_->factor_definite(*body_);
  rate_ = Eigen::Map<const Vector>(then.rate.data(), static_cast<Eigen::Index>(then.rate.size()));
  if (n.stable) stable_at_ = body_->placement();
  if (n.open) unstable_.reset();
  // where a bond has just broken the factor by which the rate was found is at hand, and is not made again
  const bool just_broken = !n.has_before && then.found.points > 1;
  if (just_broken && n.unknowns > 0 && body_->has_moment_part()) solver_->take_full(*body_);
  factors_before_ = then.found.factors - solver_->factors_made();
}

/// The bonds that have broken since body_ was made are the last ones.
void BreakingBody::go_on_with_kept_factor(const FractureUnderWay& then) {
  const std::vector<BrokenBond>& breaks = then.found.fracture.breaks;
  const auto first = static_cast<std::int64_t>(breaks.size()) - then.numbers.breaks;
  const std::int64_t number = then.factor.made_at ? then.factor.made_at->breaks : 0;
  std::vector<BondId> broken;
  for (std::int64_t k = 0; k < number; ++k)
    broken.push_back(breaks.at(static_cast<std::size_t>(first + k)).use.bond);
  solver_->go_on_with_kept(*body_, then.factor, broken);
}

/// Its loads, or what its supports hold, would be others than those that the body is in balance with.
void BreakingBody::refuse_another_stage(const FractureUnderWay& then) const {
  constexpr double far = 1e3, near = 1e-9;  // of what a balance may leave; of the length scale
  const bool fits = [&] {
    if (body_->unknowns().size() != then.numbers.unknowns) return false;
    if (!(body_->residual() <= far * std::max(stage_->newton.tolerance, body_->residual_of_rounding())))
      return false;
    const Placement here = body_->placement();
    body_->move(Vector::Zero(body_->unknowns().size()), here.load_factor);  // grips to where they belong
    const double length = body_->unknowns().length(), moved = distance(here, body_->placement(), length);
    body_->restore(here);
    const double off = off_supports(stage_->supports, *begun_, here.load_factor - begun_at_, here, length);
    return moved <= near * length && off <= near * length;
  }();
  if (fits) return;
  throw NoEquilibrium(
      stage_->name,
      fmt::format("load factor {:.6g}: the body that the checkpoint holds is not in balance in this stage",
                  then.numbers.load_factor),
      "supports, loads and walls of a stage of fracture that is under way stay as they are; undo the edit");
}

void BreakingBody::note(FractureUnderWay& now) const {
  FractureUnderWay::Numbers& n = now.numbers;
  n.load_factor = load_factor();
  n.held_at = begun_at_;
  n.breaks = body_->breaks();
  n.unknowns = body_->unknowns().size();
  n.flows = body_->flows();
  n.open = !unstable_;
  now.turns_of_grips = body_->turns_before();
  n.stable = stable_at_ && same_place(*stable_at_, body_->placement());
  n.cell_stress_at_start = stage_->cell_stress_at_start;
  now.found.factors = factors();
  now.rate.assign(rate_.data(), rate_.data() + rate_.size());
  now.held.insert(now.held.end(), held_.begin(), held_.end());
  now.begun = begun_;
  now.pattern = std::make_shared<const std::vector<Assembly::Pair>>(body_->pattern());
  if (body_->flows()) now.remembered_before = body_->remembered_before();
  if (body_->flows()) now.remembered_of_tangent = body_->remembered_of_tangent();
  now.factor = solver_->kept_under_way();
}

void BreakingBody::hold(const HeldPart& part) {
  held_.push_back(part);
  if (part.grip)
    free_grip_of(part.particle).held[part.dof] = true;
  else
    stage_->supports.push_back(support_of(part));
}

void BreakingBody::begin(State state, double load_factor) {
  const std::vector<Quatd> turned = body_ ? body_->turns_of_grips() : std::vector<Quatd>{};
  begun_ = std::make_shared<const State>(state);
  begun_at_ = load_factor;
  body_ = std::make_unique<StaticBody>(model_, *stage_, std::move(state), load_factor);
  body_->sum_with(crew_);
  body_->set_turns_before(turned);
  if (solver_) factors_before_ = factors();
  const bool may_keep = stage_->newton.solver == LinearSolver::automatic;
  solver_ = std::make_unique<TangentSolver>(
      stage_->newton.solver, may_keep ? FactorUse::kept_if_cheaper : FactorUse::new_each_time, crew_);
  const auto first = std::find_if(stage_->supports.begin(), stage_->supports.end(), moves);
  moved_ = first != stage_->supports.end() ? &*first : nullptr;
  rate_.resize(0);
  stable_at_.reset();
}

/// Where it stands, with other unknowns.
void BreakingBody::begin_anew() {
  const double factor = load_factor();
  begin(std::move(*body_).take_state(), factor);
}

double BreakingBody::reaction(const Support& s) const {
  return body_->reaction_along_motion(s);
}

double BreakingBody::reaction(const WallDrive& d) const {
  const auto& walls = body_->terms().of<RestWalls>();
  if (d.velocity != Vec3d{}) return -dot(walls.force_on(d.index), normalised(d.velocity));
  return walls.power()[static_cast<Eigen::Index>(d.index)] / norm(d.angular_velocity);
}

/// The stress of the first component of the cell that is moved this way; nothing where none is.
std::optional<double> BreakingBody::stress_of_cell(CellComponent::By by) const {
  for (std::size_t k = 0; k < 6; ++k)
    if (stage_->cell.component[k].by == by) return symmetric_part(cell_stress(model_, body_->state()))[k];
  return std::nullopt;
}

double BreakingBody::load() const {
  if (moved_) return reaction(*moved_);
  for (const auto by : {CellComponent::By::strain, CellComponent::By::stress})
    if (const std::optional<double> stress = stress_of_cell(by)) return *stress;
  return stage_->walls.empty() ? load_factor() : reaction(stage_->walls.front());
}

std::optional<double> BreakingBody::largest_reaction() const {
  if (stage_->cell.any_stress()) return std::nullopt;
  if (stage_->cell.any()) {
    const SymmetricParts stress = symmetric_part(cell_stress(model_, body_->state()));
    double largest = 0.0;
    for (const double x : stress) largest = larger(largest, std::abs(x));
    return largest;
  }
  if (!moved_ && stage_->walls.empty()) return std::nullopt;
  double largest = 0.0;
  for (const WallDrive& d : stage_->walls) largest = larger(largest, std::abs(reaction(d)));
  for (const Support& s : stage_->supports)
    if (moves(s)) largest = larger(largest, std::abs(reaction(s)));
  return largest;
}

Balance BreakingBody::here() const {
  const bool known = stable_at_ && rate_.allFinite() && same_place(*stable_at_, body_->placement()) &&
                     !body_->is_unsymmetric();
  return {stand_of(*body_, known ? rate_ : Vector()), most_used()};
}

std::optional<BondUse> BreakingBody::most_used() const {
  return most_used_bond(body_->state(), load_factor());
}

bool BreakingBody::is_stable() {
  constexpr double accuracy = 1e-7;  // of a prediction, which curvature makes no better
  if (stable_at_ && !body_->flows() && same_place(*stable_at_, body_->placement())) return true;
  stable_at_.reset();
  rate_.resize(0);
  if (body_->unknowns().size() == 0) return true;
  const auto [definite, solution] = solver_->judge(*body_, body_->load_direction(), accuracy);
  if (solution)
    rate_ = *solution;
  else if (definite || (body_->has_moment_part() && solver_->take_full(*body_)))
    rate_ = solver_->solve_full(*body_, body_->load_direction(), accuracy);
  const bool stable = definite || (body_->has_moment_part() && (body_->flows() || may_be_stable()));
  if (definite || !stable)
    unstable_ = definite ? 0 : 1;
  else
    unstable_.reset();
  if (stable) stable_at_ = body_->placement();
  return stable;
}

/// Beside outside moments, as judge_stability(): only eigenvalues below minus the antisymmetric part are
/// surely negative. Friction of what has cracked is left out: its part is as large as the stiffness.
bool BreakingBody::may_be_stable() const {
  const SparseMatrix& K = body_->tangent();
  return analysed(K).factor_definite(K, std::max(eigenvalue_error(K), body_->moment_part()));
}

void BreakingBody::break_bond(BondId k, BreakMode mode) {
  const Bond& bond = body_->state().bonds[k];
  std::vector<int> unknowns;
  for (const ParticleId p : {body_->unknowns().carrier(bond.i), body_->unknowns().carrier(bond.j)})
    for (int dof = 0; dof < 6; ++dof)
      if (const int u = body_->unknowns().of(p, dof); u != Unknowns::held) unknowns.push_back(u);
  std::sort(unknowns.begin(), unknowns.end());
  unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
  stable_at_.reset();
  const DenseMatrix before = body_->tangent_of(k, unknowns);
  body_->break_bond(k, mode);
  solver_->note_change(unknowns, body_->tangent_of(k, unknowns) - before);
}

double BreakingBody::longest_step() const {
  if (rate_.size() == 0 || !rate_.allFinite()) return std::numeric_limits<double>::infinity();
  const double change =
      larger(body_->largest_bond_change(rate_, 1.0), body_->largest_change_of_terms(rate_, 1.0));
  return std::isfinite(change) ? largest_prediction / change : std::numeric_limits<double>::infinity();
}

bool BreakingBody::step_to(double load_factor) {
  const Placement from = body_->placement();
  Vector x = Vector::Zero(body_->unknowns().size());
  if (rate_.size() == x.size() && rate_.allFinite()) x = (load_factor - from.load_factor) * rate_;
  body_->move(x, load_factor);
  const Placement predicted = body_->placement();
  if (way_here().correct_here() && is_no_jump(from, distance(from, predicted, body_->unknowns().length())))
    return true;
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
  return is_no_jump(from, expected);
}

/// Where contacts begin or end the tangents before and after say nothing of each other. Then it is no jump if
/// the body goes back to where it came from when the load does.
bool BreakingBody::is_no_jump(const Placement& from, double expected) {
  if (is_near(from, expected)) return true;
  if (model_.contact.law == ContactLaw::none) return false;
  constexpr double same = 1e-3;  // of the way: as for equilibria
  const double length = body_->unknowns().length();
  const Placement here = body_->placement();
  body_->move(Vector::Zero(body_->unknowns().size()), from.load_factor);
  const bool back =
      settle() && distance(from, body_->placement(), length) <= same * distance(from, here, length);
  body_->restore(here);
  return back;
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

void BreakingBody::add_work_of_walls(const Vector& work) {
  if (body_->terms().of<RestWalls>().moves())
    body_->terms().of<RestWalls>().add_work(work.tail(work.size() - 1));
}

Support& BreakingBody::free_grip_of(ParticleId first) {
  return *std::find_if(stage_->supports.begin(), stage_->supports.end(),
                       [&](const Support& s) { return is_free_grip(s) && s.particles.front() == first; });
}

std::optional<std::string> BreakingBody::hold_free_parts() {
  constexpr double nothing = 1e-9;  // of the loads that drive a part: rounding
  if (body_->turns_come_free()) begin_anew();
  const RigidMotions free =
      free_rigid_motions(model_, body_->state(), body_->unknowns(), body_->terms().holds(false));
  if (free.names.empty()) return std::nullopt;
  bool is_pressed = false;
  for (const double factor : {0.0, stage_->fracture.end}) {
    const Vector loads = body_->applied(factor), along = free.basis.transpose() * loads;
    const Vector not_pressing = free.basis.transpose() * body_->applied_loads_alone(factor);
    for (Eigen::Index k = 0; k < along.size(); ++k) {
      const auto drives = [&](double load) { return std::abs(load) > nothing * loads.norm(); };
      if (!drives(along[k])) continue;
      if (drives(not_pressing[k]) || !is_of_a_chip(*body_, free.basis, k)) return first_of(free.names);
      is_pressed = true;
    }
  }
  tell(*stage_, hooks_,
       fmt::format(
           "load factor {:.6g}: nothing holds a part any more, which is held where it is from now on{}: {}",
           load_factor(), is_pressed ? ", and bears what pressure drives it" : "", first_of(free.names)));
  for (const int unknown : holding_unknowns(free.basis)) {
    const auto [particle, dof] = body_->unknowns().place(unknown);
    HeldPart part{particle, static_cast<std::uint8_t>(dof), HeldPart::Why::came_off};
    part.grip = body_->unknowns().arm(particle) != nullptr;
    const HeldAxes* axes = body_->unknowns().axes(particle);
    if (!part.grip && axes != nullptr) part.axes = *axes;
    hold(part);
  }
  ++result_.fracture.released_parts;
  begin_anew();
  return std::nullopt;
}

}  // namespace vbond
