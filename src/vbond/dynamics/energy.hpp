#pragma once
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Energy of all bonds by channel, relative to rest; other members are left at zero.  [energy]
Energies bond_energies(const State& state);

/// Kinetic energy of translation and rotation; other members are left at zero.  [energy]
Energies kinetic_energies(const Model& model, const State& state, int threads = 1);

}  // namespace vbond
