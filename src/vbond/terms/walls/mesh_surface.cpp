#include "vbond/terms/walls/mesh_surface.hpp"

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

struct Segment {
  Vec3d from, to;

  double length() const { return norm(to - from); }
  /// The part of the way, from 0 to 1, at the point closest to r.
  double part(const Vec3d& r) const {
    return std::clamp(dot(r - from, to - from) / norm2(to - from), 0.0, 1.0);
  }
  Vec3d at(double part) const { return from + part * (to - from); }
  Vec3d closest(const Vec3d& r) const { return at(part(r)); }
};

/// From each corner to the next.
std::array<Segment, 3> sides_of(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return {{{a, b}, {b, c}, {c, a}}};
}

double shortest(const std::array<Segment, 3>& sides) {
  return std::min({sides[0].length(), sides[1].length(), sides[2].length()});
}

/// What a seam is open by at most, as a part of its length.
constexpr double of_length = 0.05;

/// How far apart two segments are where they run beside each other; infinite where they do not.
double opening(const Segment& a, const Segment& b) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const double first = a.part(b.from), last = a.part(b.to), length = std::abs(last - first) * a.length();
  if (!(length > 0.0)) return none;
  const auto apart = [&](double part) { return norm(b.closest(a.at(part)) - a.at(part)); };
  const double widest = std::max(apart(first), apart(last));
  return widest <= of_length * length ? widest : none;
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
  find_open_parts();
}

void MeshSurface::find_open_parts() {
  const auto is_open = [this](std::size_t t, std::size_t k) {
    return of_edge_.of(edge_id_[t][k]).size() == 1;
  };
  std::vector<char> open_corner(of_corner_.first.size(), 0);
  for (std::size_t t = 0; t < corners_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (is_open(t, k)) open_corner[corner_id_[t][k]] = open_corner[corner_id_[t][(k + 1) % 3]] = 1;
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    open_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      open_[t].any = open_[t].any || open_corner[corner_id_[t][k]];
      open_[t].corner[k] = open_corner[corner_id_[t][k]] != 0;
      open_[t].edge[k] = is_open(t, k);
    }
  }
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

/// Whether r, on a triangle, is at a seam between it and another one that is open by less than `most`: no
/// farther from open edges of both than twice as much as these are apart, or from open corners of both than
/// eight times as much. Edges that run beside each other are a seam, and so are corners, where they are apart
/// by little against their length.
bool MeshSurface::is_at_seam(std::uint32_t triangle, const Vec3d& r, std::uint32_t other, double most) const {
  const Corners &t = corners_[triangle], &u = corners_[other];
  const std::array<Segment, 3> own = sides_of(t.a, t.b, t.c), others = sides_of(u.a, u.b, u.c);
  const auto is_near = [&](const Vec3d& on_own, const Vec3d& on_other, double zone) {
    zone += rounding_;
    return norm2(r - on_own) <= sq(zone) && norm2(r - on_other) <= sq(zone);
  };
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t n = 0; n < 3; ++n) {
      const Segment &a = own[k], &b = others[n];
      if (open_[triangle].edge[k] && open_[other].edge[n]) {
        const double apart = opening(a, b);
        if (apart < most && is_near(a.closest(r), b.closest(r), 2.0 * apart)) return true;
      }
      if (!open_[triangle].corner[k] || !open_[other].corner[n]) continue;
      const double apart = norm(a.from - b.from);
      if (apart < most && apart < of_length * std::min(shortest(own), shortest(others)) &&
          is_near(a.from, b.from, 8.0 * apart))
        return true;
    }
  return false;
}

/// Whether a triangle across a seam is nearer than this one, so that its touch at p does not count. Of two
/// that are as near the first in the file counts.
bool MeshSurface::is_beyond_a_seam(std::uint32_t triangle, const TrianglePoint& p, const Vec3d& centre,
                                   double reach, std::span<const std::uint32_t> triangles) const {
  if (!open_[triangle].any) return false;
  const double distance = norm(centre - p.r);
  return std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t other) {
    if (other == triangle || !open_[other].any) return false;
    const TrianglePoint q = closest(other, centre);
    const double nearer = norm(centre - q.r), overlap = reach - nearer;
    if (nearer > distance || (nearer == distance && other > triangle)) return false;
    return is_at_seam(triangle, p.r, other, overlap) || is_at_seam(other, q.r, triangle, overlap);
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
    if (is_beyond_a_seam(triangle, p, here, reach, triangles)) continue;
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
