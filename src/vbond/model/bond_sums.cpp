#include "vbond/model/bond_sums.hpp"

#include <algorithm>

#include "vbond/physics/with_flow.hpp"

namespace vbond {

std::vector<BondId> bonds_inside(const BodyPart& body, const IdList<ParticleId>& particles) {
  const auto inside = [&particles](ParticleId p) {
    return std::binary_search(particles.begin(), particles.end(), p);
  };
  std::vector<BondId> own;
  for (const BondId k : body.state.bonds.ids()) {
    const Bond& b = body.state.bonds[k];
    if (!b.broken && body.has(b) && inside(b.i) && inside(b.j)) own.push_back(k);
  }
  return own;
}

double mean_axial_force(const BodyPart& body, const IdList<ParticleId>& particles) {
  const std::vector<BondId> own = bonds_inside(body, particles);
  return mean_axial_force(own, body.all, [&body](BondId k) { return axial_force(body.state, k); });
}

void add_bond_loads(const State& state, Loads& loads) {
  for (const BondId k : state.bonds.ids()) {
    const Bond& b = state.bonds[k];
    const BondLoads<double> l = bond_loads(state, k);
    loads.F[b.i] += l.F;
    loads.F[b.j] -= l.F;
    loads.M[b.i] += l.M_ij;
    loads.M[b.j] += l.M_ji;
  }
}

Energies bond_energies(const State& state) {
  Energies e;
  for (const BondId k : state.bonds.ids()) {
    const BondEnergy<double> u = bond_energy(state, k);
    e.U_L += u.U_L;
    e.U_B += u.U_B;
    e.U_T += u.U_T;
  }
  return e;
}

double dissipated_by_flow(const BodyPart& body) {
  const State& state = body.state;
  double sum = 0.0;
  for (const BondId k : state.bond_history.ids())
    if (const BondLaw& law = *state.bonds[k].law;
        law.has_rules && law.remembers() && body.has(state.bonds[k]))
      sum += state.bond_history[k][law.dissipated_at];
  return sum;
}

Losses losses_by_flow(const BodyPart& body) {
  const State& state = body.state;
  Losses lost;
  for (const BondId k : state.bond_history.ids()) {
    const BondLaw& law = *state.bonds[k].law;
    if (!law.has_rules || !law.remembers() || !body.has(state.bonds[k].i)) continue;
    const BondRules& rules = *state.bonds[k].rules;
    const BondHistory& history = state.bond_history[k];
    if (law.crack != nullptr) {
      lost[Loss::friction] += history[law.dissipated_at];
      continue;
    }
    const FlowLimits yield = lost_by_yield(rules.yield, history);
    lost[Loss::yield_axial] += yield.axial;
    lost[Loss::yield_shear] += yield.shear;
    lost[Loss::yield_bending] += yield.bending;
    lost[Loss::yield_torsion] += yield.torsion;
    const double others =
        history[memory::dissipated] - (yield.axial + yield.shear + yield.bending + yield.torsion);
    if (rules.softening.any())
      lost[Loss::softening] += others;
    else if (rules.creep.rate > 0.0)
      lost[Loss::creep] += others;
  }
  body.all.sum(lost.of);
  return lost;
}

EnergyBooks opened_books(const BodyPart& body, double energy) {
  EnergyBooks books{.at_start = energy};
  books.lost -= losses_by_flow(body);
  return books;
}

Losses losses_of(const State& state) {
  Losses lost = state.books.lost;
  return lost += losses_by_flow(state);
}

}  // namespace vbond
