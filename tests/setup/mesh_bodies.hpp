#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "random_pose.hpp"
#include "vbond/core/bounding_box.hpp"
#include "vbond/setup/mesh_file.hpp"

/// Random closed bodies, and what rounding in files does to them.
namespace vbond::testing {

/// A box whose faces have n x n squares, each of two triangles that face outwards.
inline TriangleMesh subdivided_box(const Vec3d& low, const Vec3d& high, std::uint32_t n) {
  MeshFile box;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool top : {false, true}) {
      const auto first = static_cast<std::uint32_t>(box.mesh.corners.size());
      for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
          const double s[3] = {top ? 1.0 : 0.0, static_cast<double>(i) / n, static_cast<double>(j) / n};
          const double x = s[(3 - axis) % 3], y = s[(4 - axis) % 3], z = s[(5 - axis) % 3];
          box.mesh.corners.push_back(
              {low.x + x * (high.x - low.x), low.y + y * (high.y - low.y), low.z + z * (high.z - low.z)});
        }
      for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
          const std::uint32_t a = first + j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
          if (top)
            box.mesh.triangles.insert(box.mesh.triangles.end(), {{a, b, c}, {a, c, d}});
          else
            box.mesh.triangles.insert(box.mesh.triangles.end(), {{a, c, b}, {a, d, c}});
        }
    }
  clean(box);
  return box.mesh;
}

/// A ball of n x 2 n fields with rough radii, so that it has ridges, valleys, tips and pits.
inline TriangleMesh rough_ball(std::uint32_t n, double roughness, PoseSource& random) {
  TriangleMesh mesh;
  mesh.corners = {{0, 0, 1}, {0, 0, -1}};
  const std::uint32_t m = 2 * n;
  for (std::uint32_t i = 1; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const double theta = std::numbers::pi * i / n, phi = 2.0 * std::numbers::pi * j / m;
      const double r = 1.0 + roughness * random.uniform(-1.0, 1.0);
      mesh.corners.push_back(
          {r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi), r * std::cos(theta)});
    }
  const auto at = [m](std::uint32_t i, std::uint32_t j) { return 2 + (i - 1) * m + j % m; };
  for (std::uint32_t j = 0; j < m; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({1, at(n - 1, j + 1), at(n - 1, j)});
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// A prism over a star with n tips: walls along z, re-entrant edges between them.
inline TriangleMesh star_prism(std::uint32_t n, PoseSource& random) {
  TriangleMesh mesh;
  mesh.corners = {{0, 0, -0.5}, {0, 0, 0.5}};
  for (std::uint32_t k = 0; k < 2 * n; ++k) {
    const double phi = std::numbers::pi * k / n, r = k % 2 == 0 ? 1.0 : random.uniform(0.3, 0.8);
    mesh.corners.push_back({r * std::cos(phi), r * std::sin(phi), -0.5});
    mesh.corners.push_back({r * std::cos(phi), r * std::sin(phi), 0.5});
  }
  for (std::uint32_t k = 0; k < 2 * n; ++k) {
    const std::uint32_t a = 2 + 2 * k, b = 2 + 2 * ((k + 1) % (2 * n));
    mesh.triangles.push_back({0, b, a});
    mesh.triangles.push_back({1, a + 1, b + 1});
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
  return mesh;
}

/// One of these, of any size, turned and anywhere.
inline TriangleMesh random_body(unsigned seed, PoseSource& random) {
  const auto n = static_cast<std::uint32_t>(random.uniform(2.0, 7.0));
  TriangleMesh mesh;
  switch (seed % 3) {
    case 0:
      mesh =
          subdivided_box({-1, -1, -1}, {random.uniform(0, 2), random.uniform(0, 2), random.uniform(0, 2)}, n);
      break;
    case 1: mesh = rough_ball(n + 1, random.uniform(0.0, 0.4), random); break;
    default: mesh = star_prism(n + 1, random);
  }
  const Quatd q = seed % 5 == 0 ? Quatd{} : random.rotation(3.0);  // some stay along the axes
  const double size = std::pow(10.0, random.uniform(-3.0, 3.0));
  const Vec3d shift = random.vector(2.0);
  for (Vec3d& r : mesh.corners) r = size * (rotate(q, r) + shift);
  return mesh;
}

/// The same triangles, each with corners of its own that are off by up to `amount` along each axis.
inline MeshFile shaken(const TriangleMesh& mesh, double amount, PoseSource& random) {
  MeshFile soup;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.mesh.corners.size());
    for (const std::uint32_t k : t) soup.mesh.corners.push_back(mesh.corners[k] + random.vector(amount));
    soup.mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

}  // namespace vbond::testing
