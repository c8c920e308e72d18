#include "vbond/model/mesh_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>
#include <type_traits>
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

/// The closest point, which goes along its edge as the centre moves.
template <Scalar T>
Vec3<T> MeshSurface::foot(std::uint32_t triangle, const TrianglePoint& p, const Vec3<T>& centre) const {
  const Vec3<T> there = constant<T>(p.r);
  const auto part = static_cast<std::size_t>(p.part);
  if (std::is_same_v<T, double> || part < 3 || p.part == TrianglePart::face) return there;
  const Corners& t = corners_[triangle];
  const Vec3d corners[] = {t.a, t.b, t.c};
  const Vec3<T> along = constant<T>(normalised(corners[(part - 2) % 3] - corners[part - 3]));
  return there + dot(centre - constant<T>(plain(centre)), along) * along;
}

template <Scalar T>
WallTouchOf<T> MeshSurface::touch(std::uint32_t triangle, const TrianglePoint& p,
                                  const Vec3<T>& centre) const {
  const Vec3<T> away = centre - foot(triangle, p, centre), normal = constant<T>(normal_[triangle]);
  const T height = dot(normal, centre - constant<T>(corners_[triangle].a));
  if (p.part == TrianglePart::face || plain(norm2(away)) == 0.0) {
    const bool behind = plain(height) < 0.0;
    return {behind ? -normal : normal, behind ? -height : height};
  }
  const T distance = norm(away);
  return {away / distance, distance};
}

template <Scalar T>
void MeshSurface::touches_of(std::span<const std::uint32_t> triangles, const Vec3<T>& centre, double reach,
                             std::vector<WallTouchOf<T>>& out) const {
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  const Vec3d here = plain(centre);
  const auto arm = [](const WallTouchOf<T>& t) { return plain(t.distance) * plain(t.normal); };
  WallTouchOf<T> nearest;
  nearest.distance = T(std::numeric_limits<double>::infinity());
  for (const std::uint32_t triangle : triangles) {
    const TrianglePoint p = closest(triangle, here);
    const WallTouchOf<T> t = touch(triangle, p, centre);
    if (!(plain(t.distance) < reach)) continue;
    if (plain(t.distance) < plain(nearest.distance)) nearest = t;
    if (!is_nearest_of_its_part(triangle, p, here)) continue;
    const auto same = std::find_if(out.begin() + first, out.end(), [&](const WallTouchOf<T>& other) {
      return norm2(arm(other) - arm(t)) < sq(same_point * reach);
    });
    if (same == out.end())
      out.push_back(t);
    else if (plain(t.distance) < plain(same->distance))
      *same = t;
  }
  // The nearest of all counts by the rule, also where needles of triangles disagree on what is nearer.
  if (out.begin() + first == out.end() && plain(nearest.distance) < reach) out.push_back(nearest);
}

template void MeshSurface::touches_of(std::span<const std::uint32_t>, const Vec3d&, double,
                                      std::vector<WallTouch>&) const;
template void MeshSurface::touches_of(std::span<const std::uint32_t>, const Vec3<Dual<3>>&, double,
                                      std::vector<MovedWallTouch>&) const;

}  // namespace vbond
