#include "vbond/setup/mesh_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "vbond/core/column.hpp"
#include "vbond/core/disjoint_sets.hpp"
#include "vbond/core/scalar.hpp"
#include "vbond/setup/mesh_corners.hpp"

namespace vbond {
namespace {

using TriangleId = Id<struct TriangleTag>;
using Points = std::array<Vec3d, 3>;

Points points_of(const TriangleMesh& mesh, std::size_t k) {
  const auto& [a, b, c] = mesh.triangles[k];
  return {mesh.corners[a], mesh.corners[b], mesh.corners[c]};
}

/// Where a triangle meets the plane of another one: the ends of what they have in common, along a line.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

/// Nothing unless the triangle reaches by more than `same` to both sides of the plane.
bool cut_by_plane(const Points& t, const Vec3d& point, const Vec3d& normal, const Vec3d& along, double same,
                  Interval& cut) {
  std::array<double, 3> d;
  for (std::size_t k = 0; k < 3; ++k) d[k] = dot(t[k] - point, normal);
  const auto [low, high] = std::minmax({d[0], d[1], d[2]});
  if (!(low < -same && high > same)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t n = (k + 1) % 3;
    if ((d[k] > 0.0) == (d[n] > 0.0)) continue;
    const double x = dot(t[k] + (d[k] / (d[k] - d[n])) * (t[n] - t[k]) - point, along);
    cut.low = std::min(cut.low, x), cut.high = std::max(cut.high, x);
  }
  return true;
}

/// Whether two triangles cross along a line: each goes through the other, farther than `same` each way.
bool cross_each_other(const Points& s, const Points& t, double same) {
  const Vec3d m = normalised(cross(s[1] - s[0], s[2] - s[0])),
              n = normalised(cross(t[1] - t[0], t[2] - t[0]));
  const Vec3d line = cross(m, n);
  if (!(norm(line) > 0.0)) return false;
  const Vec3d along = normalised(line);
  Interval a, b;
  if (!cut_by_plane(s, t[0], n, along, same, a) || !cut_by_plane(t, s[0], m, along, same, b)) return false;
  const double shift = dot(s[0] - t[0], along);  // `along` is measured from t[0] in a, from s[0] in b
  return std::min(a.high, b.high + shift) - std::max(a.low, b.low + shift) > same;
}

struct Edge {
  std::uint32_t low, high, triangle;
  int sense;  ///< 1 from low to high in its triangle
  auto ends() const { return std::tie(low, high); }
};

/// Calls work for each edge with what its triangles have of it.
template <class Work>
void for_each_edge(const TriangleMesh& mesh, Work&& work) {
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), t, from < to ? 1 : -1});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  for (std::size_t n = 0, first = 0; n < edges.size(); first = n) {
    while (n < edges.size() && edges[n].ends() == edges[first].ends()) ++n;
    work(std::span<const Edge>(edges).subspan(first, n - first));
  }
}

bool overlap(const BoundingBox& a, const BoundingBox& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

}  // namespace

bool face_alike(const TriangleMesh& mesh) {
  bool alike = true;
  for_each_edge(mesh, [&](std::span<const Edge> edge) {
    int sum = 0;
    for (const Edge& e : edge) sum += e.sense;
    alike = alike && sum == 0;
  });
  return alike;
}

bool has_crowded_edge(const TriangleMesh& mesh) {
  bool crowded = false;
  for_each_edge(mesh, [&](std::span<const Edge> edge) { crowded = crowded || edge.size() > 2; });
  return crowded;
}

std::vector<TriangleMesh> closed_parts(const TriangleMesh& mesh) {
  DisjointSets<TriangleId> sets(mesh.triangles.size());
  for_each_edge(mesh, [&](std::span<const Edge> edge) {
    if (edge.size() == 2) sets.join(TriangleId(edge[0].triangle), TriangleId(edge[1].triangle));
  });
  for (bool changed = true; changed;) {
    changed = false;
    for_each_edge(mesh, [&](std::span<const Edge> edge) {
      int whole = 0;
      std::map<TriangleId, std::pair<int, int>>
          of_set;  // how many triangles each has here, and the sum of their senses
      for (const Edge& e : edge) {
        auto& [count, sum] = of_set[sets.smallest(TriangleId(e.triangle))];
        ++count, sum += e.sense, whole += e.sense;
      }
      std::optional<TriangleId> first;
      for (const auto& [set, numbers] : of_set) {
        const auto& [count, sum] = numbers;
        if (whole == 0 ? sum == 0 : count % 2 == 0) continue;
        if (first) sets.join(*first, set), changed = true;
        if (!first) first = set;
      }
    });
  }
  std::vector<TriangleMesh> parts;
  std::vector<std::size_t> part_of(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t first = sets.smallest(TriangleId(t)).value;  // at most t
    if (first == t) part_of[t] = parts.size(), parts.emplace_back();
    parts[part_of[t] = part_of[first]].triangles.push_back(mesh.triangles[t]);
  }
  for (TriangleMesh& part : parts) take_corners(mesh.corners, part);
  return parts;
}

PositionFinder::PositionFinder(const std::vector<ClosedSurface>& surfaces, double same)
    : surfaces_(surfaces), same_(same) {
  for (const ClosedSurface& s : surfaces) trees_.emplace_back(s.mesh());
}

bool PositionFinder::some_triangles_cross(std::size_t i, std::size_t j) const {
  const TriangleMesh &one = surfaces_[i].mesh(), &other = surfaces_[j].mesh();
  std::vector<std::uint32_t> near;
  for (std::size_t k = 0; k < one.triangles.size(); ++k) {
    const Points s = points_of(one, k);
    BoundingBox box;
    for (const Vec3d& r : s) box.add(r);
    near.clear();
    trees_[j].near(0.5 * (box.low + box.high), 0.5 * box.diagonal() + same_, near);
    for (const std::uint32_t n : near)
      if (cross_each_other(s, points_of(other, n), same_)) return true;
  }
  return false;
}

/// On which sides of another surface corners and middles of triangles are, farther than `same` from it.
PositionFinder::Side PositionFinder::side_of(std::size_t i, std::size_t of) const {
  const TriangleMesh &one = surfaces_[i].mesh(), &other = surfaces_[of].mesh();
  Side side;
  std::vector<std::uint32_t> near;
  const auto look_at = [&](const Vec3d& r) {
    bool& found = surfaces_[of].holds(r) ? side.within : side.outside;
    if (found) return;
    near.clear();
    trees_[of].near(r, same_, near);
    found = std::none_of(near.begin(), near.end(), [&](std::uint32_t n) {
      const auto [a, b, c] = points_of(other, n);
      return norm(closest_on_triangle(r, a, b, c).r - r) < same_;
    });
  };
  for (std::size_t k = 0; k < one.triangles.size() && !(side.within && side.outside); ++k) {
    const auto [a, b, c] = points_of(one, k);
    look_at(a), look_at((a + b + c) / 3.0);
  }
  return side;
}

Position PositionFinder::operator()(std::size_t i, std::size_t j) const {
  if (!overlap(surfaces_[i].box(), surfaces_[j].box())) return Position::apart;
  const bool fewer = surfaces_[i].mesh().triangles.size() <= surfaces_[j].mesh().triangles.size();
  if (fewer ? some_triangles_cross(i, j) : some_triangles_cross(j, i)) return Position::crossing;
  const Side first = side_of(i, j), second = side_of(j, i);
  if ((first.within && first.outside) || (second.within && second.outside) || (first.within && second.within))
    return Position::crossing;
  if (first.within) return Position::first_within;
  if (second.within) return Position::second_within;
  return Position::apart;
}

}  // namespace vbond
