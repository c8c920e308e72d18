#include "vbond/dynamics/energy.hpp"

#include "vbond/dynamics/bonds.hpp"
#include "vbond/dynamics/parallel.hpp"

namespace vbond {

Energies bond_energies(const State& state) {
  Energies e;
  for (const Bond& b : state.bonds) {
    const BondPose<double> pose = bond_pose(b, state);
    const BondEnergy<double> u = visit_law(b, [&pose](const auto& law) { return bond_energy(law, pose); });
    e.U_L += u.U_L;
    e.U_B += u.U_B;
    e.U_T += u.U_T;
  }
  return e;
}

Energies kinetic_energies(const Model& model, const State& state, int threads) {
  Energies e;
  e.kinetic_translation = sum_over(state.v.size(), threads, [&](std::size_t k) {
    return 0.5 * model.mass[ParticleId{k}] * norm2(state.v[ParticleId{k}]);
  });
  e.kinetic_rotation = sum_over(state.v.size(), threads, [&](std::size_t k) {
    return 0.5 * model.inertia[ParticleId{k}] * norm2(state.omega[ParticleId{k}]);
  });
  return e;
}

}  // namespace vbond
