#include "vbond/setup/polygons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vbond/core/scalar.hpp"
#include "vbond/core/triangle_mesh.hpp"

namespace vbond {
namespace {

struct Flat {
  double x = 0, y = 0;
  friend bool operator==(const Flat&, const Flat&) = default;
};

/// Twice the area of a triangle, positive if it turns to the left; zero where that is rounding.
double turn(const Flat& a, const Flat& b, const Flat& c) {
  constexpr double rounding = 1e-12;
  const double x = b.x - a.x, y = b.y - a.y, u = c.x - b.x, v = c.y - b.y, area = x * v - y * u;
  return std::abs(area) <= rounding * std::hypot(x, y) * std::hypot(u, v) ? 0.0 : area;
}

/// A polygon from which ears are cut, as seen against its normal: it turns to the left.
class Ears {
 public:
  explicit Ears(std::vector<Flat> points)
      : r_(std::move(points)), before_(r_.size()), after_(r_.size()), is_ear_(r_.size()), left_(r_.size()) {
    const std::size_t n = r_.size();
    for (std::size_t k = 0; k < n; ++k) before_[k] = (k + n - 1) % n, after_[k] = (k + 1) % n;
  }

  bool crosses_itself() const {
    const std::size_t n = r_.size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) {
        const Flat &a = r_[i], &b = r_[(i + 1) % n], &c = r_[j], &d = r_[(j + 1) % n];
        if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x)) continue;
        if (turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0) return true;
      }
    return false;
  }

  /// Calls cut(i, j, k) for each triangle; false if at some time there is no ear.
  template <class Cut>
  bool cut_all(Cut&& cut) {
    std::size_t at = 0;
    for (const Rule rule : {Rule::clear, Rule::touched, Rule::straight}) {
      rule_ = rule;
      std::size_t k = at;
      for (std::size_t n = 0; n < left_; ++n, k = after_[k]) is_ear_[k] = looks_like_ear(k);
      for (std::size_t passed = 0; left_ > 2 && passed < left_;) {
        at = after_[at];
        ++passed;
        if (!is_ear_[at]) continue;
        const std::size_t i = before_[at], j = after_[at];
        cut(i, at, j);
        after_[i] = j, before_[j] = i;
        --left_;
        is_ear_[i] = looks_like_ear(i), is_ear_[j] = looks_like_ear(j);
        at = i;
        passed = 0;
      }
      if (left_ == 2) return true;
    }
    return false;
  }

 private:
  /// What an ear may be: free of other corners; touched by some, as where a hole hangs on a double side; a
  /// corner on a straight side, which leaves a triangle without an area.
  enum class Rule : std::uint8_t { clear, touched, straight };

  bool looks_like_ear(std::size_t k) const {
    const Flat &a = r_[before_[k]], &b = r_[k], &c = r_[after_[k]];
    const double area = turn(a, b, c);
    if (rule_ == Rule::straight && area == 0.0) return true;
    if (!(area > 0.0)) return false;
    for (std::size_t m = after_[after_[k]]; m != before_[k]; m = after_[m]) {
      const Flat& p = r_[m];
      if (p == a || p == b || p == c || turn(r_[before_[m]], p, r_[after_[m]]) > 0.0) continue;
      const double least = std::min({turn(a, b, p), turn(b, c, p), turn(c, a, p)});
      if (least > 0.0 || (least == 0.0 && rule_ == Rule::clear)) return false;
    }
    return true;
  }

  std::vector<Flat> r_;
  std::vector<std::size_t> before_, after_;
  std::vector<char> is_ear_;
  std::size_t left_;
  Rule rule_ = Rule::clear;
};

std::vector<Flat> seen_along(const Vec3d& n, const std::vector<Vec3d>& corners,
                             std::span<const std::uint32_t> polygon) {
  const Vec3d other = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalised(cross(other, n)), v = cross(n, u);
  std::vector<Flat> flat;
  for (const std::uint32_t k : polygon) {
    const Vec3d r = corners[k] - corners[polygon[0]];
    flat.push_back({dot(r, u), dot(r, v)});
  }
  return flat;
}

}  // namespace

std::string cut_polygon(const std::vector<Vec3d>& corners, std::span<const std::uint32_t> polygon,
                        std::vector<std::array<std::uint32_t, 3>>& triangles) {
  constexpr std::size_t most = 10000;  // corners of one that is not convex: the time grows with the square
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t k) { return corners[polygon[k % n]]; };
  const auto fan = [&](std::size_t k) { return cross(at(k) - at(0), at(k + 1) - at(0)); };
  Vec3d area;
  bool some_area = false, is_fan = true;
  for (std::size_t k = 1; k + 1 < n; ++k) {
    area += fan(k);
    some_area = some_area || has_area(at(0), at(k), at(k + 1));
  }
  for (std::size_t k = 0; k < n; ++k) {
    const bool in_fan = k > 0 && k + 1 < n;
    if (in_fan && n > 3) is_fan = is_fan && has_area(at(0), at(k), at(k + 1)) && dot(fan(k), area) > 0.0;
    is_fan = is_fan && dot(cross(at(k + 1) - at(k), at(k + 2) - at(k + 1)), area) >= -1e-6 * norm2(area);
  }
  if (is_fan || !some_area) {
    for (std::size_t k = 1; k + 1 < n; ++k) triangles.push_back({polygon[0], polygon[k], polygon[k + 1]});
    return "";
  }
  if (n > most)
    return fmt::format("a face of {} corners is not convex, and such a one may have {} at most", n, most);
  if (!(norm2(area) > 0.0)) return fmt::format("a face of {} corners crosses itself", n);
  Ears ears(seen_along(normalised(area), corners, polygon));
  if (ears.crosses_itself()) return fmt::format("a face of {} corners crosses itself", n);
  const bool whole = ears.cut_all([&](std::size_t i, std::size_t j, std::size_t k) {
    triangles.push_back({polygon[i], polygon[j], polygon[k]});
  });
  return whole ? "" : fmt::format("a face of {} corners cannot be cut into triangles", n);
}

}  // namespace vbond
