#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/stage.hpp"

/// Bonds as the user wrote them.
namespace vbond {

struct WithinDistance {
  double distance;
};
struct WithinGap {  ///< of the surfaces
  double gap;
};
struct WithinFactor {  ///< of the sum of the radii
  double factor;
};
struct ListedPairs {
  std::vector<std::array<std::int64_t, 2>> pairs;
};
struct PairsFile {
  std::filesystem::path file;
};                                        ///< CSV with header i,j
struct SpecimenPairs {                    ///< the bonds of a LAMMPS data file, or of a bonds_file
  std::optional<std::int64_t> bond_type;  ///< only those of this type of the file
};
struct AtCrossings {  ///< of fibres, bonded where their axes are nearest
  double gap;         ///< of their surfaces
};
enum class BondTime : std::uint8_t { start, stage, approach };

/// Limits as the case names them; which of them count, the criterion says. recipe.rules has what follows.
struct StrengthSpec {
  Criterion criterion = Criterion::none;           ///< not read yet
  double tension = 0, shear = 0, compression = 0;  ///< stresses; compression 0: none
  double moment_share = 1;
  double cohesion = 0, friction_angle = 0;  ///< mohr-coulomb; the angle in rad
  double axial_force = 0, shear_force = 0, bending_moment = 0, torque = 0;  ///< linear, quadratic
  bool compression_relieves = false;                                        ///< linear
  std::optional<double> moments;                                            ///< mohr-coulomb: moment_share
  double tension_energy = 0, other_energy = 0;                              ///< energy
  double elongation = 0;
  std::optional<Section> section;  ///< where no theory has one
};

/// Loads at which bonds flow; those that are not given are never reached.
struct YieldSpec {
  std::optional<double> axial_force, compression_force, shear_force, bending_moment, torque;
  FlowLimits isotropic, kinematic;
};
struct CreepSpec {
  bool is_norton = false;
  double viscosity = 0;         ///< Maxwell's
  std::int64_t exponent = 1;    ///< Norton's
  double speed = 0, force = 0;  ///< it creeps at this speed under this force
};
struct SofteningSpec {
  SourcePlace place;
  double tension = 0, fracture_energy = 0;
  std::optional<Section> section;  ///< where no theory has one
};

/// Of pairs selected by how near they are, those alone whose Voronoi cells meet.
struct FaceChoice {
  bool only = false;
  double least = 0.01;  ///< area of the face over the square of the distance
};

struct BondSpec {
  /// Of pairs selected by how near they are; nothing if they are listed.
  std::optional<BondReach> reach() const {
    if (const auto* s = std::get_if<WithinDistance>(&select.value)) return BondReach{s->distance, 0.0};
    if (const auto* s = std::get_if<WithinGap>(&select.value)) return BondReach{s->gap, 1.0};
    if (const auto* s = std::get_if<WithinFactor>(&select.value)) return BondReach{0.0, s->factor};
    return std::nullopt;
  }

  SourcePlace place;
  std::string name;
  std::array<Placed<std::string>, 2> between{Placed<std::string>{"all", {}}, {"all", {}}};  ///< groups
  Placed<std::variant<WithinDistance, ListedPairs, PairsFile, SpecimenPairs, WithinGap, WithinFactor,
                      AtCrossings>>
      select;
  FaceChoice faces;
  BondShare share;  ///< of the selected pairs that is bonded
  BondTime when = BondTime::start;
  std::vector<Placed<std::string>> stages;  ///< for `stage` and `approach`; approach: none means all
  std::optional<StrengthSpec> strength;
  std::optional<YieldSpec> yield;
  std::optional<CreepSpec> creep;
  std::optional<SofteningSpec> softening;
  BondRecipe recipe;  ///< its law is one without rules
};

}  // namespace vbond
