#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "vbond/packing/voronoi.hpp"

/// Radical cells by clipping: each starts as a large cube and loses what is beyond the plane of every other
/// sphere, with every image up to two edges away, one after the other.
namespace vbond::packing::testing {

/// The particle on the other side and its image.
using FaceName = std::tuple<std::size_t, int, int, int>;
constexpr std::size_t a_wall = 1u << 30;

struct Polygon {
  std::vector<Vec3d> corners;
  FaceName name;
};

inline Vec3d area_vector(const std::vector<Vec3d>& p) {
  Vec3d sum;
  for (std::size_t k = 1; k + 1 < p.size(); ++k) sum = sum + 0.5 * cross(p[k] - p[0], p[k + 1] - p[0]);
  return sum;
}

/// A convex body, corner by corner.
class Clipped {
 public:
  explicit Clipped(double h) {
    const Vec3d e[3] = {{h, 0, 0}, {0, h, 0}, {0, 0, h}};
    for (int k = 0; k < 3; ++k)
      for (const double s : {-1.0, 1.0}) {
        const Vec3d n = s * e[k], u = e[(k + 1) % 3], v = s * e[(k + 2) % 3];
        faces_.push_back({{n - u - v, n + u - v, n + u + v, n - u + v}, {a_wall, 0, 0, 0}});
      }
  }
  /// Leaves r . n <= c.
  void clip(const Vec3d& n, double c, const FaceName& name) {
    bool cuts = false;
    for (const Polygon& f : faces_)
      for (const Vec3d& p : f.corners) cuts = cuts || dot(p, n) > c;
    if (!cuts) return;
    std::vector<Vec3d> rim;
    for (Polygon& f : faces_) {
      std::vector<Vec3d> left;
      for (std::size_t k = 0; k < f.corners.size(); ++k) {
        const Vec3d &p = f.corners[k], &q = f.corners[(k + 1) % f.corners.size()];
        const double a = dot(p, n) - c, b = dot(q, n) - c;
        if (a <= 0.0) left.push_back(p);
        if ((a <= 0.0) != (b <= 0.0)) {
          const Vec3d cut = p + (a / (a - b)) * (q - p);
          left.push_back(cut), rim.push_back(cut);
        }
      }
      f.corners = left;
    }
    std::erase_if(faces_, [](const Polygon& f) { return f.corners.size() < 3; });
    if (rim.size() < 3) return;
    Vec3d middle;
    for (const Vec3d& p : rim) middle = middle + p / double(rim.size());
    const Vec3d u = normalised(rim[0] - middle), v = cross(normalised(n), u);
    std::sort(rim.begin(), rim.end(), [&](const Vec3d& p, const Vec3d& q) {
      return std::atan2(dot(p - middle, v), dot(p - middle, u)) <
             std::atan2(dot(q - middle, v), dot(q - middle, u));
    });
    faces_.push_back({rim, name});
  }
  double volume() const {
    double sum = 0.0;
    for (const Polygon& f : faces_) sum += dot(area_vector(f.corners), f.corners[0]) / 3.0;
    return sum;
  }
  std::map<FaceName, double> areas() const {
    std::map<FaceName, double> areas;
    for (const Polygon& f : faces_)
      if (std::get<0>(f.name) != a_wall) areas[f.name] += norm(area_vector(f.corners));
    return areas;
  }

 private:
  std::vector<Polygon> faces_;
};

/// r: in the cell, or anywhere within planes.
inline Clipped plain_cell(const VoronoiSpace& space, const std::vector<Vec3d>& r,
                          const std::vector<double>& R, std::size_t i) {
  double side = 0.0;
  for (const Vec3d& e : space.edges) side += norm(e);
  Clipped cell(2.0 * side);
  for (const Plane& p : space.planes) cell.clip(p.normal, p.at - dot(r[i], p.normal), {a_wall, 0, 0, 0});
  const auto most = [&](std::size_t k) { return space.periodic[k] ? 2 : 0; };
  for (int far = 0; far <= 2; ++far)  // near ones first: fewer corners come and go
    for (int a = -most(0); a <= most(0); ++a)
      for (int b = -most(1); b <= most(1); ++b)
        for (int c = -most(2); c <= most(2); ++c) {
          if (std::max({std::abs(a), std::abs(b), std::abs(c)}) != far) continue;
          for (std::size_t j = 0; j < r.size(); ++j) {
            if (j == i && far == 0) continue;
            const Vec3d d = r[j] - r[i] + double(a) * space.edges[0] + double(b) * space.edges[1] +
                            double(c) * space.edges[2];
            cell.clip(d, 0.5 * (norm2(d) + R[i] * R[i] - R[j] * R[j]), {j, a, b, c});
          }
        }
  return cell;
}

}  // namespace vbond::packing::testing
