#pragma once
#include "vbond/core/bounding_box.hpp"
#include "vbond/core/communicator.hpp"
#include "vbond/core/triangle_mesh.hpp"
#include "vbond/model/model.hpp"
#include "vbond/terms/walls/wall.hpp"

namespace vbond {

/// The box around all particles of the model at the start, of which each process may have some. Without any
/// it is a unit cube.
BoundingBox body_at_start(const Model& model, const Communicator& all = alone());

/// The wall at the start as triangles, for pictures: meshes as they are, round shapes with 64 corners to a
/// turn. Planes and endless cylinders are shown where the body is: a plane as a rectangle half as
/// large again as the body's box on it, a cylinder as long as the diagonal of that box.
TriangleMesh triangles_of(const Wall& wall, const BoundingBox& body);

/// Where a point of the wall at the start is now.
inline Vec3d moved(const Wall& wall, const WallState& now, const Vec3d& x) {
  return wall.centre + now.displacement + rotate(now.q, x - wall.centre);
}

}  // namespace vbond
