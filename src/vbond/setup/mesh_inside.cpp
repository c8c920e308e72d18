#include "vbond/setup/mesh_inside.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "vbond/core/column.hpp"
#include "vbond/core/disjoint_sets.hpp"
#include "vbond/setup/mesh_corners.hpp"
#include "vbond/setup/mesh_parts.hpp"

namespace vbond {
namespace {

bool lies_in(const Vec3d& r, const BoundingBox& box) {
  return box.low.x <= r.x && r.x <= box.high.x && box.low.y <= r.y && r.y <= box.high.y && box.low.z <= r.z &&
         r.z <= box.high.z;
}

/// Seen along z: whether the line y = r.y from r towards +x crosses the edge. Of both ends the lower one is
/// taken first, so that the two triangles of an edge get the same answer, rounding included.
bool crosses(const Vec3d& r, const Vec3d& a, const Vec3d& b) {
  if ((a.y > r.y) == (b.y > r.y)) return false;
  const Vec3d &low = a.y < b.y ? a : b, &high = a.y < b.y ? b : a;
  return (high.x - low.x) * (r.y - low.y) > (r.x - low.x) * (high.y - low.y);
}

using SurfaceId = Id<struct SurfaceTag>;

}  // namespace

ClosedSurface::ClosedSurface(TriangleMesh mesh)
    : mesh_(std::move(mesh)), box_(box_around(mesh_.corners)), faces_alike_(face_alike(mesh_)) {
  const std::size_t triangles = mesh_.triangles.size();
  std::size_t count = triangles, entries = 0;
  do {  // as many strips as leave a triangle in four of them at most, on average
    count = std::max<std::size_t>(count / 2, 1);
    strips_.assign(count, {});
    entries = 0;
    for (const auto& t : mesh_.triangles) entries += strips_of(t)[1] - strips_of(t)[0] + 1;
  } while (count > 1 && entries > 4 * triangles);
  for (std::size_t k = 0; k < triangles; ++k) {
    const auto [first, last] = strips_of(mesh_.triangles[k]);
    for (std::size_t s = first; s <= last; ++s) strips_[s].push_back(static_cast<std::uint32_t>(k));
  }
}

/// The first one for a mesh without width, of which y makes no part.
std::size_t ClosedSurface::strip_of(double y) const {
  const double part = (y - box_.low.y) / (box_.high.y - box_.low.y), n = static_cast<double>(strips_.size());
  return static_cast<std::size_t>(std::min(std::max(0.0, part * n), n - 1.0));
}

std::array<std::size_t, 2> ClosedSurface::strips_of(const std::array<std::uint32_t, 3>& triangle) const {
  const auto [low, high] =
      std::minmax({mesh_.corners[triangle[0]].y, mesh_.corners[triangle[1]].y, mesh_.corners[triangle[2]].y});
  return {strip_of(low), strip_of(high)};
}

bool ClosedSurface::holds(const Vec3d& r) const {
  if (!lies_in(r, box_)) return false;
  int left = 0, times = 0;
  for (const std::uint32_t k : strips_[strip_of(r.y)]) {
    const auto& t = mesh_.triangles[k];
    const Vec3d &a = mesh_.corners[t[0]], &b = mesh_.corners[t[1]], &c = mesh_.corners[t[2]];
    const bool above_or_below = crosses(r, a, b) ^ crosses(r, b, c) ^ crosses(r, c, a);
    if (!above_or_below) continue;
    const Vec3d n = cross(b - a, c - a);
    const double side = dot(n, a - r);  // of the plane; the ray goes along +z
    if (n.z > 0.0 ? side > 0.0 : side < 0.0) ++times, left += n.z > 0.0 ? 1 : -1;
  }
  return faces_alike_ ? left != 0 : times % 2 != 0;
}

MeshInside::MeshInside(const TriangleMesh& mesh) {
  for (TriangleMesh& part : closed_parts(mesh)) surfaces_.emplace_back(std::move(part));
  const std::size_t n = surfaces_.size();
  std::vector<std::size_t> order(n);  // by the low ends of their boxes along x
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto low = [&](std::size_t k) { return surfaces_[k].box().low.x; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return low(i) < low(j); });
  const PositionFinder position(surfaces_, same_corner * box_around(mesh.corners).diagonal());
  DisjointSets<SurfaceId> bodies(n);
  std::vector<char> nested(n, 0);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t m = k + 1; m < n && low(order[m]) <= surfaces_[order[k]].box().high.x; ++m)
      switch (position(order[k], order[m])) {
        case Position::apart: break;
        case Position::crossing: bodies.join(SurfaceId(order[k]), SurfaceId(order[m])); break;
        case Position::first_within: nested[order[k]] = 1; break;
        case Position::second_within: nested[order[m]] = 1; break;
      }
  nested_ = static_cast<std::size_t>(std::count(nested.begin(), nested.end(), 1));
  std::vector<std::size_t> body_of(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t first = bodies.smallest(SurfaceId(k)).value;  // at most k
    if (first == k) body_of[k] = bodies_.size(), bodies_.emplace_back();
    bodies_[body_of[k] = body_of[first]].push_back(k);
  }
}

bool MeshInside::is_ambiguous() const {
  return std::any_of(surfaces_.begin(), surfaces_.end(),
                     [](const ClosedSurface& s) { return !s.faces_alike() && has_crowded_edge(s.mesh()); });
}

std::size_t MeshInside::crossing() const {
  std::size_t count = 0;
  for (const auto& body : bodies_) count += body.size() > 1 ? body.size() : 0;
  return count;
}

bool MeshInside::operator()(const Vec3d& r) const {
  const auto held = [&](const std::vector<std::size_t>& body) {
    return std::any_of(body.begin(), body.end(), [&](std::size_t k) { return surfaces_[k].holds(r); });
  };
  return std::count_if(bodies_.begin(), bodies_.end(), held) % 2 != 0;
}

}  // namespace vbond
