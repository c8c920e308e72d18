#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vbond/core/triangle_mesh.hpp"
#include "vbond/core/triangle_tree.hpp"
#include "vbond/terms/walls/wall_touch_point.hpp"

namespace vbond {

/// A triangle mesh that spheres touch from both sides.
///
/// A sphere touches it once in each distinct point of a triangle that is the closest one of this triangle. On
/// an edge or a corner it does so only if no triangle that has this edge or corner is nearer: else a sphere
/// on a plate would feel the triangles around it, too (Ericson 2005; Hu et al. 2013). So a flat plate is felt
/// as one however many triangles it is made of. Points within `same_point` of the reach are one: a bend of a
/// ten thousandth of a radian, as rounded coordinates in a file make them, is not a valley that doubles the
/// force.
///
/// The same holds across a seam, where two open edges (with a triangle on one side only) run beside each
/// other without having the same corners, apart by less than a twentieth of their length. Where a sphere is
/// deeper in the nearer of two triangles than the seam is open, and touches one of them at the seam, only the
/// nearer counts.
class MeshSurface {
 public:
  static constexpr double same_point = 1e-4;

  /// Triangles with an area (has_area) and finite corners; no triangle twice.
  explicit MeshSurface(const TriangleMesh& mesh);

  bool may_touch(const Vec3d& centre, double reach) const { return tree_.may_be_near(centre, reach); }
  void near(const Vec3d& centre, double reach, std::vector<std::uint32_t>& triangles) const {
    tree_.near(centre, reach, triangles);
  }
  /// Of double and of Dual<3>: see WallTouchOf.
  template <Scalar T>
  void touches_of(std::span<const std::uint32_t> triangles, const Vec3<T>& centre, double reach,
                  std::vector<WallTouchOf<T>>& out) const;

 private:
  struct Corners {
    Vec3d a, b, c;
  };
  /// Edges with a triangle on one side only, and corners where such edges end.
  struct OpenParts {
    std::array<bool, 3> corner{}, edge{};  ///< edge: from corner k to the next
    bool any = false;
  };
  /// For each of several things the triangles that have it.
  struct Holders {
    std::vector<std::uint32_t> first, triangles;
    std::span<const std::uint32_t> of(std::uint32_t k) const {
      return std::span(triangles).subspan(first[k], first[k + 1] - first[k]);
    }
  };
  TrianglePoint closest(std::uint32_t triangle, const Vec3d& r) const;
  bool is_nearest_of_its_part(std::uint32_t triangle, const TrianglePoint& p, const Vec3d& centre) const;
  void find_open_parts();
  bool is_beyond_a_seam(std::uint32_t triangle, const TrianglePoint& p, const Vec3d& centre, double reach,
                        std::span<const std::uint32_t> triangles) const;
  bool is_at_seam(std::uint32_t triangle, const Vec3d& r, std::uint32_t other, double most) const;
  template <Scalar T>
  Vec3<T> foot(std::uint32_t triangle, const TrianglePoint& p, const Vec3<T>& centre) const;
  template <Scalar T>
  WallTouchOf<T> touch(std::uint32_t triangle, const TrianglePoint& p, const Vec3<T>& centre) const;

  TriangleTree tree_;
  std::vector<Corners> corners_;                         // of each triangle
  std::vector<Vec3d> normal_;                            // of each triangle, unit vector
  std::vector<std::array<std::uint32_t, 3>> corner_id_;  // of each triangle
  std::vector<std::array<std::uint32_t, 3>> edge_id_;    // from its corner k to the next
  Holders of_corner_, of_edge_;
  std::vector<OpenParts> open_;  // of each triangle
  double rounding_ = 0;          // points that differ by less may be the same  [length]
};

}  // namespace vbond
