// What changes the body between steps: imposed strain and temperatures.
#include <algorithm>
#include <limits>
#include <utility>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/heat.hpp"

namespace vbond {

/// What changes the body between steps.
void Simulation::change_body() {
  last_way_ = 0.0;
  taken_.clear();
  taken_shares_.clear();
  make_bonds();                         // between particles that came close
  if (!stage_.heating.empty()) heat();  // bonds get their lengths at the end of the step
  apply_strain();                       // r jumps, if it is due
}

void Simulation::apply_strain() {
  if (!stage_.strain) return;
  const StrainProgram& strain = *stage_.strain;
  if (state_.clock.stage_step % steps_in(strain.every, stage_.dt) != 0) return;

  const double U_before = survey_here().energies.potential();
  team_.for_blocks([&](const Block& b) { clear_loads(b); });
  applied_.set_times(state_.clock.stage_step, stage_.dt);
  team_.for_blocks([&](const Block& b) { applied_.add(b, Instant::start); });
  double work_applied = 0.0;
  for (const ParticleId p : strain.particles) {
    if (!bodies_.order.has(p)) continue;
    const std::size_t row = bodies_.order.row[p].value;
    Vec3d& r = bodies_.pose[row].r;
    const Vec3d dr = strain.increment * dot(strain.direction, r - strain.centre) * strain.direction;
    r += dr;
    work_applied += dot(bodies_.load[row].F, dr);
  }
  bodies_ahead_ = true;
  last_way_ = std::numeric_limits<double>::infinity();
  evaluate_loads();
  booked_.work_loads += work_applied;
  booked_.work_supports += survey_here().energies.potential() - U_before - work_applied;
}

// ---- temperatures --------------------------------------------------------------------------------------
// Bonds that expand get other lengths at the start of a step, so that its loads belong to the temperatures at
// its end. What this does to the energy of the bonds is work of imposed strain: dU/dg times the change of the
// growth g, the mean of before and after the step.

/// Whether any has changed.
bool Simulation::set_temperatures(double time) {
  bool changed = false;
  for (const Heating& h : stage_.heating) {
    const double now = h.temperature * h.factor(time);
    if (state_.temperature.empty()) state_.temperature.resize(model_.particles());
    for (const ParticleId p : h.particles) changed |= std::exchange(state_.temperature[p], now) != now;
  }
  return changed;
}

/// The temperatures with which the stage begins: the energy changes while nothing moves, and bonds flow that
/// this brings beyond their limits.
void Simulation::heat_at_start() {
  if (!set_temperatures(0.0)) return;
  const double U_before = survey_here().energies.potential(), flowed_before = dissipated_by_flow(state_);
  take_lengths(state_);
  for (const WarmBond& w : state_.warm_bonds) {
    const Bond& b = state_.bonds[w.bond];
    bonds_.take_lengths(w.bond, b);
    if (b.broken || !b.law->has_rules || state_.bond_history.empty()) continue;
    BondHistory& history = state_.bond_history[w.bond];
    history = b.law->advance(b, bond_pose(b, state_), {}, 0.0, history);
  }
  if (bonds_.remembers()) arrange_bonds();
  evaluate_loads();
  const double flowed = dissipated_by_flow(state_) - flowed_before;
  booked_.dissipated += flowed;
  booked_.work_supports += survey_here().energies.potential() - U_before + flowed;
}

void Simulation::heat() {
  growing_.clear();
  const double now = static_cast<double>(state_.clock.stage_step) * stage_.dt;
  const double then = static_cast<double>(state_.clock.stage_step + 1) * stage_.dt;
  if (std::all_of(stage_.heating.begin(), stage_.heating.end(),
                  [&](const Heating& h) { return h.factor(then) == h.factor(now); }))
    return;
  std::vector<double> before;
  for (const WarmBond& w : state_.warm_bonds) before.push_back(growth_of(state_, w));
  set_temperatures(then);
  for (std::size_t k = 0; k < before.size(); ++k) {
    const WarmBond& w = state_.warm_bonds[k];
    const double growth = growth_of(state_, w) - before[k];
    if (growth != 0.0 && !state_.bonds[w.bond].broken) growing_.push_back({k, growth});
  }
  book_heat();
  for (const Growing& grows : growing_) {
    const WarmBond& w = state_.warm_bonds[grows.warm_bond];
    Bond& b = state_.bonds[w.bond];
    b = with_growth(state_, w, growth_of(state_, w));
    bonds_.take_lengths(w.bond, b);
  }
  survey_.reset();
}

/// Half of the work of growing: once before the step, and once after it.
void Simulation::book_heat() {
  for (const Growing& grows : growing_) {
    const WarmBond& w = state_.warm_bonds[grows.warm_bond];
    const Bond& b = state_.bonds[w.bond];
    if (!bodies_.order.has(b.i)) continue;
    const BondHistory history = b.law->remembers() ? bonds_.history(w.bond) : no_history;
    booked_.work_supports += 0.5 * grows.growth * power_of_growth(b, w, bodies_.bond_pose(b), history);
  }
}

}  // namespace vbond
