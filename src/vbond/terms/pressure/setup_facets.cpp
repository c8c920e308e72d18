#include "vbond/terms/pressure/setup_facets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "vbond/core/disjoint_sets.hpp"
#include "vbond/core/segments.hpp"
#include "vbond/core/triangle_tree.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond {
namespace {

using FacetId = Id<struct FacetTag>;
using FacetEdge = std::pair<ParticleId, ParticleId>;

/// The particles to which each is bonded, in increasing order, each once.
PerParticle<std::vector<ParticleId>> bonded_to(const State& state, const std::vector<char>& in_group) {
  PerParticle<std::vector<ParticleId>> near(state.r.size());
  for (const Bond& b : state.bonds)
    if (!b.broken && in_group[b.i.value] != 0 && in_group[b.j.value] != 0)
      near[b.i].push_back(b.j), near[b.j].push_back(b.i);
  for (auto& n : near) {
    std::sort(n.begin(), n.end());
    n.erase(std::unique(n.begin(), n.end()), n.end());
  }
  return near;
}

std::array<FacetEdge, 3> edges_of(const Facet& f) {
  return {FacetEdge{f.i, f.j}, FacetEdge{f.j, f.k}, FacetEdge{f.k, f.i}};
}

/// Facets of one part share particles, triangles edges.
std::vector<std::vector<std::size_t>> parts_of(const std::vector<Facet>& facets) {
  DisjointSets<FacetId> sets(facets.size());
  std::map<FacetEdge, FacetId> seen;
  for (std::size_t k = 0; k < facets.size(); ++k) {
    const Facet& f = facets[k];
    const std::array<FacetEdge, 3> edges =
        f.is_strip() ? std::array<FacetEdge, 3>{FacetEdge{f.i, f.i}, {f.j, f.j}, {f.i, f.i}} : edges_of(f);
    for (const auto& [p, q] : edges) {
      const auto [at, is_new] = seen.try_emplace(std::minmax(p, q), FacetId{k});
      if (!is_new) sets.join(at->second, FacetId{k});
    }
  }
  std::map<FacetId, std::vector<std::size_t>> parts;
  for (std::size_t k = 0; k < facets.size(); ++k) parts[sets.smallest(FacetId{k})].push_back(k);
  std::vector<std::vector<std::size_t>> all;
  for (auto& [first, part] : parts) all.push_back(std::move(part));
  return all;
}

void turn_about(Facet& f) {
  if (f.is_strip())
    f = {f.j, f.i, f.j};
  else
    std::swap(f.j, f.k);
}

}  // namespace

FoundFacets strips_of(const State& state, const std::vector<char>& in_group) {
  const PerParticle<std::vector<ParticleId>> near = bonded_to(state, in_group);
  FoundFacets found;
  for (const ParticleId p : near.ids())
    if (near[p].size() > 2)
      return {{},
              fmt::format("particle {} has {} bonds in the group", p.value, near[p].size()),
              "name a group whose bonds form chains or rings, or use surface = \"triangles\" or \"skin\""};
  PerParticle<char> visited(near.size(), 0);
  const auto walk = [&](ParticleId first) {
    ParticleId at = first;
    visited[at] = 1;
    for (bool on = true; on;) {
      on = false;
      for (const ParticleId next : near[at])
        if (visited[next] == 0) {
          found.facets.push_back({at, next, at});
          visited[at = next] = 1;
          on = true;
          break;
        }
    }
    if (near[at].size() == 2 && std::binary_search(near[at].begin(), near[at].end(), first))
      found.facets.push_back({at, first, at});
  };
  for (const std::size_t ends : {1, 2})  // chains, then rings
    for (const ParticleId p : near.ids())
      if (visited[p] == 0 && near[p].size() == ends) walk(p);
  if (found.facets.empty())
    return {{}, "the group has no bonds", "name a group that is bonded as the stage begins"};
  return found;
}

FoundFacets triangles_of(const State& state, const std::vector<char>& in_group) {
  const PerParticle<std::vector<ParticleId>> near = bonded_to(state, in_group);
  FoundFacets found;
  for (const ParticleId i : near.ids())
    for (const ParticleId j : near[i])
      for (const ParticleId k : near[j])
        if (i < j && j < k && std::binary_search(near[i].begin(), near[i].end(), k))
          found.facets.push_back({i, j, k});
  if (found.facets.empty())
    return {{},
            "no three of its bonds form a triangle",
            "name a group with a triangular lattice, or give the triangles by a file"};
  return found;
}

FoundFacets facing_alike(std::vector<Facet> triangles) {
  std::map<FacetEdge, std::vector<std::size_t>> at_edge;
  for (std::size_t k = 0; k < triangles.size(); ++k)
    for (const auto& [p, q] : edges_of(triangles[k])) at_edge[std::minmax(p, q)].push_back(k);
  constexpr const char* way_out =
      "a surface has two triangles at an edge: give those that are pressed by a file";
  for (const auto& [edge, at] : at_edge)
    if (at.size() > 2)
      return {{},
              fmt::format("{} triangles meet at the edge of particles {} and {}", at.size(), edge.first.value,
                          edge.second.value),
              way_out};
  const auto runs = [](const Facet& f, const FacetEdge& edge) {
    const auto edges = edges_of(f);
    return std::find(edges.begin(), edges.end(), edge) != edges.end();
  };
  std::vector<char> done(triangles.size(), 0);
  for (std::size_t first = 0; first < triangles.size(); ++first) {
    if (done[first] != 0) continue;
    std::vector<std::size_t> next{first};
    done[first] = 1;
    while (!next.empty()) {
      const std::size_t k = next.back();
      next.pop_back();
      for (const FacetEdge& edge : edges_of(triangles[k]))
        for (const std::size_t other : at_edge.at(std::minmax(edge.first, edge.second))) {
          if (other == k) continue;
          const bool against = !runs(triangles[other], edge);
          if (done[other] != 0 && !against)
            return {{},
                    fmt::format("the surface has one side only, as seen at the edge of particles {} and {}",
                                edge.first.value, edge.second.value),
                    way_out};
          if (done[other] != 0) continue;
          if (!against) turn_about(triangles[other]);
          done[other] = 1;
          next.push_back(other);
        }
    }
  }
  return {std::move(triangles), {}, {}};
}

namespace {

/// From a point to the nearest one of a facet, and how much of the surface around that the facet makes up.
struct WayToFacet {
  Vec3d way;
  double share = 1;
};
WayToFacet way_to(const Facet& f, const Vec3d& i, const Vec3d& j, const Vec3d& k) {
  if (f.is_strip()) return {on_segment(i, j, nearest_on_segment({}, i, j))};
  const TrianglePoint nearest = closest_on_triangle({}, i, j, k);
  const auto angle = [](const Vec3d& at, const Vec3d& p, const Vec3d& q) {
    return std::atan2(norm(cross(p - at, q - at)), dot(p - at, q - at));
  };
  using enum TrianglePart;
  switch (nearest.part) {
    case face: return {nearest.r, 2.0 * std::numbers::pi};
    case corner_0: return {nearest.r, angle(i, j, k)};
    case corner_1: return {nearest.r, angle(j, k, i)};
    case corner_2: return {nearest.r, angle(k, i, j)};
    default: return {nearest.r, std::numbers::pi};
  }
}

/// Whether the facet that is nearest to a point faces away from it: > 0, up to 1, or faces it: < 0. Where
/// several are, at a corner or an edge, each counts by its angle: that is the side of a closed surface on
/// which the point is (Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243).
double side_of(const std::vector<Facet>& part, const Vec3d& across, const Vec3d& point,
               const PerParticle<Vec3d>& r) {
  const Vec3d normal = norm2(across) > 0.0 ? normalised(across) : Vec3d{};
  const auto at = [&](ParticleId p) {
    const Vec3d way = between(point, r[p]);
    return way - dot(way, normal) * normal;  // strips have no end along it
  };
  constexpr double alike = 1.0 + 1e-9;
  double nearest = std::numeric_limits<double>::infinity(), sum = 0.0, shares = 0.0;
  std::vector<WayToFacet> ways;
  for (const Facet& f : part) {
    ways.push_back(way_to(f, at(f.i), at(f.j), at(f.k)));
    nearest = std::min(nearest, norm(ways.back().way));
  }
  if (!(nearest > 0.0)) return 0.0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const double distance = norm(ways[k].way);
    if (!(distance <= alike * nearest)) continue;
    sum += ways[k].share * dot(normalised(area_of(part[k], across, at)), ways[k].way) / distance;
    shares += ways[k].share;
  }
  return sum / shares;
}

/// The volume that a closed part encloses, as a part of what its facets make up: the sum of area . place.
double inside_of_closed(const std::vector<Facet>& part, const Vec3d& across, const PerParticle<Vec3d>& r) {
  const Vec3d& point = r[part.front().i];
  double sum = 0.0, size = 0.0;
  for (const Facet& f : part) {
    const Vec3d area = area_of(f, across, [&r](ParticleId p) { return r[p]; });
    Vec3d middle = between(point, r[f.i]) + between(point, r[f.j]);
    if (!f.is_strip()) middle += between(point, r[f.k]);
    sum += dot(area, middle) / f.corners();
    size += norm(area) * norm(middle) / f.corners();
  }
  return size > 0.0 ? sum / size : 0.0;
}

}  // namespace

FoundFacets facing_away(std::vector<Facet> facets, const Vec3d& across, const std::optional<Vec3d>& inside,
                        const PerParticle<Vec3d>& r) {
  constexpr double flat = 1e-6;
  for (const std::vector<std::size_t>& part : parts_of(facets)) {
    std::vector<Facet> of_part;
    for (const std::size_t k : part) of_part.push_back(facets[k]);
    const std::string at = fmt::format("the part of the surface with particle {}", of_part.front().i.value);
    if (!inside && !is_closed(of_part))
      return {{},
              at + " has free edges: nothing tells its two sides apart",
              "give inside = [x, y, z], a point on the side to which a pressure > 0 pushes"};
    const double away = inside ? side_of(of_part, across, *inside, r) : inside_of_closed(of_part, across, r);
    if (!(std::abs(away) > flat))
      return {{},
              at + (inside ? " has no side that faces the point inside" : " encloses nothing"),
              inside ? "choose a point that lies clearly on one side of the facet that is nearest to it"
                     : "correct `normal`, or give inside = [x, y, z]"};
    if (away < 0.0)
      for (const std::size_t k : part) turn_about(facets[k]);
  }
  return {std::move(facets), {}, {}};
}

}  // namespace vbond
