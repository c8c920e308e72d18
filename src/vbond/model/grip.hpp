#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/quat.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Where a grip of a stage of dynamics took hold of its particles, and what it has done since. A grip is a
/// support that moves its particles as one rigid body, or lets them move as one.
struct GripState {
  Vec3d pivot;                 ///< as it took hold  [length]
  double from = 0;             ///< integral of the stage's factor at that time; 0: as the stage began  [time]
  double work = 0;             ///< that it has done in the stage  [energy]
  std::int64_t particles = 0;  ///< how many entries of State::gripped are its
  // of one that moves freely in some degrees of freedom: along and about these, since it took hold
  Vec3d shift;  ///< of the pivot  [length]
  Quatd turn = {1, 0, 0, 0};
  Vec3d velocity;    ///< of the pivot; NaN: this and the spin follow from the particles  [length/time]
  Vec3d spin;        ///< angular momentum about the pivot  [mass*length^2/time]
  double angle = 0;  ///< turned about the one free axis, with its sign  [rad]
  friend bool operator==(const GripState&, const GripState&) = default;
};

/// How a grip took hold of a particle.
struct GrippedPose {
  Vec3d arm;  ///< from the pivot to the particle  [length]
  Quatd q;    ///< orientation of the particle
  friend bool operator==(const GrippedPose&, const GrippedPose&) = default;
};

/// A grip as observers see it.
struct GripView {
  std::string group;
  Vec3d force;       ///< that it exerts on its particles; their inertia is left out  [force]
  Vec3d moment;      ///< the same, about the pivot where it is now  [force*length]
  double angle = 0;  ///< turned about its axis since the stage began  [rad]
  /// In the stage, with the kinetic energy of its particles; absent: not known, of static points.  [energy]
  std::optional<double> work;
};

}  // namespace vbond
