#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "vbond/packing/pack.hpp"

/// Vessels, and packings judged by formulas of the tests' own: every pair, with every image that may be near.
namespace vbond::packing::testing {

inline Vessel periodic_cell(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& corner = {}) {
  Vessel v;
  v.edges = {a, b, c};
  v.corner = corner;
  v.periodic = {true, true, true};
  for (const Vec3d& e : v.edges) v.cell.push_back({e, {}, {}, {}});
  return v;
}
inline Vessel cube(double edge) {
  return periodic_cell({edge, 0, 0}, {0, edge, 0}, {0, 0, edge});
}
inline Vessel box(const Vec3d& size) {
  Vessel v;
  add_box(v, {}, size);
  set_frame(v, {{}, size});
  return v;
}
inline Vessel cylinder(double radius, double height) {
  Vessel v;
  add_cylinder(v, {}, {0, 0, height}, radius);
  set_frame(v, {{-radius, -radius, 0}, {radius, radius, height}});
  return v;
}
inline Vessel hollow_ball(double radius) {
  Vessel v;
  v.walls.push_back(ball({}, radius, true));
  set_frame(v, {{-radius, -radius, -radius}, {radius, radius, radius}});
  return v;
}

inline Request equal_grains(Vessel vessel, double radius) {
  Request q;
  q.vessel = std::move(vessel);
  q.kinds.push_back({"grain", Sizes(EqualSizes{radius})});
  return q;
}

inline double volume_of_grains(const Packing& p) {
  double sum = 0.0;
  for (const double R : p.radius) sum += 4.0 / 3.0 * std::numbers::pi * R * R * R;
  return sum;
}

/// The largest overlap of two grains over the radius of the smaller, images up to two edges away among them.
inline double deepest_overlap(const Vessel& v, const Packing& p) {
  double deepest = 0.0;
  const int a = v.cell.empty() ? 0 : 2;
  for (std::size_t i = 0; i < p.r.size(); ++i)
    for (std::size_t j = i; j < p.r.size(); ++j)
      for (int x = -a * v.periodic[0]; x <= a * v.periodic[0]; ++x)
        for (int y = -a * v.periodic[1]; y <= a * v.periodic[1]; ++y)
          for (int z = -a * v.periodic[2]; z <= a * v.periodic[2]; ++z) {
            if (i == j && x == 0 && y == 0 && z == 0) continue;
            const Vec3d d =
                p.r[j] - p.r[i] + double(x) * v.edges[0] + double(y) * v.edges[1] + double(z) * v.edges[2];
            const double sum = p.radius[i] + p.radius[j];
            if (norm2(d) < sum * sum)
              deepest = std::max(deepest, (sum - norm(d)) / std::min(p.radius[i], p.radius[j]));
          }
  return deepest;
}

}  // namespace vbond::packing::testing
