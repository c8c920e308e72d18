// What a simulation is asked for: its records, when it stops, energies, reactions.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/turn_bound.hpp"

namespace vbond {

void Simulation::keep_records() {
  EnergyBooks& books = state_.books;
  const double brought_in = books.at_start + books.work_loads + books.work_supports;
  books.largest = std::max(books.largest, brought_in);
  if (others_ != nullptr) brought_in_.push_back(brought_in);

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
    double kinetic = bodies_.kinetic_energy(team_).kinetic();
    sum_over_parts({&kinetic, 1});
    std::int64_t& quiet = state_.rest.quiet_steps;
    quiet = kinetic < stage_.stops.rest->kinetic_energy_below ? quiet + 1 : 0;
  }
}

double Simulation::peak_quantity() const {
  const PeakStop& stop = *stage_.stops.peak;
  double quantity = 0.0;
  switch (stop.quantity) {
    case PeakQuantity::compressive_force: {
      std::vector<BondId> here = peak_bonds_;
      std::erase_if(here, [this](BondId b) { return !bodies_.order.has(state_.bonds[b].i); });
      if (!here.empty()) quantity = -mean_axial_force(here);
      if (here.size() < peak_bonds_.size() || others_ != nullptr)
        quantity *= static_cast<double>(here.size()) / static_cast<double>(peak_bonds_.size());
      break;
    }
    case PeakQuantity::reaction: quantity = dot(reaction(stop.particles).force, stop.direction); break;
  }
  sum_over_parts({&quantity, 1});
  return quantity;
}

Vec3d Simulation::from_to(ParticleId i, ParticleId j) const {
  if (others_ == nullptr) return pose_of(j).r - pose_of(i).r;
  Vec3d way =
      (bodies_.order.has(j) ? pose_of(j).r : Vec3d{}) - (bodies_.order.has(i) ? pose_of(i).r : Vec3d{});
  others_->sum({&way.x, 3});
  return way;
}

StopReason Simulation::stop_reason() const {
  const Stops& stops = stage_.stops;
  const Clock& clock = state_.clock;
  if (stops.distance) {
    const double distance = norm(from_to(stops.distance->i, stops.distance->j));
    if (stops.distance->below ? distance <= stops.distance->value : distance >= stops.distance->value)
      return StopReason::distance;
  }
  if (stops.peak && state_.peak.blocks > 0 && state_.peak.peak > 0.0 && state_.peak.samples == 0 &&
      state_.peak.last < (1.0 - stops.peak->drop) * state_.peak.peak)
    return StopReason::peak;
  if (stops.breaks && state_.breaks >= stops.breaks->count) return StopReason::breaks;
  if (stops.rest && state_.rest.quiet_steps >= steps_in(stops.rest->during, clock.dt))
    return StopReason::rest;
  if (clock.stage_step >= last_stage_step_) return StopReason::duration;
  return StopReason::running;
}

std::optional<FastTurn> Simulation::fastest_turn() const {
  std::optional<FastTurn> fastest;
  double most2 = sq(longest_turn / stage_.dt);
  for (const ParticleId p : bodies_.order.row.ids()) {
    const std::size_t row = bodies_.order.row[p].value;
    const double rate2 = norm2(bodies_.motion[row].omega);
    if (!(rate2 > most2)) continue;
    const BondIndex::Range bonds = bond_index_.of(p);
    if (bonds.begin() == bonds.end() && !bodies_.tops.has(row)) continue;
    most2 = rate2;
    fastest = {p, stage_.dt * std::sqrt(rate2)};
  }
  return fastest;
}

const Survey& Simulation::survey() const {
  if (survey_) return *survey_;
  Survey survey;
  Energies& e = survey.energies = bonds_.survey(team_, bodies_.pose.data(), survey.deformed);
  const Energies kinetic = bodies_.kinetic_energy(team_);
  e.kinetic_translation = kinetic.kinetic_translation;
  e.kinetic_rotation = kinetic.kinetic_rotation;
  e.contact = contact_energy() + walls_.energy();
  return survey_.emplace(std::move(survey));
}

double Simulation::balance_error(const Energies& e) const {
  const EnergyBooks& b = state_.books;
  const double imbalance =
      e.total() + b.dissipated + b.released - b.work_loads - b.work_supports - b.at_start;
  return imbalance / std::max({b.largest, std::abs(b.at_start), e.kinetic(), std::abs(e.contact),
                               rounding_scale_, std::numeric_limits<double>::min()});
}

Reaction Simulation::reaction(const std::vector<ParticleId>& particles) const {
  Reaction total;
  for (const Hold& h : supports_.holds()) {
    if (!std::binary_search(particles.begin(), particles.end(), h.particle)) continue;
    const std::size_t row = bodies_.order.row[h.particle].value;
    const MotionRow& motion = bodies_.motion[row];
    const LoadRow& load = bodies_.load[row];
    add_held(h.held, Row{row}, stage_.b_translation * motion.v - load.F,
             stage_.b_rotation * motion.omega - load.M, total);
  }
  return total;
}

/// The part of a force and moment on a particle that its support exerts.
void Simulation::add_held(const HeldDofs& held, Row row, const Vec3d& F, const Vec3d& M,
                          Reaction& total) const {
  Vec3d held_F, held_M;
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    if (held[axis]) component(held_F, k) = component(F, k);
    if (held[axis + 3]) component(held_M, k) = component(M, k);
  }
  total.force += held_F;
  total.moment += held_M + cross(bodies_.pose[row.value].r, held_F);
}

std::vector<BondId> Simulation::bonds_inside(const std::vector<ParticleId>& particles) const {
  std::vector<BondId> inside;
  for (const ParticleId p : particles)
    for (const BondIndex::Entry& e : bond_index_.of(p))
      if (e.is_i && std::binary_search(particles.begin(), particles.end(), e.other)) inside.push_back(e.bond);
  return inside;
}

Losses Simulation::losses() const {
  if (bonds_.remembers()) bonds_.collect(state_.bond_history);
  return losses_of(state_);
}

double Simulation::mean_axial_force(const std::vector<BondId>& bonds) const {
  if (bonds_.remembers()) bonds_.collect(state_.bond_history);
  return vbond::mean_axial_force(state_, bonds,
                                 [this](ParticleId p) -> const PoseRow& { return pose_of(p); });
}

}  // namespace vbond
