#pragma once
#include <fix.h>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// LAMMPS' fix vbond/nve: vbond's step (kick, drift, kick; orientations turn by the exponential map) for
/// atoms with quaternions. The moment of inertia of an atom is its property d_inertia, if there is one, or a
/// part of m R^2. Its scalar is the kinetic energy of rotation.
class FixVbondNve : public LAMMPS_NS::Fix {
 public:
  FixVbondNve(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg);

  int setmask() override;
  void init() override;
  void initial_integrate(int vflag) override;
  void final_integrate() override;
  void reset_dt() override;
  double compute_scalar() override;
  static Fix* make(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) { return new FixVbondNve(lmp, narg, arg); }

 private:
  int atoms() const;
  double inertia(int i) const;
  void kick(int i) const;

  double part_ = 0.4;              // of m R^2: a full sphere
  const double* given_ = nullptr;  // d_inertia, in this step
  int index_of_given_ = -1;
  double dt_ = 0, kick_ = 0;  // kick_: half a step, in LAMMPS' unit of force by mass
};

}  // namespace vbond
