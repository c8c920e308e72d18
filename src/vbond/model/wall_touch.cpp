#include "vbond/model/wall_touch.hpp"

#include <algorithm>
#include <cmath>

#include "vbond/core/scalar.hpp"

namespace vbond {
namespace {

/// Any unit vector at right angles to one.
Vec3d perpendicular(const Vec3d& n) {
  const Vec3d least = std::abs(n.x) <= std::abs(n.y) && std::abs(n.x) <= std::abs(n.z) ? Vec3d{1, 0, 0}
                      : std::abs(n.y) <= std::abs(n.z)                                 ? Vec3d{0, 1, 0}
                                                                                       : Vec3d{0, 0, 1};
  return normalised(across(least, n));
}

/// A vector as its length along a unit vector and the length and direction of the rest.
struct AxisParts {
  double along, off;
  Vec3d outward;  ///< unit vector; any where the rest is nothing but rounding

  AxisParts(const Vec3d& r, const Vec3d& axis) : along(dot(r, axis)) {
    const Vec3d rest = across(r, axis);
    off = norm(rest);
    const bool on_axis = off <= 1e-12 * std::abs(along);
    outward = on_axis ? perpendicular(axis) : normalised(across(rest / off, axis));
  }
};

/// From the closest point of a circle about the axis, given the lengths that lead from it outward and along.
WallTouch from_circle(const AxisParts& p, double off, double along, const Vec3d& axis) {
  const double distance = std::hypot(off, along);
  if (distance == 0.0) return {axis, 0.0};
  return {(off / distance) * p.outward + (along / distance) * axis, distance};
}

WallTouch touch(const PlaneWall& w, const Vec3d& centre) {
  return {w.normal, dot(centre - w.point, w.normal)};
}

WallTouch touch(const DiscWall& w, const Vec3d& centre) {
  const AxisParts p(centre - w.centre, w.normal);
  if (p.off > w.radius) return from_circle(p, p.off - w.radius, p.along, w.normal);
  return {p.along < 0.0 ? -w.normal : w.normal, std::abs(p.along)};
}

WallTouch touch(const CylinderWall& w, const Vec3d& centre) {
  const AxisParts p(centre - w.centre, w.axis);
  const double beyond = std::abs(p.along) - 0.5 * w.length;
  if (beyond > 0.0) return from_circle(p, p.off - w.radius, std::copysign(beyond, p.along), w.axis);
  const bool hollow = std::isfinite(w.length) ? p.off < w.radius : w.side == WallSide::inside;
  if (hollow) return {-p.outward, w.radius - p.off, -1.0 / w.radius, 0.0};
  return {p.outward, p.off - w.radius, 1.0 / w.radius, 0.0};
}

WallTouch touch(const SphereWall& w, const Vec3d& centre) {
  const Vec3d r = centre - w.centre;
  const double off = norm(r), curvature = 1.0 / w.radius;
  const Vec3d outward = off > 0.0 ? r / off : Vec3d{0, 0, 1};
  if (w.side == WallSide::inside) return {-outward, w.radius - off, -curvature, -curvature};
  return {outward, off - w.radius, curvature, curvature};
}

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;  // which clang 14 does not deduce by itself

}  // namespace

WallSurface::WallSurface(const WallShape& shape)
    : shape_(std::visit(Overloaded{[](const MeshWall& w) -> decltype(shape_) { return MeshSurface(w.mesh); },
                                   [](const auto& w) -> decltype(shape_) { return w; }},
                        shape)) {}

bool WallSurface::has_two_sides() const {
  if (const auto* cylinder = std::get_if<CylinderWall>(&shape_)) return std::isfinite(cylinder->length);
  return is_mesh() || std::holds_alternative<DiscWall>(shape_);
}

bool WallSurface::may_touch(const Vec3d& centre, double reach) const {
  return std::visit(Overloaded{[&](const MeshSurface& mesh) { return mesh.may_touch(centre, reach); },
                               [&](const auto& w) { return touch(w, centre).distance < reach; }},
                    shape_);
}

void WallSurface::touches(const Vec3d& centre, double reach, std::vector<WallTouch>& out) const {
  std::vector<std::uint32_t> triangles;
  near(centre, reach, triangles);
  touches_of(triangles, centre, reach, out);
}

void WallSurface::near(const Vec3d& centre, double reach, std::vector<std::uint32_t>& triangles) const {
  if (const auto* mesh = std::get_if<MeshSurface>(&shape_)) mesh->near(centre, reach, triangles);
}

void WallSurface::touches_of(std::span<const std::uint32_t> triangles, const Vec3d& centre, double reach,
                             std::vector<WallTouch>& out) const {
  std::visit(Overloaded{[&](const MeshSurface& mesh) { mesh.touches_of(triangles, centre, reach, out); },
                        [&](const auto& w) {
                          const WallTouch t = touch(w, centre);
                          if (t.distance < reach) out.push_back(t);
                        }},
             shape_);
}

}  // namespace vbond
