#include "vbond/packing/skin.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "vbond/core/random.hpp"
#include "vbond/packing/voronoi.hpp"

namespace vbond::packing {
namespace {

/// Of the sphere through four points; infinite if they lie in a plane, as four of a lattice do that are moved
/// by little: there is nothing between these.
double circumradius(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d u = between(a, b), v = between(a, c), w = between(a, d);
  const double volume = dot(u, cross(v, w));
  const Vec3d to_centre = norm2(u) * cross(v, w) + norm2(v) * cross(w, u) + norm2(w) * cross(u, v);
  constexpr double flat = 1e-3;
  const double size = std::max({norm(u), norm(v), norm(w)});
  if (std::abs(volume) <= flat * size * size * size) return std::numeric_limits<double>::infinity();
  return norm(to_centre) / (2.0 * std::abs(volume));
}

/// One side of a tetrahedron.
struct Side {
  std::size_t tetrahedron;
  std::array<std::size_t, 3> corners;  ///< outwards
};

/// Finds the boundary of tetrahedra.
class Boundary {
 public:
  Boundary(const std::vector<Vec3d>& r, const std::vector<Tetrahedron>& all, double radius) {
    for (std::size_t t = 0; t < all.size(); ++t) {
      const Tetrahedron& c = all[t];
      filled_.push_back(circumradius(r[c[0]], r[c[1]], r[c[2]], r[c[3]]) <= radius ? 1 : 0);
      static constexpr std::size_t without[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
      const bool right_handed =
          dot(between(r[c[0]], r[c[1]]), cross(between(r[c[0]], r[c[2]]), between(r[c[0]], r[c[3]]))) > 0.0;
      for (const auto& [i, j, k] : without) {
        std::array<std::size_t, 3> corners{c[i], c[j], c[k]};
        if (!right_handed) std::swap(corners[1], corners[2]);
        std::array<std::size_t, 3> key = corners;
        std::sort(key.begin(), key.end());
        sides_[key].push_back({t, corners});
      }
    }
  }
  /// Whether no side is shared by more than two.
  bool is_sound() const {
    return std::all_of(sides_.begin(), sides_.end(), [](const auto& s) { return s.second.size() <= 2; });
  }

  Skin skin(const std::vector<Tetrahedron>& all, std::size_t points) {
    reach_from_outside();
    return {triangles(), points_outside(all, points)};
  }

 private:
  std::vector<std::array<std::size_t, 3>> triangles() const {
    std::vector<std::array<std::size_t, 3>> found;
    for (const auto& [key, sides] : sides_)
      for (std::size_t k = 0; k < sides.size(); ++k) {
        const bool other_is_outside = sides.size() == 1 || outside_[sides[1 - k].tetrahedron] != 0;
        if (outside_[sides[k].tetrahedron] == 0 && other_is_outside) found.push_back(sides[k].corners);
      }
    return found;
  }

  std::vector<std::size_t> points_outside(const std::vector<Tetrahedron>& all, std::size_t points) const {
    std::vector<char> is_corner(points, 0);
    for (std::size_t t = 0; t < all.size(); ++t)
      if (outside_[t] == 0)
        for (const std::size_t p : all[t]) is_corner[p] = 1;
    std::vector<std::size_t> found;
    for (std::size_t p = 0; p < points; ++p)
      if (is_corner[p] == 0) found.push_back(p);
    return found;
  }

  void reach_from_outside() {
    std::vector<std::vector<std::size_t>> beside(filled_.size());
    std::vector<std::size_t> next;
    outside_.assign(filled_.size(), 0);
    for (const auto& [key, sides] : sides_) {
      if (sides.size() == 2) {
        beside[sides[0].tetrahedron].push_back(sides[1].tetrahedron);
        beside[sides[1].tetrahedron].push_back(sides[0].tetrahedron);
      } else if (const std::size_t t = sides[0].tetrahedron; filled_[t] == 0 && outside_[t] == 0) {
        outside_[t] = 1;
        next.push_back(t);
      }
    }
    while (!next.empty()) {
      const std::size_t t = next.back();
      next.pop_back();
      for (const std::size_t other : beside[t])
        if (filled_[other] == 0 && outside_[other] == 0) {
          outside_[other] = 1;
          next.push_back(other);
        }
    }
  }

  std::vector<char> filled_, outside_;
  std::map<std::array<std::size_t, 3>, std::vector<Side>> sides_;
};

}  // namespace

std::optional<Skin> skin_of(const std::vector<Vec3d>& r, double radius) {
  if (r.size() < 4) {
    Skin none{{}, std::vector<std::size_t>(r.size())};
    std::iota(none.outside.begin(), none.outside.end(), std::size_t{0});
    return none;
  }
  constexpr double apart = 1e-5;
  constexpr unsigned tries = 8;
  for (unsigned seed = 1; seed <= tries; ++seed) {
    Random random(seed);
    std::vector<Vec3d> moved;
    for (const Vec3d& x : r) {
      const auto next = [&] { return apart * radius * (2.0 * random.uniform() - 1.0); };
      const double dx = next(), dy = next(), dz = next();
      moved.push_back(x + Vec3d{dx, dy, dz});
    }
    const std::vector<double> none(r.size(), 0.0);
    const VoronoiSpace space = space_around(moved, none, 1.1 * radius, {}, {});
    const std::optional<std::vector<Tetrahedron>> all = delaunay_tetrahedra(space, moved);
    if (!all) continue;
    Boundary boundary(moved, *all, radius);
    if (boundary.is_sound()) return boundary.skin(*all, r.size());
  }
  return std::nullopt;
}

}  // namespace vbond::packing
