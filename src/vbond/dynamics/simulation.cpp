#include "vbond/dynamics/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/dynamics/energy.hpp"
#include "vbond/dynamics/integrate.hpp"
#include "vbond/dynamics/supports.hpp"

namespace vbond {
namespace {

/// Throws for the first particle whose load is NaN or infinite.
void check_finite(const Loads& loads, const State& state) {
  double poison = 0.0;  // 0 * x is 0 for every finite x and NaN for any other
  for (const ParticleId p : loads.F.ids()) {
    const Vec3d sum = loads.F[p] + loads.M[p];
    poison += 0.0 * (sum.x + sum.y + sum.z);
  }
  if (poison == 0.0) return;
  for (const ParticleId p : loads.F.ids())
    if (!is_finite(loads.F[p] + loads.M[p]))
      throw Diverged(state.clock.step, state.clock.time(), "particle " + std::to_string(p.value),
                     "its force or moment is not a finite number",
                     "reduce time.step (or time.fraction); look at the last frame for bonds that closed up");
}

/// Energies of bonds near rest are differences of terms of the size of B2, B3 and B4, known to some 1e-16 of
/// them: an energy a thousand roundings large is the least that an error can sensibly be compared with.
double scale_of_rounding(const PerBond<Bond>& bonds) {
  double sum = 0.0;
  for (const Bond& b : bonds) sum += std::abs(b.B2) + std::abs(b.B3) + std::abs(b.B4);
  return 1e3 * std::numeric_limits<double>::epsilon() * sum;
}

}  // namespace

Simulation::Simulation(const Model& model, Stage stage, State state, int threads)
    : model_(model),
      stage_(std::move(stage)),
      state_(std::move(state)),
      threads_(threads),
      bond_index_(model.particles(), state_.bonds),
      contacts_(model, bond_index_),
      bonding_(model, stage_, bond_index_),
      damping_(model, stage_) {
  bond_loads_.prepare(state_.bonds);
  rounding_scale_ = scale_of_rounding(state_.bonds);
  state_.clock.dt = stage_.dt;
  if (state_.clock.stage_step == 0)
    begin_stage();
  else
    evaluate_loads();
}

void Simulation::begin_stage() {
  state_.peak = {};
  state_.rest = {};
  evaluate_loads();
  if (state_.clock.stage == 0 && state_.clock.step == 0) state_.books = {.at_start = energies().total()};
  hold_velocities(model_, stage_, 0.0, state_);
  survey_.reset();
}

void Simulation::step() {
  const double dt = stage_.dt, t = state_.clock.stage_time();
  make_bonds();                                                           // between particles that came close
  apply_strain();                                                         // r jumps, if it is due
  apply_damping();                                                        // v, omega over dt / 2
  kick(model_, loads_, dt / 2, threads_, state_);                         // v, omega : t -> t + dt/2
  hold_velocities_after_kick(model_, stage_, loads_, t, dt / 2, state_);  // held d.o.f. take their velocity
  drift(dt, threads_, state_);                                            // r, q     : t -> t + dt
  book_applied_work(model_, stage_, t, dt, threads_, state_);
  ++state_.clock.step;
  ++state_.clock.stage_step;                       // time is counted, not summed
  evaluate_loads();                                // F, M     : at t + dt
  kick(model_, loads_, dt / 2, threads_, state_);  // v, omega : t + dt/2 -> t + dt
  hold_velocities_after_kick(model_, stage_, loads_, t + dt / 2, dt / 2, state_);
  apply_damping();
  survey_.reset();
  keep_records();
  if (--steps_to_look_ == 0) notify_observers();
}

StopReason Simulation::run(const std::function<bool()>& interrupted) {
  if (state_.clock.stage_step == 0) notify_observers();
  StopReason why = stop_reason();
  while (why == StopReason::running) {  // asked after a step: a stage is never interrupted before its first
    step();
    why = stop_reason();
    if (why == StopReason::running && interrupted && interrupted()) why = StopReason::interrupted;
  }
  for (const auto& o : observers_) o->finish(*this, why);
  return why;
}

void Simulation::notify_observers() {
  steps_to_look_ = std::numeric_limits<std::int64_t>::max();
  for (const auto& o : observers_) {
    o->observe(*this);
    steps_to_look_ = std::min(steps_to_look_, o->steps_to_next_look(state_.clock));
  }
}

void Simulation::make_bonds() {
  if (!bonding_.make_bonds(state_)) return;
  bond_index_ = BondIndex(model_.particles(), state_.bonds);
  bond_loads_.prepare(state_.bonds);
  rounding_scale_ = scale_of_rounding(state_.bonds);
  contacts_.bonds_changed();
  evaluate_loads();
}

void Simulation::evaluate_loads() {
  survey_.reset();
  contacts_.refresh(state_);
  loads_.F.assign(model_.particles(), Vec3d{});
  loads_.M.assign(model_.particles(), Vec3d{});
  bond_loads_.add(state_, bond_index_, threads_, loads_);
  contacts_.add_loads(state_, threads_, loads_);
  add_applied_loads(model_, stage_, state_.clock.stage_time(), loads_);
  check_finite(loads_, state_);
}

void Simulation::apply_damping() {
  damping_.apply_half_step(model_, threads_, state_);
  hold_velocities(model_, stage_, state_.clock.stage_time(), state_);
}

void Simulation::apply_strain() {
  if (!stage_.strain) return;
  const StrainProgram& strain = *stage_.strain;
  if (state_.clock.stage_step % steps_in(strain.every, stage_.dt) != 0) return;

  const double U_before = energies().potential();
  Loads applied{PerParticle<Vec3d>(model_.particles()), PerParticle<Vec3d>(model_.particles())};
  add_applied_loads(model_, stage_, state_.clock.stage_time(), applied);
  double work_applied = 0.0;
  for (const ParticleId p : strain.particles) {
    const Vec3d dr = strain.increment * dot(strain.direction, state_.r[p] - strain.centre) * strain.direction;
    state_.r[p] += dr;
    work_applied += dot(applied.F[p], dr);
  }
  evaluate_loads();
  state_.books.work_loads += work_applied;
  state_.books.work_supports += energies().potential() - U_before - work_applied;
}

void Simulation::keep_records() {
  EnergyBooks& books = state_.books;
  books.largest = std::max(books.largest, books.at_start + books.work_loads + books.work_supports);

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
    const double kinetic = kinetic_energies(model_, state_, threads_).kinetic();
    std::int64_t& quiet = state_.rest.quiet_steps;
    quiet = kinetic < stage_.stops.rest->kinetic_energy_below ? quiet + 1 : 0;
  }
}

double Simulation::peak_quantity() const {
  const PeakStop& stop = *stage_.stops.peak;
  switch (stop.quantity) {
    case PeakQuantity::compressive_force: return -mean_axial_force(stop.particles);
    case PeakQuantity::reaction: return dot(reaction(stop.particles).force, stop.direction);
  }
  return 0.0;
}

StopReason Simulation::stop_reason() const {
  const Stops& stops = stage_.stops;
  const Clock& clock = state_.clock;
  if (stops.distance) {
    const double distance = norm(state_.r[stops.distance->j] - state_.r[stops.distance->i]);
    if (stops.distance->below ? distance <= stops.distance->value : distance >= stops.distance->value)
      return StopReason::distance;
  }
  if (stops.peak && state_.peak.blocks > 0 && state_.peak.peak > 0.0 && state_.peak.samples == 0 &&
      state_.peak.last < (1.0 - stops.peak->drop) * state_.peak.peak)
    return StopReason::peak;
  if (stops.rest && state_.rest.quiet_steps >= steps_in(stops.rest->during, clock.dt))
    return StopReason::rest;
  if (std::isfinite(stops.duration) && clock.stage_step >= steps_in(stops.duration, clock.dt))
    return StopReason::duration;
  return StopReason::running;
}

const Survey& Simulation::survey() const {
  if (survey_) return *survey_;
  survey_.emplace();
  Energies& e = survey_->energies = bond_energies(state_);
  const Energies kinetic = kinetic_energies(model_, state_, threads_);
  e.kinetic_translation = kinetic.kinetic_translation;
  e.kinetic_rotation = kinetic.kinetic_rotation;
  e.contact = contacts_.energy(state_);
  for (const BondId b : state_.bonds.ids()) survey_->deformed.push_back(b);
  return *survey_;
}

double Simulation::balance_error(const Energies& e) const {
  const EnergyBooks& b = state_.books;
  const double imbalance = e.total() + b.dissipated - b.work_loads - b.work_supports - b.at_start;
  return imbalance / std::max({b.largest, b.at_start, rounding_scale_, std::numeric_limits<double>::min()});
}

Reaction Simulation::reaction(const std::vector<ParticleId>& particles) const {
  Reaction total;
  for (const Support& s : stage_.supports)
    for (const ParticleId p : s.particles) {
      if (!std::binary_search(particles.begin(), particles.end(), p)) continue;
      const Vec3d F = stage_.b_translation * state_.v[p] - loads_.F[p];
      const Vec3d M = stage_.b_rotation * state_.omega[p] - loads_.M[p];
      Vec3d held_F, held_M;
      for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        if (s.held[axis]) component(held_F, k) = component(F, k);
        if (s.held[axis + 3]) component(held_M, k) = component(M, k);
      }
      total.force += held_F;
      total.moment += held_M + cross(state_.r[p], held_F);
    }
  return total;
}

double Simulation::mean_axial_force(const std::vector<ParticleId>& particles) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const ParticleId p : particles)
    for (const BondIndex::Entry& e : bond_index_.of(p))
      if (e.is_i && std::binary_search(particles.begin(), particles.end(), e.other)) {
        sum += axial_force(state_.bonds[e.bond], state_);
        ++count;
      }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace vbond
