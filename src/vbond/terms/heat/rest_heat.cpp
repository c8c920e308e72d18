#include "vbond/terms/heat/detail/rest_heat.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond {

bool RestHeat::is_there() const {
  return !body_.stage().heating.empty();
}

void RestHeat::take_hold() {
  if (state_.temperature.empty()) state_.temperature.resize(body_.model().particles());
  temperature_before_ = state_.temperature;
  State change;  // temperatures and ends of bonds, for growth_of()
  change.temperature.resize(body_.model().particles());
  for (const Heating& h : body_.stage().heating)
    for (const ParticleId p : h.particles) change.temperature[p] += h.temperature;
  for (const WarmBond& w : state_.warm_bonds)
    growth_rate_.push_back(growth_of(change, state_.bonds[w.bond], w.expansion));
}

void RestHeat::follow() {
  state_.temperature = temperature_before_;
  const double since = body_.load_factor() - body_.held_at();
  for (const Heating& h : body_.stage().heating)
    for (const ParticleId p : h.particles) state_.temperature[p] += since * h.temperature;
  take_lengths(state_);
}

void RestHeat::add_load_rates(LoadSum& to) const {
  constexpr double interval = 1e-5;
  for (std::size_t k = 0; k < growth_rate_.size(); ++k) {
    const WarmBond& w = state_.warm_bonds[k];
    const Bond& b = state_.bonds[w.bond];
    if (b.broken || growth_rate_[k] == 0.0) continue;
    const double g = growth_of(state_, w), rate = growth_rate_[k] / (2.0 * interval);
    const auto loads_at = [&](double growth) {
      return b.law->loads(with_growth(state_, w, growth), bond_pose(b, state_),
                          history_of_bond(state_, w.bond));
    };
    const BondLoads<double> after = loads_at(g + interval), before = loads_at(g - interval);
    const Vec3d F = rate * (after.F - before.F);
    to.loads.F[b.i] += F, to.loads.F[b.j] -= F;
    to.loads.M[b.i] += rate * (after.M_ij - before.M_ij);
    to.loads.M[b.j] += rate * (after.M_ji - before.M_ji);
    if (!image_of_j(b).is_itself()) body_.add_image(image_of_j(b), F, to);
  }
}

double RestHeat::imposed_strain() const {
  double largest = 0.0;
  for (const double rate : growth_rate_) largest = larger(largest, std::abs(rate));
  return largest;
}

double RestHeat::power() const {
  double power = 0.0;
  for (std::size_t k = 0; k < growth_rate_.size(); ++k) {
    const WarmBond& w = state_.warm_bonds[k];
    const Bond& b = state_.bonds[w.bond];
    if (!b.broken)
      power += growth_rate_[k] * power_of_growth(b, w, bond_pose(b, state_), history_of_bond(state_, w.bond));
  }
  return power;
}

std::unique_ptr<RestTerm> HeatTerm::at_rest(const StaticBody& body, State& state) {
  return std::make_unique<RestHeat>(body, state);
}

}  // namespace vbond
