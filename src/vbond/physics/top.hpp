#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "vbond/core/quat.hpp"

/// Rotation of a body whose three principal moments of inertia differ: a top. Angular momentum and angular
/// velocity are then not parallel, and torque-free rotation is no rotation about a fixed axis.
namespace vbond {

/// Principal moments of inertia, and where their axes are in the body.
struct PrincipalInertia {
  Vec3d moments;  ///< about the principal axes  [mass*length^2]
  Quatd axes;     ///< turns vectors of the principal axes into body vectors
  friend bool operator==(const PrincipalInertia&, const PrincipalInertia&) = default;
};

inline double least_of(const Vec3d& a) {
  return std::min({a.x, a.y, a.z});
}
inline double largest_of(const Vec3d& a) {
  return std::max({a.x, a.y, a.z});
}
inline bool all_equal(const Vec3d& a) {
  return a.x == a.y && a.y == a.z;
}
inline Vec3d each_times(const Vec3d& a, const Vec3d& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline Vec3d each_over(const Vec3d& a, const Vec3d& b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}

/// No mass has a moment above the sum of the other two; equal in a plate without thickness, up to rounding.
inline bool keep_the_triangle_inequality(const Vec3d& moments) {
  return 2.0 * largest_of(moments) <= (1.0 + 1e-9) * (moments.x + moments.y + moments.z);
}

/// Angular momentum of a top that turns with omega. `principal`: from its principal axes to the world, as in
/// all that follows.
inline Vec3d angular_momentum(const Vec3d& moments, const Quatd& principal, const Vec3d& omega) {
  return rotate(principal, each_times(moments, rotate(conjugate(principal), omega)));
}

/// Its inverse.
inline Vec3d angular_velocity(const Vec3d& moments, const Quatd& principal, const Vec3d& L) {
  return rotate(principal, each_over(rotate(conjugate(principal), L), moments));
}

inline double rotation_energy(const Vec3d& moments, const Quatd& principal, const Vec3d& omega) {
  const Vec3d w = rotate(conjugate(principal), omega);
  return 0.5 * dot(moments, each_times(w, w));
}

/// Moment of inertia about an axis of the world.
inline double moment_about(const Vec3d& moments, const Quatd& principal, const Vec3d& unit_axis) {
  return 2.0 * rotation_energy(moments, principal, unit_axis);
}

/// Turns a top of angular momentum L for a time h without torque: exact rotations about its principal axes, x
/// and y by halves, z, y and x by halves, each with the L that it has in the body by then. L in space stays
/// as it is; time reversible, of second order in h. (Dullweber, Leimkuhler and McLachlan, J. Chem. Phys. 107
/// (1997) 5840.)
inline Quatd turned_freely(const Vec3d& moments, const Quatd& principal, const Vec3d& L, double h) {
  Quatd q = principal;
  Vec3d L_body = rotate(conjugate(q), L);
  const auto turn = [&](const Vec3d& axis, double time) {
    const Quatd by = rotation_of(time * each_over(each_times(L_body, axis), moments));
    q = q * by;
    L_body = rotate(conjugate(by), L_body);
  };
  turn({1, 0, 0}, 0.5 * h);
  turn({0, 1, 0}, 0.5 * h);
  turn({0, 0, 1}, h);
  turn({0, 1, 0}, 0.5 * h);
  turn({1, 0, 0}, 0.5 * h);
  return renormalised(q);
}

/// A symmetric tensor of inertia in body axes; off-diagonal entries with the sign they have in the tensor:
/// xy = -(sum of m x y).  [mass*length^2]
struct InertiaTensor {
  double xx, yy, zz, xy, xz, yz;
};

/// Its principal moments and axes, by Jacobi's rotations; empty if they do not come out: it is not finite.
inline std::optional<PrincipalInertia> principal_inertia(const InertiaTensor& tensor) {
  double A[3][3] = {{tensor.xx, tensor.xy, tensor.xz},
                    {tensor.xy, tensor.yy, tensor.yz},
                    {tensor.xz, tensor.yz, tensor.zz}};
  Vec3d V[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // columns: the axes
  for (int sweep = 0; sweep < 50; ++sweep) {
    const double off = std::abs(A[0][1]) + std::abs(A[0][2]) + std::abs(A[1][2]);
    if (!(off > 1e-17 * (std::abs(A[0][0]) + std::abs(A[1][1]) + std::abs(A[2][2])))) {
      if (std::isnan(off)) return std::nullopt;
      return PrincipalInertia{{A[0][0], A[1][1], A[2][2]}, rotation_to(V[0], V[1])};
    }
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      if (A[p][q] == 0.0) continue;
      const double theta = 0.5 * (A[q][q] - A[p][p]) / A[p][q];
      const double t = std::copysign(1.0 / (std::abs(theta) + std::hypot(1.0, theta)), theta);
      const double c = 1.0 / std::hypot(1.0, t), s = t * c;
      for (auto& row : A) {  // A J
        const double a = row[p], b = row[q];
        row[p] = c * a - s * b, row[q] = s * a + c * b;
      }
      for (int k = 0; k < 3; ++k) {  // J^T A
        const double a = A[p][k], b = A[q][k];
        A[p][k] = c * a - s * b, A[q][k] = s * a + c * b;
      }
      A[p][q] = A[q][p] = 0.0;
      const Vec3d a = V[p], b = V[q];
      V[p] = c * a - s * b, V[q] = s * a + c * b;
    }
  }
  return std::nullopt;
}

/// Principal moments of homogeneous solids of mass m about their axes of symmetry.
inline Vec3d moments_of_ellipsoid(double m, const Vec3d& semi_axes) {
  const Vec3d a2 = each_times(semi_axes, semi_axes);
  return 0.2 * m * Vec3d{a2.y + a2.z, a2.z + a2.x, a2.x + a2.y};
}
inline Vec3d moments_of_box(double m, const Vec3d& edges) {
  const Vec3d a2 = each_times(edges, edges);
  return m / 12.0 * Vec3d{a2.y + a2.z, a2.z + a2.x, a2.x + a2.y};
}
inline Vec3d moments_of_cylinder(double m, double radius, double length) {  // along z
  const double across = m / 12.0 * (3.0 * radius * radius + length * length);
  return {across, across, 0.5 * m * radius * radius};
}

}  // namespace vbond
