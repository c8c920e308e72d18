#include "vbond/model/mesh_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "vbond/core/scalar.hpp"

namespace vbond {
namespace {

/// Of the largest coordinate: closest points carry some roundings of it.
constexpr double roundings = 1e-13;

using Three = std::array<std::uint32_t, 3>;

/// Numbers the edges from 0 in the order of their corners.
std::pair<std::vector<Three>, std::size_t> number_edges(const std::vector<Three>& triangles) {
  struct Edge {
    std::uint32_t low, high, triangle, k;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      edges.push_back({low, high, t, k});
    }
  const auto key = [](const Edge& e) { return std::pair(e.low, e.high); };
  std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
  std::vector<Three> ids(triangles.size());
  std::uint32_t count = 0;
  for (std::size_t n = 0; n < edges.size(); ++n) {
    if (n == 0 || key(edges[n]) != key(edges[n - 1])) ++count;
    ids[edges[n].triangle][edges[n].k] = count - 1;
  }
  return {std::move(ids), count};
}

}  // namespace

MeshSurface::MeshSurface(const TriangleMesh& mesh) : tree_(mesh), corner_id_(mesh.triangles) {
  for (const auto& [a, b, c] : mesh.triangles) {
    corners_.push_back({mesh.corners[a], mesh.corners[b], mesh.corners[c]});
    const Corners& r = corners_.back();
    normal_.push_back(normalised(cross(r.b - r.a, r.c - r.a)));
    for (const Vec3d& p : {r.a, r.b, r.c})
      rounding_ = std::max({rounding_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  rounding_ *= roundings;
  const auto gather = [](const std::vector<Three>& ids, std::size_t count) {
    Holders h;
    h.first.assign(count + 1, 0);
    for (const Three& three : ids)
      for (const std::uint32_t k : three) ++h.first[k + 1];
    std::partial_sum(h.first.begin(), h.first.end(), h.first.begin());
    h.triangles.resize(3 * ids.size());
    std::vector<std::uint32_t> next = h.first;
    for (std::uint32_t t = 0; t < ids.size(); ++t)
      for (const std::uint32_t k : ids[t]) h.triangles[next[k]++] = t;
    return h;
  };
  of_corner_ = gather(corner_id_, mesh.corners.size());
  std::size_t edges = 0;
  std::tie(edge_id_, edges) = number_edges(mesh.triangles);
  of_edge_ = gather(edge_id_, edges);
}

TrianglePoint MeshSurface::closest(std::uint32_t triangle, const Vec3d& r) const {
  const Corners& t = corners_[triangle];
  return closest_on_triangle(r, t.a, t.b, t.c);
}

/// A triangle is convex and holds p: if its closest point is another one, that is nearer, even where the
/// distances are equal to rounding.
bool MeshSurface::is_nearest_of_its_part(std::uint32_t triangle, const TrianglePoint& p,
                                         const Vec3d& centre) const {
  if (p.part == TrianglePart::face) return true;
  const auto part = static_cast<std::size_t>(p.part);
  const auto holders =
      part < 3 ? of_corner_.of(corner_id_[triangle][part]) : of_edge_.of(edge_id_[triangle][part - 3]);
  return std::none_of(holders.begin(), holders.end(), [&](std::uint32_t other) {
    return other != triangle && norm2(closest(other, centre).r - p.r) > sq(rounding_);
  });
}

WallTouch MeshSurface::touch(std::uint32_t triangle, const TrianglePoint& p, const Vec3d& centre) const {
  const Vec3d away = centre - p.r;
  const double height = dot(normal_[triangle], centre - corners_[triangle].a);
  if (p.part == TrianglePart::face || norm2(away) == 0.0)
    return {height < 0.0 ? -normal_[triangle] : normal_[triangle], std::abs(height)};
  const double distance = norm(away);
  return {away / distance, distance};
}

void MeshSurface::touches_of(std::span<const std::uint32_t> triangles, const Vec3d& centre, double reach,
                             std::vector<WallTouch>& out) const {
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  WallTouch nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  for (const std::uint32_t triangle : triangles) {
    const TrianglePoint p = closest(triangle, centre);
    const WallTouch t = touch(triangle, p, centre);
    if (!(t.distance < reach)) continue;
    if (t.distance < nearest.distance) nearest = t;
    if (!is_nearest_of_its_part(triangle, p, centre)) continue;
    const auto same = std::find_if(out.begin() + first, out.end(), [&](const WallTouch& other) {
      return norm2(other.distance * other.normal - t.distance * t.normal) < sq(same_point * reach);
    });
    if (same == out.end())
      out.push_back(t);
    else if (t.distance < same->distance)
      *same = t;
  }
  // The nearest of all counts by the rule, also where needles of triangles disagree on what is nearer.
  if (out.begin() + first == out.end() && nearest.distance < reach) out.push_back(nearest);
}

}  // namespace vbond
