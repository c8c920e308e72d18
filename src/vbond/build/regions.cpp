#include "vbond/build/regions.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "vbond/build/mesh_file.hpp"
#include "vbond/build/text_file.hpp"
#include "vbond/core/bounding_box.hpp"

namespace vbond {
namespace {

bool is_between(const Vec3d& min, const Vec3d& r, const Vec3d& max) {
  return min.x <= r.x && r.x <= max.x && min.y <= r.y && r.y <= max.y && min.z <= r.z && r.z <= max.z;
}

Vec3d unit_normal(const Vec3d& normal, const RegionOwner& owner) {
  if (!(norm(normal) > 0.0))
    throw CaseError({owner.place, fmt::format("the normal of {} is zero", owner.name),
                     "it says which way the plane faces", "use for instance normal = [0, 0, 1]"});
  return normalised(normal);
}

/// Seen along z: whether the line y = r.y from r towards +x crosses the edge. Of both ends the lower one is
/// taken first, so that the two triangles of an edge get the same answer, rounding included.
bool crosses(const Vec3d& r, const Vec3d& a, const Vec3d& b) {
  if ((a.y > r.y) == (b.y > r.y)) return false;
  const Vec3d &low = a.y < b.y ? a : b, &high = a.y < b.y ? b : a;
  return (high.x - low.x) * (r.y - low.y) > (r.x - low.x) * (high.y - low.y);
}

}  // namespace

bool is_inside(const TriangleMesh& mesh, const Vec3d& r) {
  bool inside = false;
  for (const auto& t : mesh.triangles) {
    const Vec3d &a = mesh.corners[t[0]], &b = mesh.corners[t[1]], &c = mesh.corners[t[2]];
    const bool above_or_below = crosses(r, a, b) ^ crosses(r, b, c) ^ crosses(r, c, a);
    if (!above_or_below) continue;
    const Vec3d n = cross(b - a, c - a);
    const double side = dot(n, a - r);  // of the plane; the ray goes along +z
    if (n.z > 0.0 ? side > 0.0 : side < 0.0) inside = !inside;
  }
  return inside;
}

Inside inside_of(const BoxRegion& region, const RegionOwner&) {
  return [=](const Vec3d& r) { return is_between(region.min, r, region.max); };
}

Inside inside_of(const SphereRegion& region, const RegionOwner&) {
  return [=](const Vec3d& r) { return norm(r - region.centre) <= region.radius; };
}

Inside inside_of(const CylinderRegion& region, const RegionOwner& owner) {
  const Vec3d axis = region.to - region.from;
  const double length = norm(axis);
  if (!(length > 0.0))
    throw CaseError({owner.place, fmt::format("the cylinder of {} has no length", owner.name),
                     "its axis goes from the middle of one end to that of the other",
                     "give two different points"});
  const Vec3d e = axis / length;
  return [=](const Vec3d& r) {
    const Vec3d d = r - region.from;
    const double along = dot(d, e);
    return 0.0 <= along && along <= length && norm(d - along * e) <= region.radius;
  };
}

Inside inside_of(const PlaneRegion& region, const RegionOwner& owner) {
  const Vec3d n = unit_normal(region.normal, owner);
  return [=](const Vec3d& r) { return std::abs(dot(r - region.point, n)) <= region.within; };
}

Inside inside_of(const HalfSpaceRegion& region, const RegionOwner& owner) {
  const Vec3d n = unit_normal(region.normal, owner);
  return [=](const Vec3d& r) { return dot(r - region.point, n) <= 0.0; };
}

Inside inside_of(const MeshRegion& region, const RegionOwner& owner) {
  const auto file = beside_case(owner.case_file, region.file.value);
  const MeshFile read = read_mesh_file(file, region.scale, region.shift, region.file.place);
  if (read.open_edges > 0)
    throw CaseError(
        {region.file.place,
         fmt::format("{}: \"{}\" has {} open edges", owner.name, region.file.value.string(), read.open_edges),
         "only closed surfaces have an inside", "close the holes of the mesh, or use another region"});
  const BoundingBox box = box_around(read.mesh.corners);
  return [mesh = std::make_shared<const TriangleMesh>(read.mesh), box](const Vec3d& r) {
    return is_between(box.low, r, box.high) && is_inside(*mesh, r);
  };
}

}  // namespace vbond
