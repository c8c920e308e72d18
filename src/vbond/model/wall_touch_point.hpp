#pragma once
#include <cmath>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Where a sphere is nearest to a wall.
struct WallTouch {
  Vec3d normal;         ///< unit vector from the wall to the sphere's centre
  double distance = 0;  ///< of the centre from the wall along it; negative behind it  [length]
  /// Of the wall there: 0 flat, 1/R_w convex, -1/R_w hollow; edges, rims and corners count as flat.
  /// [1/length]
  double curvature_1 = 0, curvature_2 = 0;
};

/// The radius of the sphere that touches a plane as a sphere of radius R touches the wall: geometric mean of
/// both principal directions. R must be less than that of a hollow wall.  [length]
inline double effective_radius(double R, const WallTouch& t) {
  return 1.0 / std::sqrt((1.0 / R + t.curvature_1) * (1.0 / R + t.curvature_2));
}

}  // namespace vbond
