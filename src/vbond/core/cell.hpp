#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"

// The cell that particles stand in, and how two of them stand to each other: said here and nowhere else
// (tools/check_layers).
namespace vbond {

/// Which image of a particle: whole edges of the cell that it stands away from the particle itself.
struct Image {
  std::int32_t a = 0, b = 0, c = 0;

  constexpr bool is_itself() const { return a == 0 && b == 0 && c == 0; }
  friend constexpr Image operator+(const Image& m, const Image& n) {
    return {m.a + n.a, m.b + n.b, m.c + n.c};
  }
  friend constexpr Image operator-(const Image& m, const Image& n) {
    return {m.a - n.a, m.b - n.b, m.c - n.c};
  }
  friend constexpr Image operator-(const Image& n) { return {-n.a, -n.b, -n.c}; }
  friend constexpr auto operator<=>(const Image&, const Image&) = default;
};

/// An image of a particle, or the particle itself.
struct ImageOf {
  ParticleId particle;
  Image image;
  friend constexpr auto operator<=>(const ImageOf&, const ImageOf&) = default;
};
/// The same, and all that goes with it, n further on.
constexpr ImageOf carried(const ImageOf& of, const Image& n) {
  return {of.particle, of.image + n};
}

/// One of the three edges of a periodic cell.
struct CellEdge {
  Vec3d along{};  ///< [length]
  Vec3d rate{};   ///< how it changed in the last step  [length/time]
  /// A row of V times the stress after the last step, with what velocities carry; of cells that move.
  /// [energy]
  Vec3d virial{};
  /// The sum over images that bonds join of how many of this edge they are away, times the damping force on
  /// them after the last step; of cells that move.  [force]
  Vec3d damping{};
  friend bool operator==(const CellEdge&, const CellEdge&) = default;
};
/// Edges a, b and c, which form a right-handed system; or none: nothing is periodic. Particles are never
/// moved back into the cell: the place of an image is r + n_a a + n_b b + n_c c, wherever the particle itself
/// is.
using CellEdges = std::vector<CellEdge>;

/// Which edges of a cell the body repeats along; it is open along the others.
using Periodic = std::array<bool, 3>;

/// From a particle to its image.  [length]
inline Vec3d to_image(const CellEdges& cell, const Image& n) {
  if (n.is_itself()) return {};
  return double(n.a) * cell[0].along + double(n.b) * cell[1].along + double(n.c) * cell[2].along;
}
/// How fast the image moves away from its particle.  [length/time]
inline Vec3d image_velocity(const CellEdges& cell, const Image& n) {
  if (n.is_itself()) return {};
  return double(n.a) * cell[0].rate + double(n.b) * cell[1].rate + double(n.c) * cell[2].rate;
}

/// Where this image stands.  [length]
inline Vec3d place_of(const PerParticle<Vec3d>& r, const CellEdges& cell, const ImageOf& of) {
  return of.image.is_itself() ? r[of.particle] : r[of.particle] + to_image(cell, of.image);
}

/// From the particle at r_i to that at r_j.  [length]
template <Scalar T>
VBOND_HD constexpr Vec3<T> between(const Vec3<T>& r_i, const Vec3<T>& r_j) {
  return r_j - r_i;
}

/// The same of one coordinate, for loops that hold particles, and not coordinates, side by side.
template <Scalar T>
VBOND_HD constexpr T between(const T& x_i, const T& x_j) {
  return x_j - x_i;
}

/// The same of two particles that stand at these places.
inline Vec3d between(const PerParticle<Vec3d>& r, ParticleId i, ParticleId j) {
  return between(r[i], r[j]);
}
/// From particle i to this image of particle j.  [length]
inline Vec3d between(const PerParticle<Vec3d>& r, const CellEdges& cell, ParticleId i, ParticleId j,
                     const Image& of_j) {
  return of_j.is_itself() ? between(r, i, j) : between(r[i], r[j] + to_image(cell, of_j));
}

}  // namespace vbond
