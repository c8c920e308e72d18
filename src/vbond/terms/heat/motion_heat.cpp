#include "vbond/terms/heat/motion_heat.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "vbond/model/bond_sums.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond {

/// Whether any has changed.
bool MotionHeat::set_temperatures(double time) {
  PerParticle<double>& temperature = on_.state.temperature;
  bool changed = false;
  for (const Heating& h : on_.stage.heating) {
    const double now = h.temperature * h.factor(time);
    if (temperature.empty()) temperature.resize(on_.model.particles());
    for (const ParticleId p : h.particles) changed |= std::exchange(temperature[p], now) != now;
  }
  return changed;
}

void MotionHeat::begin_stage() {
  known_ = true;
  jump_to(0.0);
}

void MotionHeat::jump_to(double time) {
  if (!set_temperatures(time)) return;
  State& s = on_.state;
  const double U_before = on_.host.potential_energy(), flowed_before = dissipated_by_flow(s);
  take_lengths(s);
  for (const WarmBond& w : s.warm_bonds) {
    const Bond& b = s.bonds[w.bond];
    on_.bonds.take_lengths(w.bond, b);
    if (b.broken || !b.law->has_rules || s.bond_history.empty()) continue;
    BondHistory& history = s.bond_history[w.bond];
    history = b.law->advance(b, bond_pose(b, s), {}, 0.0, history);
  }
  if (on_.bonds.remembers()) on_.host.arrange_bonds();
  on_.host.evaluate_loads();
  // all parts know what all bonds have lost; the energies are those of this one
  const double flowed = on_.exchange.leads() ? dissipated_by_flow(s) - flowed_before : 0.0;
  on_.books.dissipated += flowed;
  on_.books.work_supports += on_.host.potential_energy() - U_before + flowed;
}

void MotionHeat::begin_step() {
  growing_.clear();
  State& s = on_.state;
  const double dt = on_.stage.dt;
  const std::int64_t step = s.clock.stage_step;
  const double now = static_cast<double>(step) * dt, then = static_cast<double>(step + 1) * dt;
  const std::vector<Heating>& heating = on_.stage.heating;
  if (!std::exchange(known_, true)) jump_to(now);  // a run that goes on may have been given others
  if (std::all_of(heating.begin(), heating.end(),
                  [&](const Heating& h) { return h.factor(then) == h.factor(now); }))
    return;
  std::vector<double> before;
  for (const WarmBond& w : s.warm_bonds) before.push_back(growth_of(s, w));
  set_temperatures(then);
  for (std::size_t k = 0; k < before.size(); ++k) {
    const WarmBond& w = s.warm_bonds[k];
    const double growth = growth_of(s, w) - before[k];
    if (growth != 0.0 && !s.bonds[w.bond].broken) growing_.push_back({k, growth});
  }
  book();
  for (const Growing& grows : growing_) {
    const WarmBond& w = s.warm_bonds[grows.warm_bond];
    Bond& b = s.bonds[w.bond];
    b = with_growth(s, w, growth_of(s, w));
    on_.bonds.take_lengths(w.bond, b);
  }
  on_.host.lengths_have_changed();
}

/// Half of the work of growing: once before the step, and once after it.
void MotionHeat::book() {
  for (const Growing& grows : growing_) {
    const WarmBond& w = on_.state.warm_bonds[grows.warm_bond];
    const Bond& b = on_.state.bonds[w.bond];
    if (!on_.bodies.order.has(b.i)) continue;
    const BondHistory history = b.law->remembers() ? on_.bonds.history(w.bond) : no_history;
    on_.books.work_supports += 0.5 * grows.growth * power_of_growth(b, w, on_.bodies.bond_pose(b), history);
  }
}

std::unique_ptr<MotionTerm> HeatTerm::in_motion(const BodyInMotion& on) {
  return std::make_unique<MotionHeat>(on);
}

}  // namespace vbond
