// What a simulation is asked for: its records, when it stops, energies, reactions.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "vbond/dynamics/gather.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/model/turn_bound.hpp"

namespace vbond {
namespace {

/// A scale for the balance of a body that does no more than follow its cell: its energies beside the flow are
/// rounding of velocities along it.  [energy]
double rounding_along(const Tensor& flow, const CellShape& cell, double mass) {
  double speed2 = 0.0;
  for (const Vec3d& edge : cell.edges) speed2 += norm2(times(flow, edge));
  return 1e3 * std::numeric_limits<double>::epsilon() * mass * speed2;
}

/// Where there is any.
FastTurn farthest_of(const std::optional<FastTurn>& here, const Communicator& processes) {
  std::vector<FastTurn> all(here ? 1 : 0, here.value_or(FastTurn{}));
  all = processes.gather(all);
  return *std::min_element(all.begin(), all.end(), [](const FastTurn& a, const FastTurn& b) {
    return std::pair(-a.angle, a.p) < std::pair(-b.angle, b.p);
  });
}

}  // namespace

void Simulation::keep_records() {
  room_ -= last_way_;
  ++unmet_;
  EnergyBooks& books = booked_;
  const double brought_in = books.brought_in();  // below zero where supports hold back what sticks
  if (is_part_)
    brought_in_.push_back(brought_in);
  else
    books.largest = std::max(books.largest, std::abs(brought_in));
  if (flow() != nullptr)
    books.largest = std::max(books.largest, rounding_along(*flow(), model_.cell, mass_of_all_));

  if (stage_.stops.peak) {
    PeakRecord& peak = state_.peak;
    peak.sum += peak_quantity();
    if (++peak.samples == steps_in(stage_.stops.peak->average_over, stage_.dt)) {
      peak.last = peak.sum / static_cast<double>(peak.samples);
      if (peak.blocks == 0 || peak.last > peak.peak) {
        peak.peak = peak.last;
        peak.peak_time = state_.clock.time();
      }
      ++peak.blocks;
      peak.sum = 0.0;
      peak.samples = 0;
    }
  }
  if (stage_.stops.rest) {
    double kinetic = bodies_.kinetic_energy(team_, flow()).kinetic();
    exchange_.sum({&kinetic, 1});
    std::int64_t& quiet = state_.rest.quiet_steps;
    const bool more_to_come =
        std::any_of(stage_.inflows.begin(), stage_.inflows.end(), [this](const Inflow& inflow) {
          const Source& source = model_.sources[inflow.source];
          return is_waiting(state_, source.particle(source.bodies - 1, 0)) &&
                 next_visit(inflow, stage_.dt, state_.clock.stage_step) != no_visit;
        });
    quiet = !more_to_come && kinetic < stage_.stops.rest->kinetic_energy_below ? quiet + 1 : 0;
  }
}

double Simulation::peak_quantity() const {
  const PeakStop& stop = *stage_.stops.peak;
  double quantity = 0.0;
  switch (stop.quantity) {
    case PeakQuantity::compressive_force: return -mean_axial_force(peak_bonds_);
    case PeakQuantity::reaction: quantity = dot(reaction_here(stop.particles).force, stop.direction); break;
    case PeakQuantity::wall_force: return dot(walls()[stop.wall].force, stop.direction);  // of all parts
  }
  exchange_.sum({&quantity, 1});
  return quantity;
}

Vec3d Simulation::from_to(ParticleId i, ParticleId j) const {
  if (!is_part_) return bodies_.between(bodies_.order.row[i], bodies_.order.row[j]);
  std::array<double, 6> places{};  // of i and j, each known to the part that moves it
  for (const auto& [p, first] : {std::pair(i, 0), std::pair(j, 3)}) {
    if (!bodies_.order.has(p)) continue;
    const Vec3d& r = pose_of(p).r;
    std::copy_n(&r.x, 3, places.begin() + first);
  }
  exchange_.sum(places);
  return between(Vec3d{places[0], places[1], places[2]}, Vec3d{places[3], places[4], places[5]});
}

StopReason Simulation::stop_reason() const {
  const Stops& stops = stage_.stops;
  const Clock& clock = state_.clock;
  if (stops.distance) {
    const double distance = norm(from_to(stops.distance->i, stops.distance->j));
    if (stops.distance->below ? distance <= stops.distance->value : distance >= stops.distance->value)
      return StopReason::distance;
  }
  if (stops.peak && state_.peak.blocks > 0 && state_.peak.peak > stops.peak->above &&
      state_.peak.samples == 0 && state_.peak.last < (1.0 - stops.peak->drop) * state_.peak.peak)
    return StopReason::peak;
  if (stops.breaks && state_.breaks >= stops.breaks->count) return StopReason::breaks;
  if (stops.rest && state_.rest.quiet_steps >= steps_in(stops.rest->during, clock.dt))
    return StopReason::rest;
  if (clock.stage_step >= last_stage_step_) return StopReason::duration;
  return StopReason::running;
}

const Survey& Simulation::survey() const {
  if (survey_) return *survey_;
  Survey survey = survey_here();
  survey.fast_turn = fast_turn_here();
  Energies& e = survey.energies;
  std::array<double, 8> sums{e.kinetic_translation,
                             e.kinetic_rotation,
                             e.U_L,
                             e.U_B,
                             e.U_T,
                             e.contact,
                             survey.deformed.empty() ? 0.0 : 1.0,
                             survey.fast_turn ? 1.0 : 0.0};
  exchange_.sum(sums);
  e = {sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]};
  survey.any_deformed = sums[6] > 0.0;
  if (sums[7] > 0.0) survey.fast_turn = farthest_of(survey.fast_turn, exchange_);
  return survey_.emplace(std::move(survey));
}

std::optional<FastTurn> Simulation::fast_turn_here() const {
  std::optional<FastTurn> fastest;
  double most2 = sq(longest_turn / stage_.dt);
  const auto turns_fast = [most2](const MotionRow& m) { return norm2(m.omega) > most2; };
  const auto first = bodies_.motion.begin();
  if (std::none_of(first, first + static_cast<std::ptrdiff_t>(bodies_.order.own), turns_fast)) return {};
  const auto look = [&](ParticleId p, bool of_a_group) {
    const std::size_t row = bodies_.order.row[p].value;
    const double rate2 = norm2(bodies_.motion[row].omega);
    if (!(rate2 > most2) || !bodies_.order.has(p)) return;
    const BondIndex::Range bonds = bond_index_.of(p);
    if (!of_a_group && bonds.begin() == bonds.end() && !bodies_.tops.has(row)) return;
    most2 = rate2;
    fastest = {p, stage_.dt * std::sqrt(rate2)};
  };
  for (const ParticleId p : bodies_.order.row.ids()) look(p, false);
  for (const Support& s : stage_.supports)
    if (turns_freely(s))
      for (const ParticleId p : s.particles) look(p, true);
  return fastest;
}

/// Of what is worked out here.
Survey Simulation::survey_here() const {
  Survey survey;
  Energies& e = survey.energies = bonds_.survey(all_known(), bodies_.pose.data(), survey.deformed);
  const Energies kinetic = bodies_.kinetic_energy(team_, flow());
  e.kinetic_translation = kinetic.kinetic_translation;
  e.kinetic_rotation = kinetic.kinetic_rotation;
  e.contact = contact_energy() + terms_.energy();
  return survey;
}

double Simulation::balance_error() const {
  const Energies& e = energies();
  const EnergyBooks& b = books();
  const double imbalance = e.total() + b.dissipated + b.released + b.removed - b.work_loads -
                           b.work_supports - b.inserted - b.at_start;
  return imbalance / std::max({b.largest, std::abs(b.at_start), e.kinetic(), std::abs(e.contact),
                               rounding_scale_, std::numeric_limits<double>::min()});
}

const State& Simulation::state() const {
  return collected();
}

/// All of it. Of a part that has own bonds alone a copy, until the body moves on.
State& Simulation::collected() const {
  show_own();
  if (std::exchange(shown_, Shown::all) != Shown::all) {
    show_loads();
    if (part_bonds_.own_alone) {
      complete_model();
      whole_.emplace(with_all_bonds(state_, part_bonds_, shared_, exchange_));
      gather_owned(*whole_, own_particles(), {}, false, exchange_);
    } else if (is_part_) {
      gather_owned(state_, own_particles(), own_bonds(), true, exchange_);
    }
  }
  books();
  if (!whole_) return state_;
  whole_->clock = state_.clock;
  whole_->books = state_.books;
  whole_->grips = state_.grips;
  whole_->sources = state_.sources;
  return *whole_;
}

/// What this process knows of particles, bonds and pairs, but for loads.
void Simulation::show_own() const {
  if (shown_ != Shown::nothing) return;
  shown_ = Shown::own;
  books_ahead_ = true;  // those of grips are overwritten
  bodies_.write(state_);
  if (!state_.spin.empty()) state_.spin.hold(state_.q.held());
  if (bonds_.remembers()) bonds_.collect(state_.bond_history);
  state_.contact_history = contacts_.collect();
  state_.fibre_history = capsules_.collect();
  terms_.write(state_);
  supports_.grips().write(state_);
}

/// Those on its own particles, where they do not follow from what the state has.
void Simulation::show_loads() const {
  const bool loads_follow = bonds_.all_elastic() && !contacts_.are_touches() && !capsules_.any() &&
                            !terms_.any_touching() && !damping_.is_local();
  state_.loads = loads_follow ? Loads{} : loads();
  state_.damping = bodies_.damping.empty() ? Loads{} : bodies_.collect(bodies_.damping);
  state_.local_damping = bodies_.local_damping.empty() ? Loads{} : bodies_.collect(bodies_.local_damping);
  for (Loads* l : {&state_.loads, &state_.damping, &state_.local_damping})  // of whoever is absent, too
    if (!l->F.empty()) l->F.hold(state_.q.held()), l->M.hold(state_.q.held());
}

/// Of parts the sum of what each has booked.
const EnergyBooks& Simulation::books() const {
  if (!std::exchange(books_ahead_, false)) return state_.books;
  if (is_part_) {
    fold_brought_in();
    supports_.grips().write(state_);
  }
  state_.books = booked_;
  if (is_part_) sum_values(state_, exchange_);
  return state_.books;
}

Reaction Simulation::summed_over_parts(Reaction r) const {
  std::array<double, 6> sums{r.force.x, r.force.y, r.force.z, r.moment.x, r.moment.y, r.moment.z};
  exchange_.sum(sums);
  return {{sums[0], sums[1], sums[2]}, {sums[3], sums[4], sums[5]}};
}

Reaction Simulation::reaction(const std::vector<ParticleId>& particles, LastBreaks breaks) const {
  Reaction here = reaction_here(particles);
  if (breaks == LastBreaks::counted) add_taken(particles, here);
  return summed_over_parts(here);
}

/// What is exerted on those that are moved here.
Reaction Simulation::reaction_here(const std::vector<ParticleId>& particles) const {
  Reaction total;
  const std::vector<char> whole = whole_free_grips(particles);
  for (const Hold& h : supports_.holds()) {
    if (!std::binary_search(particles.begin(), particles.end(), h.particle)) continue;
    const std::size_t row = bodies_.order.row[h.particle].value;
    const MotionRow& motion = bodies_.motion[row];
    const LoadRow& load = bodies_.load[row];
    add_held(h, whole[h.support] != 0, Row{row}, stage_.b_translation * motion.v - load.F,
             stage_.b_rotation * motion.omega - load.M, total);
  }
  return total;
}

/// Loads of the bonds that broke in the last step, as their supports bore them.
void Simulation::add_taken(const std::vector<ParticleId>& particles, Reaction& to) const {
  const std::vector<char> grips = whole_free_grips(particles);
  for (const Hold& h : supports_.holds()) {
    if (!std::binary_search(particles.begin(), particles.end(), h.particle)) continue;
    const Row row = bodies_.order.row[h.particle];
    const bool whole = grips[h.support] != 0;
    for (const TakenLoads& t : taken_) {
      if (t.i == h.particle) add_held(h, whole, row, -t.loads.F, -t.loads.M_ij, to);
      if (t.j == h.particle) add_held(h, whole, row, t.loads.F, -t.loads.M_ji, to);
    }
    auto s = std::lower_bound(taken_shares_.begin(), taken_shares_.end(), row.value,
                              [](const Capsules::Share& x, std::size_t first) { return x.row < first; });
    for (; s != taken_shares_.end() && s->row == row.value; ++s) add_held(h, whole, row, -s->F, -s->M, to);
  }
}

/// Of each support: whether it is a grip that is free in part and has all its particles among these.
std::vector<char> Simulation::whole_free_grips(const std::vector<ParticleId>& particles) const {
  std::vector<char> whole;
  for (const Support& s : stage_.supports)
    whole.push_back(is_free_grip(s) && std::includes(particles.begin(), particles.end(), s.particles.begin(),
                                                     s.particles.end()));
  return whole;
}

/// The part of a force and moment on a particle that its support exerts: of a grip that is free in part all
/// of it, less what moves the grip along what is free, if that is `whole`.
void Simulation::add_held(const Hold& hold, bool whole, Row row, const Vec3d& F, const Vec3d& M,
                          Reaction& total) const {
  const Support& support = stage_.supports[hold.support];
  Vec3d held_F, held_M;
  if (is_free_grip(support)) {
    held_F = F, held_M = M;
  } else {
    for (std::size_t dof = 0; dof < 6; ++dof)
      if (hold.held[dof]) {
        const Vec3d& axis = axis_of(hold.axes.get(), dof);
        (dof < 3 ? held_F : held_M) += dot(dof < 3 ? F : M, axis) * axis;
      }
  }
  Vec3d moment = held_M + cross(bodies_.pose[row.value].r, held_F);
  if (whole) supports_.grips().leave_held(support, state_.clock.stage_step, held_F, moment);
  total.force += held_F;
  total.moment += moment;
}

double Simulation::mean_axial_force(const std::vector<BondId>& own) const {
  if (bonds_.remembers()) bonds_.collect(state_.bond_history);
  return vbond::mean_axial_force(own, exchange_, [this](BondId k) {
    const Bond& b = state_.bonds[k];
    return axial_force(b, history_of_bond(state_, k), bodies_.between(b),
                       bodies_.orientation(bodies_.order.row_i(b)),
                       bodies_.orientation(bodies_.order.row_j(b)));
  });
}

std::vector<GripView> Simulation::grips() const {
  std::vector<GripView> views = supports_.grips().views(state_.clock.stage_step);
  for (GripView& v : views) {
    const Reaction whole = summed_over_parts({v.force, v.moment});
    v.force = whole.force, v.moment = whole.moment;
    if (v.work) exchange_.sum({&*v.work, 1});
  }
  return views;
}

}  // namespace vbond
