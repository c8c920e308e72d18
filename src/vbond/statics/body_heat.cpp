// The part of a body at rest that temperatures change, in proportion to the load factor.
#include <algorithm>

#include "vbond/model/heat.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {

void StaticBody::begin_heating() {
  if (stage_.heating.empty()) return;
  if (state_.temperature.empty()) state_.temperature.resize(model_.particles());
  temperature_before_ = state_.temperature;
  State change;  // temperatures and ends of bonds, for growth_of()
  change.temperature.resize(model_.particles());
  for (const Heating& h : stage_.heating)
    for (const ParticleId p : h.particles) change.temperature[p] += h.temperature;
  for (const WarmBond& w : state_.warm_bonds)
    growth_rate_.push_back(growth_of(change, state_.bonds[w.bond], w.expansion));
}

/// Those of this load factor.
void StaticBody::take_temperatures() {
  if (temperature_before_.empty()) return;
  state_.temperature = temperature_before_;
  for (const Heating& h : stage_.heating)
    for (const ParticleId p : h.particles) state_.temperature[p] += (load_factor_ - held_at_) * h.temperature;
  take_lengths(state_);
}

/// What growth does to the loads, per load factor: differences over an interval in which loads are linear
/// but for the square of its length. What it does to the cell goes to the load direction at once.
void StaticBody::add_growth(Loads& loads) const {
  constexpr double interval = 1e-5;
  for (std::size_t k = 0; k < state_.warm_bonds.size(); ++k) {
    const WarmBond& w = state_.warm_bonds[k];
    const Bond& b = state_.bonds[w.bond];
    if (b.broken || growth_rate_[k] == 0.0) continue;
    const double g = growth_of(state_, w), rate = growth_rate_[k] / (2.0 * interval);
    const auto loads_at = [&](double growth) {
      return b.law->loads(with_growth(state_, w, growth), bond_pose(b, state_),
                          history_of_bond(state_, w.bond));
    };
    const BondLoads<double> after = loads_at(g + interval), before = loads_at(g - interval);
    loads.F[b.i] += rate * (after.F - before.F), loads.F[b.j] -= rate * (after.F - before.F);
    loads.M[b.i] += rate * (after.M_ij - before.M_ij);
    loads.M[b.j] += rate * (after.M_ji - before.M_ji);
    if (b.image_j.is_itself() || !has_free_cell()) continue;
    const Tensor of_cell = dyad(rate * (after.F - before.F), image_at_start(b.image_j));
    for (std::size_t c = 0; c < 6; ++c)
      if (const int row = unknowns_.of_cell(c); row != Unknowns::held)
        for (std::size_t a = 0; a < 3; ++a)
          stiffness_.load_direction[row] -=
              dot(of_cell.row[a], cell_row_[c].row[a]) / unknowns_.cell_length();
  }
}

double StaticBody::power_of_heating() const {
  double power = 0.0;
  for (std::size_t k = 0; k < growth_rate_.size(); ++k) {
    const WarmBond& w = state_.warm_bonds[k];
    const Bond& b = state_.bonds[w.bond];
    if (!b.broken)
      power += growth_rate_[k] * power_of_growth(b, w, bond_pose(b, state_), history_of_bond(state_, w.bond));
  }
  return power;
}

}  // namespace vbond
