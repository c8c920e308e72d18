#pragma once
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// Material and section of a bond as texts, with or without units; empty: not given.
struct CalibrateOptions {
  std::string E, nu = "0.2", length, diameter, inner_diameter, side, A, J, J_p, kappa, thickness;
  std::string theory = "all";
};

/// What a theory makes of a material and a section.
struct CalibratedTheory {
  std::string name, limits;
  std::string left_out;  ///< why it says nothing; empty: it does
  BondStiffness<double> c;
  /// Of each law that case files name, its coefficients that follow from stiffnesses.
  std::vector<std::pair<std::string, std::vector<std::pair<std::string, double>>>> laws;
};

struct Calibration {
  Material material;
  Section section;
  double thickness = 0;  ///< of the wall of a shell, which has no section; else 0
  double length = 0;
  std::vector<CalibratedTheory> theories;
};

/// E and nu alone, of what a body with these units is to be like. Throws CaseError as calibration() does,
/// also for what belongs to a single bond.
Material material_asked_for(const CalibrateOptions& options, UnitSystem units);

/// Throws CaseError with all mistakes of the options, named as `vbond calibrate` has them.
Calibration calibration(const CalibrateOptions& options);

}  // namespace vbond
