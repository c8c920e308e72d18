#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/triangle_mesh.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/setup/mesh_inside.hpp"

namespace vbond {

/// Whose region it is, for messages.
struct RegionOwner {
  const std::string& case_file;
  SourcePlace place;
  std::string name;                 ///< such as `group "left"`
  std::vector<std::string>& notes;  ///< takes what is made of a file
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

/// Closed surfaces of a file, and what they hold.
struct ClosedMesh {
  TriangleMesh surface;
  std::shared_ptr<const MeshInside> inside;
};
/// Throws CaseError for a file that cannot be read or is not closed.
ClosedMesh closed_mesh(const MeshRegion& region, const RegionOwner& owner);

}  // namespace vbond
