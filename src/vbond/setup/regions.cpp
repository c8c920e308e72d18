#include "vbond/setup/regions.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

#include "vbond/setup/mesh_file.hpp"
#include "vbond/setup/mesh_inside.hpp"
#include "vbond/setup/text_file.hpp"

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

/// What is told of surfaces where there are several.
std::string text_of(const MeshInside& inside) {
  if (inside.surfaces() == 1) return "";
  std::string text = fmt::format("; {} closed surfaces", inside.surfaces());
  if (inside.crossing() > 0)
    text +=
        fmt::format(", of which {} cross others and hold together what any of them holds", inside.crossing());
  if (inside.within_others() > 0)
    text += fmt::format(", of which {} lie within others and bound hollows", inside.within_others());
  return text;
}

}  // namespace

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

ClosedMesh closed_mesh(const MeshRegion& region, const RegionOwner& owner) {
  const auto file = beside_case(owner.case_file, region.file.value);
  const MeshFile read = read_mesh_file(file, region.scale, region.shift, region.file.place);
  if (read.unpaired_edges > 0)
    throw CaseError({region.file.place,
                     fmt::format("{}: \"{}\" has {} open edges", owner.name, region.file.value.string(),
                                 read.unpaired_edges),
                     "only closed surfaces have an inside",
                     "close the holes of the mesh, or use another region"});
  TriangleMesh surface = read.surface();
  const auto inside = std::make_shared<const MeshInside>(surface);
  if (inside->is_ambiguous())
    throw CaseError(
        {region.file.place,
         fmt::format("{}: closed surfaces of \"{}\" meet in common edges, and their triangles face both ways",
                     owner.name, region.file.value.string()),
         "nothing tells which of their sides belong together, so that they may cross",
         "let all triangles face outwards, or use a file for each part"});
  owner.notes.push_back(
      fmt::format("{}: {}: {}", owner.name, region.file.value.filename().string(), read.text()) +
      text_of(*inside));
  return {std::move(surface), inside};
}

Inside inside_of(const MeshRegion& region, const RegionOwner& owner) {
  return [inside = closed_mesh(region, owner).inside](const Vec3d& r) { return (*inside)(r); };
}

}  // namespace vbond
