#pragma once
#include "vbond/core/quat.hpp"

namespace vbond {

/// How far the end of an arm goes when a unit quaternion turns it: rotate(turn, arm) - arm without the loss
/// of digits of that difference. On the circle, not on its tangent.
inline Vec3d swing(const Quatd& turn, const Vec3d& arm) {
  const Vec3d u{turn.x, turn.y, turn.z};
  const Vec3d t = 2.0 * cross(u, arm);
  return turn.w * t + cross(u, t);
}

/// A rigid motion in proportion to one number s: a pivot goes along `velocity`, and the body turns about it
/// by the rotation vector `angular_velocity`, both per unit of s.
struct RigidMotion {
  Vec3d pivot;  ///< at s = 0  [length]
  Vec3d velocity;
  Vec3d angular_velocity;

  Vec3d pivot_at(double s) const { return pivot + s * velocity; }
  Quatd turn(double s) const { return rotation_of(s * angular_velocity); }
  /// dr/ds of a point of the body that is now at r.
  Vec3d rate_at(double s, const Vec3d& r) const {
    return velocity + cross(angular_velocity, r - pivot_at(s));
  }
};

}  // namespace vbond
