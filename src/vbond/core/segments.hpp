#pragma once
#include <algorithm>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Where two segments are nearest: at p_0 + s (p_1 - p_0) and q_0 + t (q_1 - q_0), 0 <= s, t <= 1.
struct NearestOnSegments {
  double s = 0, t = 0;
  double distance2 = 0;  ///< [length^2]
};

/// Where on the segment q_0 q_1, which may be a point, it is nearest to p.
inline double nearest_on_segment(const Vec3d& p, const Vec3d& q_0, const Vec3d& q_1) {
  const Vec3d v = q_1 - q_0;
  const double length2 = norm2(v);
  return length2 > 0.0 ? std::clamp(dot(p - q_0, v) / length2, 0.0, 1.0) : 0.0;
}

/// The point of a segment; its ends exactly.
inline Vec3d on_segment(const Vec3d& q_0, const Vec3d& q_1, double t) {
  return t == 0.0 ? q_0 : t == 1.0 ? q_1 : q_0 + t * (q_1 - q_0);
}

/// The least distance of two segments. An end that it is reached at has s or t = 0 or 1 exactly, and the
/// other parameter is that of nearest_on_segment() for this end: to the bit, so that segments which share the
/// end agree. Of parallel segments some pair of nearest points with an end among them.
inline NearestOnSegments nearest_on_segments(const Vec3d& p_0, const Vec3d& p_1, const Vec3d& q_0,
                                             const Vec3d& q_1) {
  const Vec3d u = p_1 - p_0, v = q_1 - q_0, w = q_0 - p_0;
  const double uu = norm2(u), vv = norm2(v);
  if (uu == 0.0 && vv == 0.0) return {0.0, 0.0, norm2(w)};
  const double uv = dot(u, v), wu = dot(w, u), wv = dot(w, v);
  const double determinant = uu * vv - uv * uv;
  constexpr double parallel = 1e-12;  // sin^2 of the angle below which rounding leaves no inner point
  if (determinant > parallel * uu * vv) {
    const double s = (wu * vv - wv * uv) / determinant, t = (wu * uv - wv * uu) / determinant;
    if (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)
      return {s, t, norm2(on_segment(q_0, q_1, t) - on_segment(p_0, p_1, s))};
  }
  NearestOnSegments best{0.0, nearest_on_segment(p_0, q_0, q_1), 0.0};
  best.distance2 = norm2(on_segment(q_0, q_1, best.t) - p_0);
  const auto look_at = [&](double s, double t) {
    const double distance2 = norm2(on_segment(q_0, q_1, t) - on_segment(p_0, p_1, s));
    if (distance2 < best.distance2) best = {s, t, distance2};
  };
  if (uu > 0.0) look_at(1.0, nearest_on_segment(p_1, q_0, q_1));  // else it is the same point
  look_at(nearest_on_segment(q_0, p_0, p_1), 0.0);
  if (vv > 0.0) look_at(nearest_on_segment(q_1, p_0, p_1), 1.0);
  return best;
}

}  // namespace vbond
