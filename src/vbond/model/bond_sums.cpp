#include "vbond/model/bond_sums.hpp"

#include <algorithm>

#include "vbond/physics/flowing.hpp"

namespace vbond {

double mean_axial_force(const State& state, const std::vector<ParticleId>& particles) {
  struct Pose {
    const Vec3d& r;
    const Quatd& q;
  };
  const auto inside = [&particles](ParticleId p) {
    return std::binary_search(particles.begin(), particles.end(), p);
  };
  std::vector<BondId> bonds;
  for (const BondId k : state.bonds.ids())
    if (!state.bonds[k].broken && inside(state.bonds[k].i) && inside(state.bonds[k].j)) bonds.push_back(k);
  return mean_axial_force(state, bonds, [&state](ParticleId p) { return Pose{state.r[p], state.q[p]}; });
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

double dissipated_by_flow(const State& state) {
  double sum = 0.0;
  for (const BondId k : state.bond_history.ids())
    if (state.bonds[k].law->has_rules) sum += state.bond_history[k][memory::dissipated];
  return sum;
}

}  // namespace vbond
