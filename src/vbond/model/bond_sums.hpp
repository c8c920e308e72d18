#pragma once
#include "vbond/model/loads.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// F.d of a bond between particles that stand like this, tension positive: both laws' other terms are normal
/// to d.  [force]
inline double axial_force(const Bond& b, const Vec3d& r_i, const Quatd& q_i, const Vec3d& r_j,
                          const Quatd& q_j) {
  if (b.R_i == 0.0 && b.R_j == 0.0) return b.B1 * (norm(r_j - r_i) - b.a);  // no need of the axes
  return b.B1 * (norm(bonded_points(bond_pose(b, r_i, q_i, r_j, q_j), b.R_i, b.R_j)) - b.a);
}

/// Adds every bond's loads to its two particles, bond by bond: the reference for the loops of the step.
void add_bond_loads(const State& state, Loads& loads);

/// Energy of all bonds by channel, bond by bond, relative to rest; other members are left at zero.  [energy]
Energies bond_energies(const State& state);

}  // namespace vbond
