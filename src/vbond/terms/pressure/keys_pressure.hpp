#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/case/region_spec.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/terms/pressure/term_pressure.hpp"

namespace vbond {

/// What the facets of a pressure are made of.
enum class PressedSurface : std::uint8_t { strips, triangles, skin };

/// Where facets count.
struct FacetRegion {
  SourcePlace place;
  Region region;
};

/// A pressure in a stage, as the user wrote it; see case.hpp.
struct PressureSpec {
  SourcePlace place;
  PressedSurface surface = PressedSurface::skin;
  Placed<std::string> group;
  double pressure = 0;
  PressureKind kind = PressureKind::follower;
  Vec3d centre;                                         ///< central
  double width = 0;                                     ///< strips
  Vec3d normal{0, 0, 1};                                ///< strips
  std::optional<Placed<std::filesystem::path>> file{};  ///< triangles: their particles
  std::optional<Vec3d> inside{};                        ///< strips and triangles
  std::optional<double> longest{};                      ///< skin: largest radius of a sphere that is filled
  std::optional<FacetRegion> region{};
  TimeFunctionSpec factor;  ///< dynamics
  bool constant = false;    ///< static stages
};

template <>
struct SpecPart<PressureTerm> {
  std::vector<PressureSpec> pressures;  ///< all kinds
  bool any() const { return !pressures.empty(); }
  bool grows() const {
    return std::any_of(pressures.begin(), pressures.end(), [](const PressureSpec& p) { return !p.constant; });
  }
};

namespace keys {
class Table;
/// Keys of a stage of this kind; those of every kind if it is not known.
void describe(Table& t, PressureSpec& s, std::optional<StageKind> kind);
void describe(Table& t, FacetRegion& r);
}  // namespace keys

}  // namespace vbond
