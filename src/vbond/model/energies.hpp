#pragma once
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/terms/walls/resting_walls.hpp"

namespace vbond {

/// Energy of contacts between particles as these stand, pair by pair. for_pairs(visit) visits the pairs that
/// touch, as for_touching_pairs().  [energy]
template <class ForPairs>
double contact_energy(const Model& model, const State& state, ForPairs&& for_pairs) {
  double sum = 0.0;
  for_pairs([&](ParticleId i, ParticleId j, const Image&, double overlap) {
    const double R = reduced_radius(model.radius[i], model.radius[j]);
    sum += normal_energy(touch_forms(model.contact), touch_numbers(model, i, j), R, overlap);
  });
  return sum + fibre_energy(model, state);
}
/// The same with energies of bonds; kinetic ones are left at zero.  [energy]
template <class ForPairs>
Energies mutual_energies(const Model& model, const State& state, ForPairs&& for_pairs) {
  Energies e = bond_energies(state);
  e.contact = contact_energy(model, state, for_pairs);
  return e;
}
inline Energies mutual_energies(const Model& model, const State& state) {
  return mutual_energies(model, state, [&](const auto& visit) { for_touching_pairs(model, state, visit); });
}
/// The same with those of contacts with walls.  [energy]
inline Energies potential_energies(const Model& model, const State& state) {
  Energies e = mutual_energies(model, state);
  if (const RestingWalls walls(model); walls.any()) e.contact += walls.energy(state);
  return e;
}

/// Kinetic energy, particle by particle.  [energy]
inline double kinetic_energy(const Model& model, const State& state) {
  double sum = 0.0;
  for (const ParticleId p : model.mass.ids()) {
    const bool top = model.is_top(p);
    sum += 0.5 * (model.mass[p] * norm2(state.v[p]) + (top ? 0.0 : model.inertia[p]) * norm2(state.omega[p]));
    if (top)
      sum +=
          rotation_energy(model.principal[p].moments, state.q[p] * model.principal[p].axes, state.omega[p]);
  }
  return sum;
}

}  // namespace vbond
