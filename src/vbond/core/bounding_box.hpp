#pragma once
#include <algorithm>
#include <array>
#include <limits>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// The box along the axes around what was added; empty at first: low is above high.  [length]
struct BoundingBox {
  static constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3d low{inf, inf, inf}, high{-inf, -inf, -inf};

  /// A sphere, or a point.
  void add(const Vec3d& r, double radius = 0.0) {
    low = {std::min(low.x, r.x - radius), std::min(low.y, r.y - radius), std::min(low.z, r.z - radius)};
    high = {std::max(high.x, r.x + radius), std::max(high.y, r.y + radius), std::max(high.z, r.z + radius)};
  }
  /// With all that is in another box.
  void join(const BoundingBox& b) {
    low = {std::min(low.x, b.low.x), std::min(low.y, b.low.y), std::min(low.z, b.low.z)};
    high = {std::max(high.x, b.high.x), std::max(high.y, b.high.y), std::max(high.z, b.high.z)};
  }
  /// Whether a point is within a distance of it along each axis. A point that is no farther than that from
  /// one of those that were added, as rounded, always is.
  bool is_near(const Vec3d& r, double distance) const {
    const auto near = [distance](double low, double x, double high) {
      return low - x <= distance && x - high <= distance;
    };
    return near(low.x, r.x, high.x) && near(low.y, r.y, high.y) && near(low.z, r.z, high.z);
  }
  /// The square of the distance of a point outside; 0 within. From a box of nothing: infinite.
  double distance2(const Vec3d& r) const {
    const auto outside = [](double x, double low, double high) { return std::max({low - x, 0.0, x - high}); };
    return sq(outside(r.x, low.x, high.x)) + sq(outside(r.y, low.y, high.y)) +
           sq(outside(r.z, low.z, high.z));
  }
  double diagonal() const { return norm(high - low); }
  /// 0, 1, 2 for x, y, z: the longest direction first, of equal ones in this order.
  std::array<int, 3> axes_by_length() const {
    std::array<int, 3> axes{0, 1, 2};
    const auto length = [size = high - low](int k) { return component(size, k); };
    std::sort(axes.begin(), axes.end(),
              [&length](int k, int l) { return length(k) != length(l) ? length(k) > length(l) : k < l; });
    return axes;
  }
};

/// Around all of these points.
template <class Points>
BoundingBox box_around(const Points& points) {
  BoundingBox box;
  for (const Vec3d& r : points) box.add(r);
  return box;
}

}  // namespace vbond
