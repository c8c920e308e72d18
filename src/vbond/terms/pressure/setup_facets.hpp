#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/state.hpp"
#include "vbond/terms/pressure/pressure.hpp"

namespace vbond {

/// Facets, or why there are none.
struct FoundFacets {
  std::vector<Facet> facets;
  std::string what, way_out;  ///< empty: all is well
};

/// Strips along the bonds between these particles, those of a chain one after the other.
FoundFacets strips_of(const State& state, const std::vector<char>& in_group);
/// Triangles of three bonds between these particles.
FoundFacets triangles_of(const State& state, const std::vector<char>& in_group);
/// Turns triangles about so that neighbours face the same way.
FoundFacets facing_alike(std::vector<Facet> triangles);

/// Turns parts of a surface about whose nearest facet faces this point, or without one, which only closed
/// parts may be, those that face their inside. A point in the plane of the nearest facet has no side.
FoundFacets facing_away(std::vector<Facet> facets, const Vec3d& across, const std::optional<Vec3d>& inside,
                        const PerParticle<Vec3d>& r);

}  // namespace vbond
