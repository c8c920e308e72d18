#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/triangle_mesh.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// One closed surface of triangles that hang together along edges. A ray along +z tells whether it is left an
/// odd number of times, or, where all triangles face alike (all outwards or all inwards), more often the one
/// way than the other: so a surface that crosses itself has no hollow either. Whether the ray meets edges or
/// corners does not matter. A point on the surface may be told to be on either side.
class ClosedSurface {
 public:
  explicit ClosedSurface(TriangleMesh mesh);
  bool holds(const Vec3d& r) const;

  const TriangleMesh& mesh() const { return mesh_; }
  const BoundingBox& box() const { return box_; }
  bool faces_alike() const { return faces_alike_; }

 private:
  /// The strips, first and last, that a triangle reaches into.
  std::array<std::size_t, 2> strips_of(const std::array<std::uint32_t, 3>& triangle) const;
  std::size_t strip_of(double y) const;

  TriangleMesh mesh_;
  BoundingBox box_;
  bool faces_alike_;
  std::vector<std::vector<std::uint32_t>> strips_;  // equal parts of the box along y: the triangles of each
};

/// The inside of closed surfaces. Surfaces that cross one another are one body, the union of what they hold.
/// A point is inside if an odd number of bodies hold it: a surface within another one bounds a hollow,
/// whichever way its triangles face.
class MeshInside {
 public:
  explicit MeshInside(const TriangleMesh& mesh);
  bool operator()(const Vec3d& r) const;

  /// Whether surfaces meet in common edges and face both ways, so that nothing tells which sides belong
  /// together.
  bool is_ambiguous() const;
  std::size_t surfaces() const { return surfaces_.size(); }
  std::size_t crossing() const;  ///< surfaces that cross another one
  std::size_t within_others() const {
    return nested_;
  }  ///< surfaces that lie in another one, and so are hollows

 private:
  std::vector<ClosedSurface> surfaces_;
  std::vector<std::vector<std::size_t>> bodies_;  // the surfaces of each
  std::size_t nested_ = 0;
};

}  // namespace vbond
