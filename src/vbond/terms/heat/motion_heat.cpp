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
  const double U_before = on_.host.potential_energy(), flowed_before = on_.host.flowed();
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
  const double flowed = on_.host.flowed() - flowed_before;
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
    if (growth != 0.0 && !s.bonds[w.bond].broken) growing_.push_back({k, growth, {}});
  }
  const auto grown = [&s](const WarmBond& w) { return with_growth(s, w, growth_of(s, w)); };
  for (Growing& grows : growing_)
    if (const WarmBond& w = s.warm_bonds[grows.warm_bond]; jumps(w.bond, grown(w))) grows.growth = 0.0;
  book();
  for (const Growing& grows : growing_) {
    const WarmBond& w = s.warm_bonds[grows.warm_bond];
    s.bonds[w.bond] = grown(w);
    on_.bonds.take_lengths(w.bond, s.bonds[w.bond]);
  }
  on_.host.lengths_have_changed();
}

/// Whether growing brings a bond so far beyond its limits that more flows than it stores. That flows at once,
/// and is booked as a jump: the mean of before and after the step would know of half.
bool MotionHeat::jumps(BondId k, const Bond& b) {
  const Bond& before = on_.state.bonds[k];
  if (!on_.bodies.order.has(b.i) || !b.law->has_rules || !b.law->remembers()) return false;
  const BondPose<double> pose = on_.bodies.bond_pose(b);
  const auto stored = [&](const Bond& as, const BondHistory& history) {
    const BondEnergy<double> U = as.law->energy(as, pose, history);
    return U.U_L + U.U_B + U.U_T;
  };
  const BondHistory found = on_.bonds.history(k), flown = b.law->advance(b, pose, {}, 0.0, found);
  const double flowed = flown[b.law->dissipated_at] - found[b.law->dissipated_at];
  if (!(flowed > stored(b, flown))) return false;
  on_.bonds.put_history(k, flown);
  on_.books.dissipated += flowed;
  on_.books.work_supports += stored(b, flown) - stored(before, found) + flowed;
  return true;
}

/// Half of the work of growing: once before the step, and once after it, then with what yields at once but
/// not with what has crept meanwhile. Bonds grow as the step begins: with what creeps in it, the force would
/// be the least of each step.
void MotionHeat::book() {
  for (Growing& grows : growing_) {
    const WarmBond& w = on_.state.warm_bonds[grows.warm_bond];
    const Bond& b = on_.state.bonds[w.bond];
    if (!on_.bodies.order.has(b.i) || grows.growth == 0.0) continue;
    const BondPose<double> pose = on_.bodies.bond_pose(b);
    BondHistory history = no_history;
    if (b.law->remembers()) {
      if (!grows.begun) grows.begun = on_.bonds.history(w.bond);
      history = creeps(b) ? b.law->advance(b, pose, {}, 0.0, *grows.begun) : on_.bonds.history(w.bond);
    }
    on_.books.work_supports += 0.5 * grows.growth * power_of_growth(b, w, pose, history);
  }
}

std::unique_ptr<MotionTerm> HeatTerm::in_motion(const BodyInMotion& on) {
  return std::make_unique<MotionHeat>(on);
}

}  // namespace vbond
