#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/core/vec3.hpp"

/// Regions of space and groups of particles as the user wrote them; see case.hpp. Regions include their
/// boundary. Vectors of a direction have any length but zero.
namespace vbond {

struct BoxRegion {
  Vec3d min, max;
};
struct SphereRegion {
  Vec3d centre;
  double radius = 0;
};
struct CylinderRegion {  ///< with flat ends
  Vec3d from, to;        ///< of its axis; they differ
  double radius = 0;
};
struct PlaneRegion {
  Vec3d point, normal;
  double within = 0;
};  ///< |(r - point).n| <= within
struct HalfSpaceRegion {
  Vec3d point, normal;
};                                     ///< (r - point).n <= 0
struct MeshRegion {                    ///< the inside of closed surfaces
  Placed<std::filesystem::path> file;  ///< relative to the case file
  double scale = 1.0;
  Vec3d shift;  ///< after scaling
};
using Region =
    std::variant<BoxRegion, SphereRegion, CylinderRegion, PlaneRegion, HalfSpaceRegion, MeshRegion>;

using IndexList = std::vector<std::int64_t>;  ///< particle numbers from 0
struct MaterialGroup {
  Placed<std::string> material;
};
struct TypeGroup {
  std::int64_t type = 0;  ///< of the atoms of LAMMPS data files
};
struct FibreGroup {
  std::vector<std::int64_t> fibres;  ///< numbers of fibres within their specimen
};
struct UnionGroup {
  std::vector<Placed<std::string>> groups;
};
struct IntersectionGroup {
  std::vector<Placed<std::string>> groups;
};
struct DifferenceGroup {
  Placed<std::string> of;
  std::vector<Placed<std::string>> without;
};

struct GroupSpec {
  SourcePlace place;
  std::string name;
  std::variant<IndexList, BoxRegion, SphereRegion, CylinderRegion, PlaneRegion, HalfSpaceRegion, MeshRegion,
               MaterialGroup, TypeGroup, FibreGroup, UnionGroup, IntersectionGroup, DifferenceGroup>
      region;
};

// ---- what is done with the points of a specimen, in this order ---------------------------------------

struct CutSpec {
  enum class Keep : std::uint8_t { outside, inside };
  SourcePlace place;
  Region region;
  Keep keep = Keep::outside;  ///< which particles stay
};
struct TurnSpec {
  Vec3d axis{0, 0, 1};
  double angle = 0;  ///< [rad]
  Vec3d about;       ///< a point of the axis
};
struct CopiesSpec {
  std::int64_t count = 1;  ///< with the first
  Vec3d step;              ///< from one to the next
};

}  // namespace vbond
