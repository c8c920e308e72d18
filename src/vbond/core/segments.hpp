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
  const auto at = [&](double s, double t) {
    return NearestOnSegments{s, t, norm2(on_segment(q_0, q_1, t) - on_segment(p_0, p_1, s))};
  };
  const auto at_end_of_first = [&](double s) {
    return at(s, nearest_on_segment(s == 0.0 ? p_0 : p_1, q_0, q_1));
  };
  const auto at_end_of_second = [&](double t) {
    return at(nearest_on_segment(t == 0.0 ? q_0 : q_1, p_0, p_1), t);
  };
  const auto nearer = [](const NearestOnSegments& x, const NearestOnSegments& y) {
    return y.distance2 < x.distance2 ? y : x;
  };
  if (uu == 0.0) return at_end_of_first(0.0);
  if (vv == 0.0) return at_end_of_second(0.0);
  const double uv = dot(u, v), wu = dot(w, u), wv = dot(w, v);
  // sin^2 of the angle below which rounding leaves no inner point, and no order of ends
  constexpr double parallel = 1e-12, nearly_parallel = 1e-6;
  const double determinant = uu * vv - uv * uv;
  // where the two lines are nearest, times the determinant
  const double s = wu * vv - wv * uv, t = wu * uv - wv * uu;
  const bool is_within_first = s > 0.0 && determinant > s, is_within_second = t > 0.0 && determinant > t;
  if (is_within_first && is_within_second && determinant > parallel * uu * vv)
    return at(s / determinant, t / determinant);
  if (!(determinant > nearly_parallel * uu * vv))
    return nearer(nearer(at_end_of_first(0.0), at_end_of_first(1.0)),
                  nearer(at_end_of_second(0.0), at_end_of_second(1.0)));
  // at the end of a segment beyond which that is, or at the end of the other that is then the nearest
  if (is_within_first) return at_end_of_second(t > 0.0 ? 1.0 : 0.0);
  const NearestOnSegments end = at_end_of_first(s > 0.0 ? 1.0 : 0.0);
  return end.t > 0.0 && end.t < 1.0 ? end : at_end_of_second(end.t);
}

/// Whether two segments are farther apart than that along n, |n| <= 1, and so in space: quick to work out.
/// False where a number is NaN.
inline bool farther_apart_along(const Vec3d& n, const Vec3d& p_0, const Vec3d& p_1, const Vec3d& q_0,
                                const Vec3d& q_1, double distance) {
  const double u = dot(n, p_1 - p_0), v = dot(n, q_1 - q_0), w = dot(n, q_0 - p_0);
  return w + std::min(v, 0.0) - std::max(u, 0.0) > distance;
}

}  // namespace vbond
