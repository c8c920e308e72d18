#include "vbond/setup/packing_vessel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "vbond/core/triangle_tree.hpp"
#include "vbond/setup/regions.hpp"
#include "vbond/terms/walls/mesh_surface.hpp"

namespace vbond {
namespace {

using packing::Feel;
using packing::Vessel;
using packing::Wall;

/// Closed surfaces of triangles, from within or from without. A sphere inside feels each place that is
/// nearest of its triangles; one whose centre has come through feels the nearest place of all.
class MeshWall final : public Wall {
 public:
  MeshWall(ClosedMesh mesh, bool inside)
      : mesh_(std::move(mesh)), surface_(mesh_.surface), tree_(mesh_.surface), inside_(inside) {}

  double depth(const Vec3d& r) const override {
    const double distance = norm(nearest(r) - r);
    return is_within(r) ? distance : -distance;
  }

  void feel(const Vec3d& r, double reach, std::vector<Feel>& out) const override {
    if (!is_within(r)) {
      const Vec3d back = nearest(r) - r;
      const double distance = norm(back);
      if (distance > 0.0) out.push_back({-distance, back / distance});
      return;
    }
    if (!surface_.may_touch(r, reach)) return;
    std::vector<std::uint32_t> triangles;
    std::vector<WallTouch> touches;
    surface_.near(r, reach, triangles);
    surface_.touches_of(triangles, r, reach, touches);
    for (const WallTouch& t : touches) out.push_back({t.distance, t.normal});
  }

  const BoundingBox& box() const { return tree_.box(); }

 private:
  bool is_within(const Vec3d& r) const { return (*mesh_.inside)(r) == inside_; }

  Vec3d nearest(const Vec3d& r) const {
    std::vector<std::uint32_t> triangles;
    double reach = 0.01 * box().diagonal();
    for (Vec3d best;; reach *= 2.0) {
      triangles.clear();
      tree_.near(r, reach, triangles);
      double least = reach;
      for (const std::uint32_t k : triangles) {
        const auto& t = mesh_.surface.triangles[k];
        const auto& c = mesh_.surface.corners;
        const Vec3d p = closest_on_triangle(r, c[t[0]], c[t[1]], c[t[2]]).r;
        if (const double distance = norm(p - r); distance < least) least = distance, best = p;
      }
      if (least < reach) return best;
    }
  }

  ClosedMesh mesh_;
  MeshSurface surface_;
  TriangleTree tree_;
  bool inside_;
};

/// Adds walls of one region; returns the box around it, without a limit where it has none.
class Builder {
 public:
  Builder(Vessel& vessel, const RegionOwner& owner, bool inside)
      : v_(vessel), owner_(owner), inside_(inside) {}

  BoundingBox operator()(const BoxRegion& b) const {
    const Vec3d size = b.max - b.min;
    require(std::min({size.x, size.y, size.z}) > 0.0, "its box has no volume");
    if (inside_)
      packing::add_box(v_, b.min, b.max);
    else
      v_.walls.push_back(packing::around_box(b.min, b.max));
    return {b.min, b.max};
  }
  BoundingBox operator()(const SphereRegion& s) const {
    v_.walls.push_back(packing::ball(s.centre, s.radius, inside_));
    BoundingBox box;
    box.add(s.centre, s.radius);
    return box;
  }
  BoundingBox operator()(const CylinderRegion& c) const {
    require(norm(c.to - c.from) > 0.0, "its cylinder has no length");
    if (inside_)
      packing::add_cylinder(v_, c.from, c.to, c.radius);
    else
      v_.walls.push_back(packing::around_cylinder(c.from, c.to, c.radius));
    const Vec3d e = normalised(c.to - c.from);
    const auto across = [&](double along) {
      return c.radius * std::sqrt(std::max(0.0, 1.0 - along * along));
    };
    const Vec3d d{across(e.x), across(e.y), across(e.z)};
    BoundingBox box;
    for (const Vec3d& end : {c.from, c.to}) box.add(end + d), box.add(end - d);
    return box;
  }
  BoundingBox operator()(const PlaneRegion& p) const {
    const Vec3d n = unit(p.normal);
    if (inside_) {
      v_.walls.push_back(packing::half_space(p.point + p.within * n, n));
      v_.walls.push_back(packing::half_space(p.point - p.within * n, -n));
    } else {
      v_.walls.push_back(packing::around_slab(p.point, n, p.within));
    }
    return {-everywhere(), everywhere()};
  }
  BoundingBox operator()(const HalfSpaceRegion& h) const {
    const Vec3d n = unit(h.normal);
    v_.walls.push_back(packing::half_space(h.point, inside_ ? n : -n));
    return {-everywhere(), everywhere()};
  }
  BoundingBox operator()(const MeshRegion& m) const {
    auto wall = std::make_shared<const MeshWall>(closed_mesh(m, owner_), inside_);
    v_.walls.push_back(wall);
    return wall->box();
  }

 private:
  static Vec3d everywhere() { return {BoundingBox::inf, BoundingBox::inf, BoundingBox::inf}; }
  void require(bool holds, const char* what) const {
    if (!holds) throw CaseError({owner_.place, owner_.name + ": " + what, "grains need room", "correct it"});
  }
  Vec3d unit(const Vec3d& normal) const {
    require(norm(normal) > 0.0, "its normal is zero");
    return normalised(normal);
  }

  Vessel& v_;
  const RegionOwner& owner_;
  bool inside_;
};

/// Faces at both ends of an open edge are walls.
void close_open_edge(Vessel& v, std::size_t k) {
  Vec3d n = normalised(cross(v.edges[(k + 1) % 3], v.edges[(k + 2) % 3]));
  v.walls.push_back(packing::half_space(v.corner, -n));
  v.walls.push_back(packing::half_space(v.corner + v.edges[k], n));
}

/// Walls must go on through the faces along which the vessel repeats: a grain there, as large as `reach`, is
/// told of those in its own cell only.
void check_seams(const Vessel& v, double reach, const SourcePlace& place) {
  constexpr int points = 12;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!v.periodic[k]) continue;
    for (int a = 0; a < points; ++a)
      for (int b = 0; b < points; ++b) {
        Vec3d s;
        component(s, static_cast<int>((k + 1) % 3)) = (a + 0.5) / points;
        component(s, static_cast<int>((k + 2) % 3)) = (b + 0.5) / points;
        const auto depth = [&](const Vec3d& r) {
          double least = reach;
          for (const auto& wall : v.walls) least = std::min(least, wall->depth(r));
          return std::max(least, -reach);
        };
        const Vec3d r = v.at(s);
        if (std::abs(depth(r) - depth(r + v.edges[k])) > 1e-6 * norm(v.edges[k]))
          throw CaseError(
              {place, fmt::format("the vessel does not go on beyond edge {} of the cell", "abc"[k]),
               "the cell repeats along it, and walls are not at the same places on both of its faces",
               fmt::format("let walls be along edge {}, and longer than it; or cell.open = [\"{}\"]",
                           "abc"[k], "abc"[k])});
      }
  }
}

double largest_radius(const PackingSpecimen& s) {
  struct Largest {
    double operator()(const EqualGrains& g) const { return g.radius; }
    double operator()(const UniformGrains& g) const { return g.radii[1]; }
    double operator()(const NormalGrains& g) const { return g.to.value_or(g.mean + 3.0 * g.deviation); }
    double operator()(const LognormalGrains& g) const {
      return g.to.value_or(g.median * std::exp(3.0 * g.deviation));
    }
    double operator()(const CurveGrains& g) const { return g.radii.empty() ? 0.0 : g.radii.back(); }
  };
  double largest = 0.0;
  for (const GrainSpec& g : s.grains) largest = std::max(largest, std::visit(Largest{}, g.sizes));
  return largest;
}

}  // namespace

Vessel vessel_of(const PackingSpecimen& s, const SourcePlace& place, const CellSpec* cell,
                 const std::string& case_file, std::vector<std::string>& notes) {
  Vessel v;
  BoundingBox box{{-BoundingBox::inf, -BoundingBox::inf, -BoundingBox::inf},
                  {BoundingBox::inf, BoundingBox::inf, BoundingBox::inf}};
  for (const VesselSpec& region : s.vessel) {
    const bool inside = region.keep == CutSpec::Keep::inside;
    const RegionOwner owner{case_file, region.place, "a region of the vessel", notes};
    const BoundingBox b = std::visit(Builder(v, owner, inside), region.region);
    if (!inside) continue;
    box.low = {std::max(box.low.x, b.low.x), std::max(box.low.y, b.low.y), std::max(box.low.z, b.low.z)};
    box.high = {std::min(box.high.x, b.high.x), std::min(box.high.y, b.high.y),
                std::min(box.high.z, b.high.z)};
  }
  if (cell) {
    if (cell->from_specimen)
      throw CaseError({place, "grains are packed into a cell that comes from the file of another specimen",
                       "the cell must be known before", "give the cell its edges a, b and c"});
    v.corner = cell->corner;
    v.edges = cell->edges;
    if (!(v.frame_volume() > 0.0)) return v;  // told where cells are checked
    for (std::size_t k = 0; k < 3; ++k) {
      v.periodic[k] = !cell->open[k];
      v.cell.push_back({v.edges[k], {}, {}, {}});
      if (cell->open[k]) close_open_edge(v, k);
    }
    if (!v.walls.empty()) check_seams(v, largest_radius(s), place);
    return v;
  }
  const Vec3d size = box.high - box.low;
  if (s.vessel.empty() || !is_finite(size))
    throw CaseError(
        {place, s.vessel.empty() ? "a packing without a vessel" : "a vessel without an end",
         "grains are packed into regions that end, or into the cell of the case",
         "write for example vessel = [{ box = { min = [0, 0, 0], max = [10, 10, 10] } }], or a table "
         "[cell]"});
  if (!(std::min({size.x, size.y, size.z}) > 0.0))
    throw CaseError({place, "regions of the vessel have nothing in common",
                     "the vessel is what all of them leave", "move them, or leave one out"});
  packing::set_frame(v, box);
  return v;
}

}  // namespace vbond
