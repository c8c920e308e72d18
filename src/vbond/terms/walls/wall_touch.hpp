#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/terms/walls/mesh_surface.hpp"
#include "vbond/terms/walls/wall.hpp"
#include "vbond/terms/walls/wall_touch_point.hpp"

namespace vbond {

/// The surface of a wall as it stands at the start, prepared once for many questions. All of them are const
/// and may be asked by several threads at once.
///
/// A sphere touches a plane, a disc, a cylinder or a sphere in one point at most, and a mesh in several
/// (mesh_surface.hpp). Planes, spheres and endless cylinders are felt from one side, which may be passed: the
/// distance is negative behind them. Discs, cylinders with ends and triangles are felt from both sides.
class WallSurface {
 public:
  explicit WallSurface(const WallShape& shape);

  /// False if no point of the wall is nearer than `reach` to the point; quick.
  bool may_touch(const Vec3d& centre, double reach) const;
  /// Appends the touches whose distance is less than `reach`. Their order depends on the shape only.
  void touches(const Vec3d& centre, double reach, std::vector<WallTouch>& out) const;
  /// The same with their derivatives by the centre.
  void touches(const Vec3<Dual<3>>& centre, double reach, std::vector<MovedWallTouch>& out) const;

  /// Appends the triangles of a mesh near the point, in increasing order: all nearer than `reach` and some
  /// others. Nothing for other shapes.
  void near(const Vec3d& centre, double reach, std::vector<std::uint32_t>& triangles) const;
  /// The touches if `triangles`, in increasing order, holds all that are nearer than `reach`; other shapes
  /// ignore them.
  void touches_of(std::span<const std::uint32_t> triangles, const Vec3d& centre, double reach,
                  std::vector<WallTouch>& out) const;

  bool is_mesh() const { return std::holds_alternative<MeshSurface>(shape_); }
  /// Whether both sides are felt: nothing tells that a particle behind it has come through.
  bool has_two_sides() const;

 private:
  template <Scalar T>
  void append(std::span<const std::uint32_t> triangles, const Vec3<T>& centre, double reach,
              std::vector<WallTouchOf<T>>& out) const;

  std::variant<PlaneWall, DiscWall, CylinderWall, SphereWall, MeshSurface> shape_;
};

}  // namespace vbond
