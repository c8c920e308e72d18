#pragma once
#include <cstdint>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/triangle_mesh.hpp"

namespace vbond {

/// Where on a triangle a point is: at a corner, on the edge from that corner to the next, or within.
enum class TrianglePart : std::uint8_t { corner_0, corner_1, corner_2, edge_01, edge_12, edge_20, face };

struct TrianglePoint {
  Vec3d r;
  TrianglePart part = TrianglePart::face;
};

/// The point of the triangle a, b, c, whose area is not zero, that is closest to r: Ericson, Real-Time
/// Collision Detection (2005), 5.1.5.
TrianglePoint closest_on_triangle(const Vec3d& r, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Finds the triangles of a mesh near a point: a binary tree of boxes along the axes.
class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(const TriangleMesh& mesh);

  const BoundingBox& box() const { return box_; }
  /// True unless the point is surely as far as `reach` or farther from all triangles.
  bool may_be_near(const Vec3d& r, double reach) const;
  /// Appends the triangles whose boxes are nearer than `reach`, in increasing order: those that are so near
  /// themselves, and others.
  void near(const Vec3d& r, double reach, std::vector<std::uint32_t>& triangles) const;

 private:
  struct Node {
    BoundingBox box;
    std::uint32_t first, count;  ///< in order_
    std::uint32_t second;        ///< the second half; the first one follows this node. 0: none, a leaf
  };
  void split(std::uint32_t first, std::uint32_t count, const std::vector<BoundingBox>& boxes);

  BoundingBox box_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  // triangles, those of a node next to each other
  std::vector<BoundingBox> boxes_;    // in this order
};

}  // namespace vbond
