#pragma once
#include <string>

namespace vbond {

/// Parameters of bonds as other programs publish them, as texts, with or without units; empty: not given.
struct PublishedBonds {
  std::string program;  ///< "pfc" or "edem"
  // pfc: properties of linearpbond
  std::string pb_kn, pb_ks, pb_emod, pb_kratio, pb_rmul, pb_ten, pb_coh, pb_fa, pb_mcf;
  // edem: Hertz-Mindlin with bonding
  std::string normal_stiffness, shear_stiffness, normal_stress, shear_stress, disk_radius;
  std::string gap;  ///< largest gap of surfaces that is bonded
};

/// The section [[bonds]] of a case that says the same, with the formulas in comments. Throws CaseError with
/// all mistakes, named as the options of `vbond calibrate`.
std::string bonds_as_published(const PublishedBonds& bonds);

}  // namespace vbond
