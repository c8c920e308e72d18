#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/time_function.hpp"

namespace vbond {

/// What pressure acts on: the triangle of three particles, or a strip along two, with k = i. A triangle has
/// the vector area 1/2 (r_j - r_i) x (r_k - r_i), a strip (r_j - r_i) x `across`: they point outwards, from
/// where a pressure > 0 comes. Each of its particles gets an equal part.
struct Facet {
  ParticleId i, j, k;
  bool is_strip() const { return k == i; }
  double corners() const { return is_strip() ? 2.0 : 3.0; }
  friend bool operator==(const Facet&, const Facet&) = default;
};

/// A facet of a stage that is under way, and its area as the stage began.
struct PressedFacet {
  std::uint32_t pressure = 0;  ///< which one of the stage
  ParticleId i, j, k;
  Vec3d area;     ///< [length^2]
  Vec3d towards;  ///< of central pressures: how far the parts of i, j, k point to the centre  [length^2]
  Facet facet() const { return {i, j, k}; }
  friend bool operator==(const PressedFacet&, const PressedFacet&) = default;
};

/// follower: along the areas of now. dead: the forces stay those of the start. central: the parts
/// of these that point to a fixed place keep their sizes, and follow the way to it.
enum class PressureKind : std::uint8_t { follower, dead, central };

/// A pressure on facets, which stay the same in a stage and follow their particles.
struct Pressure {
  std::string group = {};          ///< name, for reports
  std::vector<Facet> facets = {};  ///< empty in a stage that is under way: the state has them
  double pressure = 0;             ///< > 0: inwards  [force/length^2]
  TimeFunction factor = {};
  bool constant = false;  ///< at rest: at full size from the start, not in proportion to the load factor
  PressureKind kind = PressureKind::follower;
  Vec3d centre = {};  ///< of central ones  [length]
  Vec3d across = {};  ///< of strips: their width times the unit normal of the plane that they are normal to
};

}  // namespace vbond
