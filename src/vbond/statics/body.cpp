#include "vbond/statics/detail/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "vbond/model/energies.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/statics/detail/in_lanes.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/terms/heat/detail/rest_heat.hpp"

namespace vbond {
namespace {

/// The mean distance of bonded particles; without bonds the mean radius; 1 if that is 0 as well.
double length_scale(const Model& model, const State& s) {
  double sum = 0.0, bonds = 0.0;
  for (const Bond& b : s.bonds)
    if (!b.broken) sum += norm(between(s, b)), bonds += 1.0;
  if (sum > 0.0) return sum / bonds;
  sum = std::accumulate(model.radius.begin(), model.radius.end(), 0.0);
  return sum > 0.0 ? sum / static_cast<double>(model.particles()) : 1.0;
}

/// What a bond's turning is measured by: the distance of the centres, or of the bonded points where the
/// centres lie closer together.
double span(const Bond& b, const State& s) {
  return std::max(norm(between(s, b)), norm(bonded_points(b, bond_pose(b, s))));
}

/// Components of the cell that give way to stresses. They count by a length of the cell such that the
/// tangent's entries are of the size that those of particles have, however large the cell: V C/length^2 of a
/// body with the modulus C beside C L.
Unknowns::Cell free_cell(const Model& model, const StaticStage& stage, double length) {
  Unknowns::Cell cell;
  if (!stage.cell.any_stress()) return cell;
  for (std::size_t k = 0; k < 6; ++k) cell.free[k] = stage.cell.component[k].by == CellComponent::By::stress;
  const auto& [a, b, c] = model.cell.edges;
  cell.length = std::sqrt(dot(a, cross(b, c)) / length);
  return cell;
}

}  // namespace

std::vector<Unknowns::Place> idle_turns(const Model& model, const StaticStage& stage, const State& state) {
  constexpr double rounding = 1e-12;  // of slanted axes
  PerParticle<std::array<char, 3>> turned(model.particles(), {false, false, false});
  constexpr std::array<char, 3> all{true, true, true};
  for (const Bond& b : state.bonds)
    if (!b.broken) turned[b.i] = turned[b.j] = all;
  for (const Support& s : stage.supports)
    if (is_free_grip(s))
      for (const ParticleId p : s.particles) turned[p] = all;
  PerParticle<char> driven(model.particles(), false);  // moments that follow turn along
  for (const Support& s : stage.supports)
    if (norm(s.angular_velocity) > 0.0)
      for (const ParticleId p : s.particles) driven[p] = true;
  struct Moments {
    Vec3d constant, growing;
    double largest = 0;
  };
  PerParticle<Moments> outside(model.particles());  // several may cancel
  for (const PointLoad& l : stage.loads)
    for (const ParticleId p : l.particles) {
      const Vec3d M = l.moment_on(model.mass[p]);
      if (l.follower && driven[p] && norm(M) > 0.0) turned[p] = all;
      (l.constant ? outside[p].constant : outside[p].growing) += l.follower ? rotate(state.q[p], M) : M;
      outside[p].largest = std::max(outside[p].largest, norm(M));
    }
  const ParticleAxes axes(stage.supports);
  for (const ParticleId p : turned.ids())
    for (std::size_t k = 0; k < 3; ++k)
      for (const Vec3d& M : {outside[p].constant, outside[p].growing})
        if (std::abs(dot(M, axis_of(axes.get(p), 3 + k))) > rounding * outside[p].largest)
          turned[p][k] = true;
  std::vector<Unknowns::Place> idle;
  for (const ParticleId p : turned.ids())
    for (std::size_t k = 0; k < 3; ++k)
      if (!turned[p][k]) idle.push_back({p, static_cast<int>(3 + k)});
  return idle;
}

double distance(const Placement& a, const Placement& b, double length) {
  double largest = 0.0;
  const bool cell_moved = a.cell != b.cell;
  for (std::size_t k = 0; cell_moved && k < 3; ++k)
    largest = larger(largest, length * norm(b.cell[k].along - a.cell[k].along) / norm(a.cell[k].along));
  const auto carried = [&](const Vec3d& r) {
    if (!cell_moved) return r;
    const Vec3d s = in_edges(a.cell, r - a.r.values().front());
    return b.r.values().front() + s.x * b.cell[0].along + s.y * b.cell[1].along + s.z * b.cell[2].along;
  };
  for (const ParticleId p : a.r.ids())
    for (const double moved :
         {norm(b.r[p] - carried(a.r[p])), length * norm(rotation_vector(b.q[p] * conjugate(a.q[p])))})
      largest = larger(largest, moved);
  return largest;
}

StaticBody::StaticBody(const Model& model, const StaticStage& stage, State state, double load_factor)
    : model_(model),
      stage_(stage),
      state_(std::move(state)),
      load_factor_(load_factor),
      held_at_(load_factor),
      holds_(holds_of(stage.supports)),
      unknowns_(model.particles(), stage.supports, length_scale(model, state_),
                free_cell(model, stage, length_scale(model, state_)), idle_turns(model, stage, state_)),
      terms_(*this, state_),
      bonded_(model.particles(), false),
      shares_(state_),
      held_rate_(model.particles()),
      stiffness_{Assembly(unknowns_), Assembly(unknowns_), {}, {}, 0.0, false} {
  begin_anew(state_, Anew::at_rest);
  for (CellEdge& e : state_.cell) e = {.along = e.along};
  for (PairMemory& m : state_.contact_history) m.history = {};  // nothing is rubbed at rest
  std::erase_if(state_.contact_history, [](const PairMemory& m) { return m.kept == 0.0; });
  take_hold();
  take_hold_of_cell();
  look_at_grips();
  set_held_rates();
  for (RestTerm* t : terms_.all()) t->take_hold();
  // positions are rounded to eps |r|, unit vectors to eps
  constexpr double eps = std::numeric_limits<double>::epsilon();
  for (const Bond& b : state_.bonds) {
    if (b.broken) continue;
    bonded_[b.i] = bonded_[b.j] = true;
    const double B = angular_scale(b), c_A = b.law->stiffness(b).c_A;
    rounding_of_force_ =
        std::max(rounding_of_force_, eps * (c_A * (norm(state_.r[b.i]) + b.a) + B / unknowns_.length()));
    rounding_of_potential_ += eps * B;
  }
  note_rounding_of_cell();
  const auto any = [this](auto is) {
    return std::any_of(state_.bonds.begin(), state_.bonds.end(),
                       [is](const Bond& b) { return !b.broken && is(b); });
  };
  if (any([](const Bond& b) { return b.law->remembers(); })) state_.bond_history.resize(state_.bonds.size());
  flows_ = any(yields_or_softens);
  if (flows_) accept();
}

void StaticBody::sum_with(std::shared_ptr<Crew> crew) {
  constexpr std::size_t worth_it = 1000;  // bonds: less is done while another thread wakes up
  if (state_.bonds.size() >= worth_it) shares_ = BondShares(state_, std::move(crew));
}

void StaticBody::accept() {
  energies_.reset();
  for (RestTerm* t : terms_.all()) t->accept();
  if (!flows()) return;
  of_tangent_ = {};
  if (stiffness_.current) of_tangent_ = at_accepted_ ? accepted_before_ : accepted_;
  accepted_before_ = accepted_.empty() ? state_.bond_history : accepted_;
  accepted_ = state_.bond_history;
  if (of_tangent_ == accepted_before_) of_tangent_ = {};
  accepted_at_ = placement();
  at_accepted_ = true;
}

void StaticBody::placed() {
  Pulse::place(load_factor_);
  ++placement_number_;
  loaded_.reset();
  energies_.reset();
  for (RestTerm* t : terms_.all()) t->follow();
  if (!grips_.empty()) look_at_grips(), set_held_rates();
  stiffness_.current = false;
  of_tangent_ = {};
  if (!flows()) return;
  at_accepted_ = state_.r == accepted_at_.r && state_.q == accepted_at_.q &&
                 state_.cell == accepted_at_.cell &&
                 (!terms_.of<RestHeat>().changes_bonds() || load_factor_ == accepted_at_.load_factor);
  flow();
}

/// What bonds remember here, after the way from the last accepted balance, taken as straight. It takes no
/// time, so that nothing creeps; bonds that creep do not soften, which alone asks for the rates.
void StaticBody::flow() {
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (b.broken || !b.law->remembers()) continue;
    const auto turned = [&](ParticleId p) {
      return rotation_vector(state_.q[p] * conjugate(accepted_at_.q[p]));
    };
    const Vec3d before = between(accepted_at_.r, accepted_at_.cell, b);
    const BondRates<double> way{between(state_, b) - before, turned(b.i), turned(b.j)};
    state_.bond_history[k] =
        at_accepted_ ? accepted_[k]
                     : b.law->advance(b, bond_pose(b, state_), way, creeps(b) ? 0.0 : 1.0, accepted_[k]);
  }
}

const BondHistory& StaticBody::history_before(BondId k) const {
  if (!flows()) return history_of_bond(state_, k);
  return at_accepted_ ? accepted_before_[k] : accepted_[k];
}

double StaticBody::dissipated() const {
  return state_.bond_history.empty() ? 0.0 : dissipated_by_flow(state_);
}

void StaticBody::restore(const Placement& p) {
  state_.r = p.r;
  state_.q = p.q;
  state_.cell = p.cell;
  load_factor_ = p.load_factor;
  placed();
}

Movement StaticBody::movement(ParticleId p, const Vector& x, double load_factor_change) const {
  Movement m = unknowns_.movement(p, x);
  m.shift += load_factor_change * held_rate_[p].shift;
  m.turn += load_factor_change * held_rate_[p].turn;
  return m;
}

void StaticBody::move(const Vector& x, double new_load_factor) {
  const double change = new_load_factor - load_factor_;
  for (const ParticleId p : state_.r.ids()) {
    const Movement m = movement(p, x, change);
    state_.r[p] += m.shift;
    state_.q[p] = normalised(rotation_of((1.0 / unknowns_.length()) * m.turn) * state_.q[p]);
  }
  if (moves_cell()) carry_cell(x, new_load_factor);
  load_factor_ = new_load_factor;
  carry();
  carry_free(x, change);
  placed();
}

void StaticBody::relieve() {
  relieve({});
  if (load_factor_ == 1.0) return;
  Relief relief{unbalanced() / (1.0 - load_factor_)};
  constexpr double rounding = 1e-9;  // of the largest force: ten times what a balance may leave
  for (int k = 0; k < unknowns_.size(); ++k)
    if (unknowns_.is_turn(k)) relief.turns |= std::abs(relief.forces[k]) > rounding * loads_at_hand().largest;
  relieve(std::move(relief));
}

double StaticBody::relief_here() const {
  if (!is_relieved()) return 0.0;
  return (1.0 - load_factor_) * max_norm(relief_.forces) / loads_at_hand().largest;
}

StaticBody::Relief StaticBody::relieve(Relief relief) {
  Relief before = std::exchange(relief_, std::move(relief));
  placed();
  return before;
}

const Energies& StaticBody::energies() const {
  if (energies_) return *energies_;
  Energies e;
  const auto add = [&e](double U_L, double U_B, double U_T) { e.U_L += U_L, e.U_B += U_B, e.U_T += U_T; };
  for_bonds_in_lanes(
      state_, state_.bonds.ids(), [](BondId) { return true; },
      [](const BondLaneLoops& loops, BondLanes& lanes) { loops.energy(lanes); },
      [&](BondId, const BondLanes& b, std::size_t lane) { add(b.U[0][lane], b.U[1][lane], b.U[2][lane]); },
      [&](BondId k) {
        const BondEnergy<double> U = bond_energy(state_, k);
        add(U.U_L, U.U_B, U.U_T);
      });
  e.contact = contact_energy(model_, state_, [this](const auto& visit) { for_touching(visit); });
  for (const RestTerm* t : terms_.all()) e.contact += t->energy();
  energies_ = e;
  return *energies_;
}

void StaticBody::break_bond(BondId k, BreakMode mode) {
  Bond& broken = state_.bonds[k];
  broken.mode = mode;
  ++breaks_;
  if (broken.law->crack != nullptr) return leave_faces(k);
  broken.broken = true;
  touching_.forget();
  bonded_[broken.i] = bonded_[broken.j] = false;
  for (const Bond& b : state_.bonds)
    if (!b.broken) bonded_[b.i] = bonded_[b.j] = true;
  placed();
}

bool StaticBody::turns_come_free() const {
  const auto is_unknown = [this](const Unknowns::Place& turn) {
    return unknowns_.of(turn.particle, turn.dof) != Unknowns::held;
  };
  const std::vector<Unknowns::Place> idle = idle_turns(model_, stage_, state_);
  return std::any_of(idle.begin(), idle.end(), is_unknown);
}

/// The bond cracks, and its faces rub from this balance on.
void StaticBody::leave_faces(BondId k) {
  const Bond& b = state_.bonds[k];
  const BondHistory cracked = b.law->crack(b, bond_pose(b, state_), state_.bond_history[k]);
  state_.bond_history[k] = cracked;
  if (!std::exchange(flows_, true)) lay_out();
  accepted_ = state_.bond_history;
  accept();
  placed();
}

double StaticBody::potential_change(const Placement& from, double energy_from) const {
  const Loads applied = applied_loads(load_factor_);
  double change = potential() - energy_from;
  for (const ParticleId p : state_.r.ids()) {
    const Vec3d turn = rotation_vector(state_.q[p] * conjugate(from.q[p]));
    change -= dot(applied.F[p], state_.r[p] - from.r[p]) + dot(applied.M[p], turn);
  }
  for (const RestTerm* t : terms_.all()) change -= t->work(from, placement(), load_factor_);
  if (has_free_cell()) change -= work_on_cell(from);
  return change - work_of_relief(from, placement(), load_factor_);
}

std::optional<std::string> StaticBody::fault_of_terms() const {
  for (const RestTerm* t : terms_.all())
    if (auto fault = t->fault()) return fault;
  return std::nullopt;
}

double StaticBody::largest_change_of_terms(const Vector& x, double load_factor_change) const {
  double largest = 0.0;
  for (const RestTerm* t : terms_.all()) largest = larger(largest, t->largest_change(x, load_factor_change));
  return largest;
}

double StaticBody::imposed_strain() const {
  double largest = 0.0;
  for (const RestTerm* t : terms_.all()) largest = larger(largest, t->imposed_strain());
  return largest;
}

double StaticBody::largest_bond_change(const Vector& x, double load_factor_change) const {
  PerParticle<Movement> moves(model_.particles());
  for (const ParticleId p : moves.ids()) moves[p] = movement(p, x, load_factor_change);
  double largest = 0.0;
  const Tensor cell = moves_cell() ? cell_change(x, load_factor_change) : Tensor{};
  for (const Vec3d& row : cell.row) largest = larger(largest, norm(row));
  for (const Bond& b : state_.bonds) {
    if (b.broken) continue;
    const Movement &of_i = moves[b.i], &of_j = moves[b.j];
    Vec3d apart = of_j.shift - of_i.shift;
    if (moves_cell() && !image_of_j(b).is_itself()) apart += times(cell, image_at_start(image_of_j(b)));
    const double turn = norm(of_j.turn - of_i.turn) / unknowns_.length();
    largest = larger(largest, turn);
    const double stretch = norm(apart), by_centres = norm(between(state_, b));
    // its span is no less than the distance of the centres: most need no more to be known
    if (stretch <= largest * by_centres) continue;
    largest = larger(largest, stretch / span(b, state_));
  }
  for (const ParticleId p : bonded_.ids()) {
    if (bonded_[p]) continue;
    const Movement& m = moves[p];
    largest = larger(larger(largest, norm(m.shift) / unknowns_.length()), norm(m.turn) / unknowns_.length());
  }
  return largest;
}

}  // namespace vbond
