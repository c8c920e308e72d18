#include "fix_vbond_nve.hpp"

#include <atom.h>
#include <error.h>
#include <force.h>
#include <update.h>

#include <cstring>

#include "vbond/core/quat.hpp"

namespace vbond {

FixVbondNve::FixVbondNve(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) : Fix(lmp, narg, arg) {
  time_integrate = dynamic_group_allow = 1;
  scalar_flag = extscalar = global_freq = 1;
  for (int k = 3; k < narg; k += 2) {
    if (std::strcmp(arg[k], "inertia") != 0)
      error->all(FLERR, "Unknown keyword {} of fix vbond/nve: it may be inertia", arg[k]);
    if (k + 1 >= narg) LAMMPS_NS::utils::missing_cmd_args(FLERR, "fix vbond/nve inertia", error);
    part_ = LAMMPS_NS::utils::numeric(FLERR, arg[k + 1], false, lmp);
    if (!(part_ > 0.0)) error->all(FLERR, "fix vbond/nve inertia: it must be > 0");
  }
  if (!atom->quat_flag || !atom->omega_flag || !atom->torque_flag || !atom->radius_flag)
    error->all(FLERR, "fix vbond/nve needs quaternions of atoms: use atom_style bpm/sphere");
}

int FixVbondNve::setmask() {
  return LAMMPS_NS::FixConst::INITIAL_INTEGRATE | LAMMPS_NS::FixConst::FINAL_INTEGRATE;
}

int FixVbondNve::atoms() const {
  return igroup == atom->firstgroup ? atom->nfirst : atom->nlocal;
}

void FixVbondNve::init() {
  reset_dt();
  int is_double = 0, columns = 0;
  index_of_given_ = atom->find_custom("inertia", is_double, columns);
  if (index_of_given_ >= 0 && (is_double != 1 || columns != 0))
    error->all(FLERR, "fix vbond/nve: the property inertia of atoms must be d_inertia, one number");
  given_ = index_of_given_ < 0 ? nullptr : atom->dvector[index_of_given_];
  for (int i = 0; i < atoms(); ++i)
    if ((atom->mask[i] & groupbit) && !(inertia(i) > 0.0))
      error->one(FLERR, "fix vbond/nve: atom {} has no moment of inertia: give it a radius or d_inertia",
                 atom->tag[i]);
}

void FixVbondNve::reset_dt() {
  dt_ = update->dt;
  kick_ = 0.5 * update->dt * force->ftm2v;
}

double FixVbondNve::inertia(int i) const {
  return given_ ? given_[i] : part_ * atom->rmass[i] * sq(atom->radius[i]);
}

void FixVbondNve::kick(int i) const {
  const double per_m = kick_ / atom->rmass[i], per_Theta = kick_ / inertia(i);
  for (int k = 0; k < 3; ++k) {
    atom->v[i][k] += per_m * atom->f[i][k];
    atom->omega[i][k] += per_Theta * atom->torque[i][k];
  }
}

void FixVbondNve::initial_integrate(int /*vflag*/) {
  given_ = index_of_given_ < 0 ? nullptr : atom->dvector[index_of_given_];
  for (int i = 0; i < atoms(); ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    kick(i);
    for (int k = 0; k < 3; ++k) atom->x[i][k] += dt_ * atom->v[i][k];
    const double *omega = atom->omega[i], *old = atom->quat[i];
    const Quatd turn = rotation_of(dt_ * Vec3d{omega[0], omega[1], omega[2]});
    const Quatd q = renormalised(turn * Quatd{old[0], old[1], old[2], old[3]});
    double* to = atom->quat[i];
    to[0] = q.w, to[1] = q.x, to[2] = q.y, to[3] = q.z;
  }
}

void FixVbondNve::final_integrate() {
  given_ = index_of_given_ < 0 ? nullptr : atom->dvector[index_of_given_];
  for (int i = 0; i < atoms(); ++i)
    if (atom->mask[i] & groupbit) kick(i);
}

double FixVbondNve::compute_scalar() {
  given_ = index_of_given_ < 0 ? nullptr : atom->dvector[index_of_given_];
  double mine = 0.0, all = 0.0;
  for (int i = 0; i < atoms(); ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double* omega = atom->omega[i];
    mine += 0.5 * force->mvv2e * inertia(i) * norm2(Vec3d{omega[0], omega[1], omega[2]});
  }
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

}  // namespace vbond
