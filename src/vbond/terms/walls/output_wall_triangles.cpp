#include "vbond/terms/walls/output_wall_triangles.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace vbond {
namespace {

constexpr std::uint32_t turn = 64;  // corners
constexpr std::uint32_t rings = turn / 2;

/// Two unit vectors that make a right-handed system with the unit vector n.
std::pair<Vec3d, Vec3d> across_of(const Vec3d& n) {
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const Vec3d least = x <= y && x <= z ? Vec3d{1, 0, 0} : y <= z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  const Vec3d first = normalised(cross(least, n));
  return {first, cross(n, first)};
}

/// Adds corners on a circle about an axis.
void add_circle(const Vec3d& centre, const Vec3d& axis, double radius, TriangleMesh& to) {
  const auto [first, second] = across_of(axis);
  for (std::uint32_t k = 0; k < turn; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / turn;
    to.corners.push_back(centre + radius * (std::cos(angle) * first + std::sin(angle) * second));
  }
}

/// Adds the band between two circles that follow each other, the first of them from this corner on.
void add_band(std::uint32_t from, TriangleMesh& to) {
  for (std::uint32_t k = 0; k < turn; ++k) {
    const std::uint32_t a = from + k, b = from + (k + 1) % turn;
    to.triangles.push_back({a, b, b + turn});
    to.triangles.push_back({a, b + turn, a + turn});
  }
}

/// Adds the triangles between a corner and the circle that begins at another one.
void add_fan(std::uint32_t middle, std::uint32_t circle, TriangleMesh& to) {
  for (std::uint32_t k = 0; k < turn; ++k)
    to.triangles.push_back({middle, circle + k, circle + (k + 1) % turn});
}

Vec3d middle_of(const BoundingBox& body) {
  return 0.5 * (body.low + body.high);
}

TriangleMesh triangles_of(const PlaneWall& w, const BoundingBox& body) {
  const Vec3d middle = middle_of(body), foot = middle - dot(middle - w.point, w.normal) * w.normal;
  const auto [first, second] = across_of(w.normal);
  const Vec3d size = body.high - body.low;
  const auto half = [&size](const Vec3d& d) {
    constexpr double room = 1.5;
    return 0.5 * room * (std::abs(d.x) * size.x + std::abs(d.y) * size.y + std::abs(d.z) * size.z) * d;
  };
  const Vec3d a = half(first), b = half(second);
  return {{foot - a - b, foot + a - b, foot + a + b, foot - a + b}, {{0, 1, 2}, {0, 2, 3}}};
}

TriangleMesh triangles_of(const DiscWall& w, const BoundingBox&) {
  TriangleMesh mesh{{w.centre}, {}};
  add_circle(w.centre, w.normal, w.radius, mesh);
  add_fan(0, 1, mesh);
  return mesh;
}

TriangleMesh triangles_of(const CylinderWall& w, const BoundingBox& body) {
  const bool endless = std::isinf(w.length);
  const double length = endless ? body.diagonal() : w.length;
  const Vec3d centre = endless ? w.centre + dot(middle_of(body) - w.centre, w.axis) * w.axis : w.centre;
  TriangleMesh mesh;
  add_circle(centre - 0.5 * length * w.axis, w.axis, w.radius, mesh);
  add_circle(centre + 0.5 * length * w.axis, w.axis, w.radius, mesh);
  add_band(0, mesh);
  return mesh;
}

TriangleMesh triangles_of(const SphereWall& w, const BoundingBox&) {
  const Vec3d axis{0, 0, 1};
  TriangleMesh mesh{{w.centre - w.radius * axis, w.centre + w.radius * axis}, {}};
  for (std::uint32_t ring = 1; ring < rings; ++ring) {
    const double angle = std::numbers::pi * ring / rings;
    add_circle(w.centre - w.radius * std::cos(angle) * axis, axis, w.radius * std::sin(angle), mesh);
    if (ring > 1) add_band(2 + (ring - 2) * turn, mesh);
  }
  add_fan(0, 2, mesh);
  add_fan(1, 2 + (rings - 2) * turn, mesh);
  return mesh;
}

TriangleMesh triangles_of(const MeshWall& w, const BoundingBox&) {
  return w.mesh;
}

}  // namespace

BoundingBox body_at_start(const Model& model, const Communicator& all) {
  if (model.particles() == 0) return {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  BoundingBox box;
  for (const ParticleId p : model.r_0.ids())
    if (model.r_0.holds(p)) box.add(model.r_0[p], model.radius[p]);
  std::array<double, 6> most{-box.low.x, -box.low.y, -box.low.z, box.high.x, box.high.y, box.high.z};
  all.max(most);
  return {{-most[0], -most[1], -most[2]}, {most[3], most[4], most[5]}};
}

TriangleMesh triangles_of(const Wall& wall, const BoundingBox& body) {
  return std::visit([&body](const auto& shape) { return triangles_of(shape, body); }, wall.shape);
}

}  // namespace vbond
