#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/bounding_box.hpp"
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

/// Tells whether points lie in closed surfaces: a ray along +z goes out through them an odd number of times.
/// Which way triangles face does not matter, nor whether the ray meets edges or corners. A point on the
/// surface may be told to be on either side.
class MeshInside {
 public:
  explicit MeshInside(TriangleMesh mesh);
  bool operator()(const Vec3d& r) const;

 private:
  /// The strips, first and last, that a triangle reaches into.
  std::array<std::size_t, 2> strips_of(const std::array<std::uint32_t, 3>& triangle) const;
  std::size_t strip_of(double y) const;

  TriangleMesh mesh_;
  BoundingBox box_;
  std::vector<std::vector<std::uint32_t>> strips_;  // equal parts of the box along y: the triangles of each
};

}  // namespace vbond
