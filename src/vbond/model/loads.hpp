#pragma once
#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Forces and moments on the particles at the present positions.
struct Loads {
  PerParticle<Vec3d> F;  ///< bonds, contacts and applied loads, without viscous drag  [force]
  PerParticle<Vec3d> M;  ///< about each particle's own centre  [force*length]
  friend bool operator==(const Loads&, const Loads&) = default;
};

/// Total force and moment (about the origin of coordinates) that supports exert.
struct Reaction {
  Vec3d force;   ///< [force]
  Vec3d moment;  ///< [force*length]
};

/// Where the energy is, relative to undeformed bonds.  [energy]
struct Energies {
  double kinetic_translation = 0, kinetic_rotation = 0;
  double U_L = 0, U_B = 0, U_T = 0;  ///< bonds: stretching; bending and shear; torsion
  double contact = 0;
  double kinetic() const { return kinetic_translation + kinetic_rotation; }
  double potential() const { return U_L + U_B + U_T + contact; }
  double total() const { return kinetic() + potential(); }
};

}  // namespace vbond
