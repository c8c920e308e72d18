#pragma once
#include <array>
#include <memory>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/cell.hpp"
#include "vbond/core/vec3.hpp"

/// What grains are packed into: a periodic cell, walls, or both.
namespace vbond::packing {

/// How a wall is felt from a point.
struct Feel {
  double depth = 0;  ///< distance from the wall, < 0 behind it  [length]
  Vec3d inward;      ///< unit vector from the wall into the vessel
};

/// The side of a plane that its normal points away from: r . normal <= at.
struct Plane {
  Vec3d normal;   ///< a unit vector
  double at = 0;  ///< [length]
};

/// One surface of a vessel. All of it is const and may be asked by several threads at once.
class Wall {
 public:
  virtual ~Wall() = default;
  /// Distance of a point from the nearest place of the wall, < 0 outside of the vessel; where the point is
  /// far outside it may be nearer to 0 than that, never farther.
  virtual double depth(const Vec3d& r) const = 0;
  /// Appends how a sphere around r that reaches so far feels it: once for each place that is nearest to it.
  virtual void feel(const Vec3d& r, double reach, std::vector<Feel>& out) const = 0;
  /// Appends planes that together hold what the wall holds, curved walls as voronoi.hpp says; false if there
  /// are none: around obstacles, and of meshes.
  virtual bool add_planes(std::vector<Plane>&) const { return false; }
};

/// The side that the normal, a unit vector, points away from.
std::shared_ptr<const Wall> half_space(const Vec3d& point, const Vec3d& normal);
/// The inside of a sphere, or all but it.
std::shared_ptr<const Wall> ball(const Vec3d& centre, double radius, bool inside);
/// The inside of an endless cylinder; axis: a unit vector.
std::shared_ptr<const Wall> tube(const Vec3d& point, const Vec3d& axis, double radius);
/// All but a cylinder with flat ends.
std::shared_ptr<const Wall> around_cylinder(const Vec3d& from, const Vec3d& to, double radius);
/// All but a box along the axes.
std::shared_ptr<const Wall> around_box(const Vec3d& min, const Vec3d& max);
/// All but what lies between two planes; normal: a unit vector.
std::shared_ptr<const Wall> around_slab(const Vec3d& point, const Vec3d& normal, double half_width);

/// What lies within all of its walls, and repeats with the cell, if there is one.
struct Vessel {
  CellEdges cell;  ///< or none
  Periodic periodic{};
  std::vector<std::shared_ptr<const Wall>> walls;
  /// A parallelepiped that holds it: of a periodic cell the cell.
  Vec3d corner;
  std::array<Vec3d, 3> edges{};

  double frame_volume() const { return dot(edges[0], cross(edges[1], edges[2])); }
  Vec3d at(const Vec3d& parts) const {
    return corner + parts.x * edges[0] + parts.y * edges[1] + parts.z * edges[2];
  }
  /// Of the place in the cell that repeats as this one.
  Vec3d in_cell(const Vec3d& r) const;
  /// Distance from the nearest wall; infinite if there is none.
  double depth(const Vec3d& r) const;
  void feel(const Vec3d& r, double reach, std::vector<Feel>& out) const;
};

/// A box with six walls along the axes, and others that hold in full what a region of the kind holds.
void add_box(Vessel& vessel, const Vec3d& min, const Vec3d& max);
void add_cylinder(Vessel& vessel, const Vec3d& from, const Vec3d& to, double radius);
void set_frame(Vessel& vessel, const BoundingBox& box);

/// The volume that is deeper than `depth` >= 0, by parts that are halved where a wall passes through them, to
/// about 1e-5 of it.  [length^3]
double volume_deeper_than(const Vessel& vessel, double depth);
/// The radius of the largest sphere that has room, to about a hundredth; infinite without walls. The shortest
/// way to an image of the cell limits it, too.
double largest_radius(const Vessel& vessel);

}  // namespace vbond::packing
