#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/terms/walls/term_walls.hpp"
#include "vbond/terms/walls/wall.hpp"

/// Materials and walls of a case as the user wrote them; see case.hpp. Vectors of a direction have any length
/// but zero.
namespace vbond {

struct MaterialSpec {
  SourcePlace place;
  std::string name;
  double E = 0, nu = 0;
  Surface surface;
};

/// What holds between two materials.
struct ContactPairSpec {
  SourcePlace place;
  Placed<std::string> material, with;
  Surface surface;
};

struct PlaneWallSpec {
  Vec3d point, normal{0, 0, 1};
};
struct DiscWallSpec {
  Vec3d centre, normal{0, 0, 1};
  double radius = 0;
};
struct CylinderWallSpec {
  Vec3d centre, axis{0, 0, 1};
  double radius = 0;
  std::optional<double> length;  ///< nothing: endless
  WallSide side = WallSide::inside;
};
struct SphereWallSpec {
  Vec3d centre;
  double radius = 0;
  WallSide side = WallSide::inside;
};
struct BoxWallSpec {
  Vec3d min, max;
};
struct MeshWallSpec {
  Placed<std::filesystem::path> file;  ///< relative to the case file
  double scale = 1.0;
  Vec3d shift;  ///< after scaling
};

struct WallSpec {
  SourcePlace place;
  std::string name;
  std::variant<PlaneWallSpec, DiscWallSpec, CylinderWallSpec, SphereWallSpec, BoxWallSpec, MeshWallSpec>
      shape;
  std::optional<Placed<std::string>> material;  ///< default: the first of the case
  std::optional<Vec3d> moments_about;           ///< default: its point or the middle of it
};

struct WallOscillationSpec {
  Vec3d amplitude;
  double frequency = 0;
};

struct WallServoSpec {
  Vec3d direction{0, 0, -1};
  double force = 0;
  TimeFunctionSpec factor;
  double mass = 0;
  double damping = 0;
  std::optional<double> fastest;  ///< nothing: any speed
};

struct WallDriveSpec {
  SourcePlace place;
  Placed<std::string> wall;
  std::optional<Vec3d> pivot;  ///< default: what its moments are about
  bool off = false;            ///< not there in this stage

  // static stages
  Vec3d displacement, rotation;

  // dynamics
  Vec3d velocity, angular_velocity;
  TimeFunctionSpec factor;  ///< of both velocities
  std::optional<WallOscillationSpec> oscillation;
  std::optional<WallServoSpec> servo;
};

template <>
struct SpecPart<WallsTerm> {
  std::vector<WallDriveSpec> walls;  ///< dynamics, equilibrium, fracture
  bool any() const { return !walls.empty(); }
  bool grows() const { return any(); }
};

namespace keys {
class Table;
void describe(Table& t, WallSpec& w);
void describe(Table& t, PlaneWallSpec& w);
void describe(Table& t, DiscWallSpec& w);
void describe(Table& t, CylinderWallSpec& w);
void describe(Table& t, SphereWallSpec& w);
void describe(Table& t, BoxWallSpec& w);
void describe(Table& t, MeshWallSpec& w);
/// Keys of a stage of this kind; those of every kind if it is not known.
void describe(Table& t, WallDriveSpec& d, std::optional<StageKind> kind);
void describe(Table& t, WallOscillationSpec& o);
void describe(Table& t, WallServoSpec& s);
}  // namespace keys

}  // namespace vbond
