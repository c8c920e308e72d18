// vbondplugin.so: vbond's bonds and step for a LAMMPS with the packages PLUGIN and BPM. It links LAMMPS and
// so is under LAMMPS' licence, GPL-2.
#include <lammpsplugin.h>
#include <version.h>

#include "bond_vbond.hpp"
#include "fix_vbond_nve.hpp"

extern "C" void lammpsplugin_init(void* lmp, void* handle, void* register_function) {
  const auto add = reinterpret_cast<lammpsplugin_regfunc>(register_function);
  lammpsplugin_t plugin{};
  plugin.version = LAMMPS_VERSION;
  plugin.author = "the authors of vbond";
  plugin.handle = handle;

  plugin.style = "bond";
  plugin.name = "vbond";
  plugin.info = "bonds of vbond " VBOND_VERSION;
  plugin.creator.v1 = reinterpret_cast<lammpsplugin_factory1*>(&vbond::BondVbond::make);
  add(&plugin, lmp);

  plugin.style = "fix";
  plugin.name = "vbond/nve";
  plugin.info = "step of vbond " VBOND_VERSION;
  plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2*>(&vbond::FixVbondNve::make);
  add(&plugin, lmp);
}
