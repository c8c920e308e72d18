#include "vbond/terms/walls/wall_touch.hpp"

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

double length_of(double a, double b) {
  return std::hypot(a, b);
}
Dual<3> length_of(const Dual<3>& a, const Dual<3>& b) {
  return sqrt(a * a + b * b);
}
template <Scalar T>
T size_of(const T& a) {
  return plain(a) < 0.0 ? -a : a;
}

/// A vector as its length along a unit vector and the length and direction of the rest.
template <Scalar T>
struct AxisParts {
  T along, off;
  Vec3<T> outward;  ///< unit vector; any where the rest is nothing but rounding

  AxisParts(const Vec3<T>& r, const Vec3d& unit) {
    const Vec3<T> axis = constant<T>(unit), rest = across(r, axis);
    along = dot(r, axis);
    off = norm(rest);
    const bool on_axis = plain(off) <= 1e-12 * std::abs(plain(along));
    outward = on_axis ? constant<T>(perpendicular(unit)) : normalised(across(rest / off, axis));
  }
};

/// From the closest point of a circle about the axis, given the lengths that lead from it outward and along.
template <Scalar T>
WallTouchOf<T> from_circle(const AxisParts<T>& p, const T& off, const T& along, const Vec3d& axis) {
  const T distance = length_of(off, along);
  if (plain(distance) == 0.0) return {constant<T>(axis), T(0.0)};
  return {(off / distance) * p.outward + (along / distance) * constant<T>(axis), distance};
}

template <Scalar T>
WallTouchOf<T> touch(const PlaneWall& w, const Vec3<T>& centre) {
  return {constant<T>(w.normal), dot(centre - constant<T>(w.point), constant<T>(w.normal))};
}

template <Scalar T>
WallTouchOf<T> touch(const DiscWall& w, const Vec3<T>& centre) {
  const AxisParts<T> p(centre - constant<T>(w.centre), w.normal);
  if (plain(p.off) > w.radius) return from_circle<T>(p, p.off - T(w.radius), p.along, w.normal);
  return {constant<T>(plain(p.along) < 0.0 ? -w.normal : w.normal), size_of(p.along)};
}

template <Scalar T>
WallTouchOf<T> touch(const CylinderWall& w, const Vec3<T>& centre) {
  const AxisParts<T> p(centre - constant<T>(w.centre), w.axis);
  const T beyond = size_of(p.along) - T(0.5 * w.length), R(w.radius);
  if (plain(beyond) > 0.0)
    return from_circle<T>(p, p.off - R, plain(p.along) < 0.0 ? -beyond : beyond, w.axis);
  const bool hollow = std::isfinite(w.length) ? plain(p.off) < w.radius : w.side == WallSide::inside;
  if (hollow) return {-p.outward, R - p.off, -1.0 / w.radius, 0.0};
  return {p.outward, p.off - R, 1.0 / w.radius, 0.0};
}

template <Scalar T>
WallTouchOf<T> touch(const SphereWall& w, const Vec3<T>& centre) {
  const Vec3<T> r = centre - constant<T>(w.centre);
  const T off = norm(r), R(w.radius);
  const double curvature = 1.0 / w.radius;
  const Vec3<T> outward = plain(off) > 0.0 ? r / off : constant<T>({0, 0, 1});
  if (w.side == WallSide::inside) return {-outward, R - off, -curvature, -curvature};
  return {outward, off - R, curvature, curvature};
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
  append(triangles, centre, reach, out);
}

void WallSurface::touches(const Vec3<Dual<3>>& centre, double reach, std::vector<MovedWallTouch>& out) const {
  std::vector<std::uint32_t> triangles;
  near(plain(centre), reach, triangles);
  append(triangles, centre, reach, out);
}

void WallSurface::near(const Vec3d& centre, double reach, std::vector<std::uint32_t>& triangles) const {
  if (const auto* mesh = std::get_if<MeshSurface>(&shape_)) mesh->near(centre, reach, triangles);
}

void WallSurface::touches_of(std::span<const std::uint32_t> triangles, const Vec3d& centre, double reach,
                             std::vector<WallTouch>& out) const {
  append(triangles, centre, reach, out);
}

template <Scalar T>
void WallSurface::append(std::span<const std::uint32_t> triangles, const Vec3<T>& centre, double reach,
                         std::vector<WallTouchOf<T>>& out) const {
  std::visit(Overloaded{[&](const MeshSurface& mesh) { mesh.touches_of(triangles, centre, reach, out); },
                        [&](const auto& w) {
                          const WallTouchOf<T> t = touch(w, centre);
                          if (plain(t.distance) < reach) out.push_back(t);
                        }},
             shape_);
}

}  // namespace vbond
