#pragma once
#include <functional>
#include <string>

#include "vbond/case/case.hpp"
#include "vbond/core/triangle_mesh.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Whose region it is, for messages.
struct RegionOwner {
  const std::string& case_file;
  SourcePlace place;
  std::string name;  ///< such as `group "left"`
};

/// True for points in a region, its boundary included.
using Inside = std::function<bool(const Vec3d&)>;

/// The test of a region. Throws CaseError if it has no direction, or for a file that cannot be read or is not
/// closed.
Inside inside_of(const BoxRegion& region, const RegionOwner& owner);
Inside inside_of(const SphereRegion& region, const RegionOwner& owner);
Inside inside_of(const CylinderRegion& region, const RegionOwner& owner);
Inside inside_of(const PlaneRegion& region, const RegionOwner& owner);
Inside inside_of(const HalfSpaceRegion& region, const RegionOwner& owner);
Inside inside_of(const MeshRegion& region, const RegionOwner& owner);

/// Whether a point lies in closed surfaces: a ray from it along +z goes through them an odd number of times.
/// Which way triangles face does not matter, nor whether the ray meets edges or corners. A point on the
/// surface may be told to be on either side.
bool is_inside(const TriangleMesh& mesh, const Vec3d& r);

}  // namespace vbond
