#pragma once
#include <optional>
#include <vector>

#include "vbond/terms/heat/heating.hpp"
#include "vbond/terms/pressure/pressure.hpp"
#include "vbond/terms/strain/strain.hpp"
#include "vbond/terms/walls/wall.hpp"

namespace vbond {

/// What the terms do in a stage, of motion or at rest.
struct StageTerms {
  std::vector<Heating> heating;         ///< in this order, where groups overlap
  std::optional<StrainProgram> strain;  ///< of motion
  std::vector<Pressure> pressures;      ///< all add up
  std::vector<WallDrive> walls;         ///< of motion, equilibrium and fracture; other walls stand still
};

}  // namespace vbond
