#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/core/quat.hpp"
#include "vbond/core/triangle_mesh.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/contact.hpp"
#include "vbond/model/time_function.hpp"

namespace vbond {

/// Which side of a closed surface particles are on.
enum class WallSide : std::uint8_t { outside, inside };

/// The half space behind a point: particles are in front of it, where the normal points.
struct PlaneWall {
  Vec3d point, normal;  ///< normal: unit vector
};
/// A round plate without thickness; both of its sides and its edge are felt.
struct DiscWall {
  Vec3d centre, normal;  ///< normal: unit vector
  double radius = 0;     ///< [length]
};
/// The lateral surface of a cylinder, without lids.
struct CylinderWall {
  Vec3d centre, axis;  ///< centre: the middle of its axis; axis: unit vector
  double radius = 0;   ///< [length]
  double length = 0;   ///< [length], infinity for an endless one
  WallSide side = WallSide::inside;
};
struct SphereWall {
  Vec3d centre;
  double radius = 0;  ///< [length]
  WallSide side = WallSide::inside;
};
/// Triangles; both sides are felt. Boxes are meshes of twelve.
struct MeshWall {
  TriangleMesh mesh;
};
using WallShape = std::variant<PlaneWall, DiscWall, CylinderWall, SphereWall, MeshWall>;

/// A rigid surface that particles touch. Its shape is given in the world frame as it stands at the start.
struct Wall {
  std::string name;
  WallShape shape;
  std::uint32_t material = 0;  ///< index in Model::materials
  Vec3d centre;                ///< what it turns about and moments refer to  [length]
};

/// Where a wall is, how it moves and what presses on it: a point x of its shape at the start is now at
/// centre + displacement + q (x - centre).
struct WallState {
  Vec3d displacement;      ///< [length]
  Quatd q;                 ///< orientation
  Vec3d velocity;          ///< of its centre  [length/time]
  Vec3d angular_velocity;  ///< [rad/time]
  Vec3d force, moment;     ///< of particles on it, moment about its centre  [force], [force*length]
  double servo = 0;        ///< its speed along the servo's direction  [length/time]
  double work = 0;         ///< that it has done on particles  [energy]
  std::uint32_t off = 0;   ///< 1: the stage has taken it away
  friend bool operator==(const WallState&, const WallState&) = default;
};

/// Where a point in space would be if the wall stood as at the start.
inline Vec3d at_start(const Wall& wall, const WallState& now, const Vec3d& r) {
  return wall.centre + rotate(conjugate(now.q), r - wall.centre - now.displacement);
}

/// What a particle remembers of a place where it touches a wall.
struct WallMemory {
  ParticleId p;
  std::uint32_t wall = 0;
  Vec3d normal;  ///< from the wall to the particle
  PairHistory history{};
  friend bool operator==(const WallMemory&, const WallMemory&) = default;
};
/// By which memories are in order.
inline std::pair<ParticleId, std::uint32_t> place_of(const WallMemory& m) {
  return {m.p, m.wall};
}

/// What moves a wall in a stage. Without one it stands still. At rest the velocities are the way to load
/// factor 1, and it neither swings nor has a servo.
struct WallDrive {
  std::string wall;        ///< name, for reports
  std::size_t index = 0;   ///< in Model::walls
  Vec3d velocity;          ///< of the centre, at rest of the pivot  [length/time]; at rest [length]
  Vec3d angular_velocity;  ///< about `pivot`, in motion fixed in space  [rad/time]; at rest [rad]
  /// As the stage begins; absent: the wall's centre, wherever it is  [length].
  std::optional<Vec3d> pivot = {};
  TimeFunction factor = {};  ///< of velocity and angular velocity
  Vec3d amplitude = {};      ///< oscillation: displacement amplitude sin(2 pi frequency t)  [length]
  double frequency = 0;      ///< [1/time]
  /// The wall is driven along a direction until particles press back with this force.
  struct Servo {
    Vec3d direction;      ///< unit vector, the way in which it presses
    double force = 0;     ///< aimed at  [force]
    TimeFunction factor;  ///< of the force
    double mass = 0;      ///< of the wall, which moves as a body of this mass  [mass]
    double damping = 0;   ///< viscous, on the wall  [force*time/length]
    double fastest = 0;   ///< largest speed  [length/time]
  };
  std::optional<Servo> servo = {};
  bool off = false;  ///< the wall is not there in this stage
};

}  // namespace vbond
