#include "vbond/build/regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "vbond/build/mesh_file.hpp"
#include "vbond/build/text_file.hpp"

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

MeshInside::MeshInside(TriangleMesh mesh) : mesh_(std::move(mesh)), box_(box_around(mesh_.corners)) {
  const std::size_t triangles = mesh_.triangles.size();
  std::size_t count = triangles, entries = 0;
  do {  // as many strips as leave a triangle in four of them at most, on average
    count = std::max<std::size_t>(count / 2, 1);
    strips_.assign(count, {});
    entries = 0;
    for (const auto& t : mesh_.triangles) entries += strips_of(t)[1] - strips_of(t)[0] + 1;
  } while (count > 1 && entries > 4 * triangles);
  for (std::size_t k = 0; k < triangles; ++k) {
    const auto [first, last] = strips_of(mesh_.triangles[k]);
    for (std::size_t s = first; s <= last; ++s) strips_[s].push_back(static_cast<std::uint32_t>(k));
  }
}

/// The first one for a mesh without width, of which y makes no part.
std::size_t MeshInside::strip_of(double y) const {
  const double part = (y - box_.low.y) / (box_.high.y - box_.low.y), n = static_cast<double>(strips_.size());
  return static_cast<std::size_t>(std::min(std::max(0.0, part * n), n - 1.0));
}

std::array<std::size_t, 2> MeshInside::strips_of(const std::array<std::uint32_t, 3>& triangle) const {
  const auto [low, high] =
      std::minmax({mesh_.corners[triangle[0]].y, mesh_.corners[triangle[1]].y, mesh_.corners[triangle[2]].y});
  return {strip_of(low), strip_of(high)};
}

bool MeshInside::operator()(const Vec3d& r) const {
  if (!is_between(box_.low, r, box_.high)) return false;
  bool inside = false;
  for (const std::uint32_t k : strips_[strip_of(r.y)]) {
    const auto& t = mesh_.triangles[k];
    const Vec3d &a = mesh_.corners[t[0]], &b = mesh_.corners[t[1]], &c = mesh_.corners[t[2]];
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
  return [inside = std::make_shared<const MeshInside>(read.mesh)](const Vec3d& r) { return (*inside)(r); };
}

}  // namespace vbond
