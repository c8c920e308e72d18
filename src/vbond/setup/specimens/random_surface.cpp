#include "vbond/setup/specimens/random_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "vbond/core/images.hpp"
#include "vbond/core/random.hpp"
#include "vbond/setup/specimens/surface.hpp"

namespace vbond {
namespace {

constexpr double triangle_area = 0.25 * std::numbers::sqrt3;  // of an equilateral one with edges 1

/// What points are spread over, in units of the spacing.
struct Ground {
  CellEdges cell;  ///< that a strip repeats with; empty: nothing repeats
  Periodic periodic{};
  std::function<Vec3d(Random&)> any_place;
  std::function<Vec3d(const Vec3d&)> put_back;  ///< on the ground, of a place near it
  /// Along the border, of a place on it; none at corners, nor inside.
  std::function<Vec3d(const Vec3d&)> border;
  std::function<Vec3d(const Vec3d&)> normal;  ///< at a place
  std::function<Vec3d(const Vec3d&)> lifted;  ///< of the way from a point to another one, see below
  double area = 0;
};

/// Pushes all points but the first `fixed` apart: downhill in the energy sum of (1 - d/range)^2.
void spread_out(const Ground& ground, std::size_t fixed, std::vector<Vec3d>& r) {
  constexpr int steps = 300;
  constexpr double range = 1.15, rate = 0.25, farthest = 0.2;
  std::vector<Vec3d> push(r.size());
  for (int step = 0; step < steps; ++step) {
    std::fill(push.begin(), push.end(), Vec3d{});
    for_near_images(ground.cell, ground.periodic, r, range,
                    [&](std::size_t i, std::size_t j, const Image& n, double d2) {
                      const double d = std::sqrt(d2);
                      if (d == 0.0) return;  // the next pair moves one of them
                      const Vec3d way = between(r[i], r[j] + to_image(ground.cell, n));
                      const Vec3d F = (rate * (1.0 - d / range) / d) * way;
                      push[i] -= F;
                      push[j] += F;
                    });
    for (std::size_t i = fixed; i < r.size(); ++i) {
      const double far = norm(push[i]);
      r[i] = ground.put_back(r[i] + (far > farthest ? farthest / far : 1.0) * push[i]);
    }
  }
}

/// A point as another one sees it.
struct Neighbour {
  std::size_t j;
  Vec3d way;  ///< lifted
};

std::vector<std::vector<Neighbour>> neighbours(const Ground& ground, std::size_t fixed,
                                               const std::vector<Vec3d>& r) {
  constexpr double range = 3.2;    // twice the largest empty circle, with room to spare
  constexpr double jitter = 1e-6;  // four points on one circle make a tie, of which a chance decides
  Random chance(1);
  std::vector<Vec3d> moved = r;
  for (std::size_t k = 0; k < moved.size(); ++k) {  // what is on a straight border stays there
    const Vec3d by = jitter * chance.in_ball();
    moved[k] += k < fixed ? dot(by, ground.border(r[k])) * ground.border(r[k]) : by;
  }
  std::vector<std::vector<Neighbour>> near(r.size());
  for_near_images(ground.cell, ground.periodic, r, range,
                  [&](std::size_t i, std::size_t j, const Image& n, double) {
                    const Vec3d way = between(moved[i], moved[j] + to_image(ground.cell, n));
                    near[i].push_back({j, ground.lifted(way)});
                    near[j].push_back({i, ground.lifted(-way)});
                  });
  return near;
}

/// Delaunay's triangles: no other point is above the plane of three. On a sphere that is the convex hull; of
/// a plane the points are lifted to a paraboloid, x, y, -(x^2 + y^2) (Edelsbrunner & Seidel, 1986).
Triangles triangulate(const Ground& ground, std::size_t fixed, const std::vector<Vec3d>& r) {
  constexpr double sliver = 1e-3;  // area below which three points of a straight border are no triangle
  const auto near = neighbours(ground, fixed, r);
  Triangles triangles;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Vec3d up = ground.normal(r[i]);
    for (std::size_t a = 0; a < near[i].size(); ++a)
      for (std::size_t b = a + 1; b < near[i].size(); ++b) {
        const Neighbour &j = near[i][a], &k = near[i][b];
        if (j.j <= i || k.j <= i) continue;  // each triangle at its first corner
        Vec3d n = cross(j.way, k.way);
        const double area = dot(n, up);
        if (std::abs(area) < 2.0 * sliver) continue;
        if (area < 0.0) n = -n;
        const bool empty = std::none_of(near[i].begin(), near[i].end(), [&](const Neighbour& m) {
          return &m != &j && &m != &k && dot(n, m.way) > 0.0;
        });
        if (!empty) continue;
        const auto id = [](std::size_t x) { return static_cast<std::int64_t>(x); };
        if (area > 0.0)
          triangles.push_back({id(i), id(j.j), id(k.j)});
        else
          triangles.push_back({id(i), id(k.j), id(j.j)});
      }
  }
  return triangles;
}

/// Border points, which stay, and as many others as the area has room for.
std::vector<Vec3d> spread_points(const Ground& ground, std::vector<Vec3d> border, int euler,
                                 std::uint64_t seed) {
  const std::size_t fixed = border.size();
  // triangles = 2 inner points + border points - 2 euler (disc 1, strip 0, sphere 2)
  const double inner =
      0.5 * (ground.area / triangle_area - static_cast<double>(fixed)) + static_cast<double>(euler);
  Random random(seed);
  std::vector<Vec3d> r = std::move(border);
  for (double k = 0.0; k < std::round(inner); ++k) r.push_back(ground.any_place(random));
  spread_out(ground, fixed, r);
  return r;
}

/// A triangulation has as many triangles as Euler's formula says; anything else is a hole or a fold.
void check_triangles(const Triangles& triangles, std::size_t points, std::size_t border, int euler,
                     const SourcePlace& place) {
  const auto wanted = 2 * static_cast<std::int64_t>(points) - static_cast<std::int64_t>(border) - 2 * euler;
  if (static_cast<std::int64_t>(triangles.size()) == wanted) return;
  throw CaseError(
      {place,
       fmt::format("{} random particles made {} triangles instead of {}", points, triangles.size(), wanted),
       "the surface is too small for its spacing: triangles would lap over themselves",
       "use a smaller spacing, or another seed"});
}

std::string in_words(const Triangles& triangles, const SpecimenPoints& points) {
  std::vector<int> neighbours(points.r.size(), 0);
  double least = INFINITY, largest = 0.0, sum = 0.0;
  for (const FileBond& b : points.bonds) {
    const auto place = [&](std::size_t end) { return points.r[static_cast<std::size_t>(b.pair[end])]; };
    const double d = norm(between(place(0), place(1)));
    least = std::min(least, d), largest = std::max(largest, d), sum += d;
    for (const std::int64_t p : b.pair) ++neighbours[static_cast<std::size_t>(p)];
  }
  return fmt::format(
      "{} particles at random places, {} triangles; edges {:.6g} to {:.6g}, mean {:.6g}; {} "
      "particles have six neighbours",
      points.r.size(), triangles.size(), least, largest, sum / static_cast<double>(points.bonds.size()),
      std::count(neighbours.begin(), neighbours.end(), 6));
}

/// A rectangle of this width and height; a strip repeats along its width.
Ground rectangle(double width, double height, bool strip) {
  Ground g;
  if (strip) {
    g.cell = {{{width, 0, 0}}, {{0, height, 0}}, {{0, 0, 1}}};
    g.periodic = {true, false, false};
  }
  g.any_place = [=](Random& random) {
    const double x = width * random.uniform();
    return Vec3d{x, height * random.uniform(), 0.0};
  };
  g.put_back = [=](const Vec3d& r) {
    const auto inside = [](double x, double size) {  // not on the border, nor near it
      const double margin = 0.5 * std::min(1.0, size);
      return std::clamp(x, margin, size - margin);
    };
    return Vec3d{strip ? r.x : inside(r.x, width), inside(r.y, height), 0.0};
  };
  g.border = [=](const Vec3d& r) {
    const bool on_side = !strip && (r.x == 0.0 || r.x == width), at_end = r.y == 0.0 || r.y == height;
    return on_side == at_end ? Vec3d{} : on_side ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
  };
  g.normal = [](const Vec3d&) { return Vec3d{0, 0, 1}; };
  g.lifted = [](const Vec3d& way) { return Vec3d{way.x, way.y, -(way.x * way.x + way.y * way.y)}; };
  g.area = width * height;
  return g;
}

/// Places along its border, in even steps: below and above, then of a rectangle left and right.
std::vector<Vec3d> border_of(double width, double height, bool strip) {
  const auto steps = [](double length) { return std::max(1.0, std::round(length)); };
  const double across = steps(width), up = steps(height);
  std::vector<Vec3d> border;
  for (const double y : {0.0, height})
    for (double k = 0.0; k < across + (strip ? 0.0 : 1.0); ++k)
      border.push_back({width * k / across, y, 0.0});
  if (!strip)
    for (const double x : {0.0, width})
      for (double k = 1.0; k < up; ++k) border.push_back({x, height * k / up, 0.0});
  return border;
}

std::vector<std::int64_t> range(std::int64_t from, std::int64_t to) {
  std::vector<std::int64_t> numbers;
  for (std::int64_t k = from; k < to; ++k) numbers.push_back(k);
  return numbers;
}

/// A flat surface in units of the spacing, and what becomes of its points.
SpecimenPoints flat_surface(double width, double height, bool strip, std::uint64_t seed,
                            const SourcePlace& place, const std::function<Vec3d(const Vec3d&)>& bent) {
  const Ground ground = rectangle(width, height, strip);
  std::vector<Vec3d> border = border_of(width, height, strip);
  const std::size_t fixed = border.size();
  const int euler = strip ? 0 : 1;
  const std::vector<Vec3d> r = spread_points(ground, std::move(border), euler, seed);
  const Triangles triangles = triangulate(ground, fixed, r);
  check_triangles(triangles, r.size(), fixed, euler, place);
  SpecimenPoints points;
  for (const Vec3d& p : r) points.r.push_back(bent(p));
  add_surface(triangles, points);
  points.notes.push_back(in_words(triangles, points));
  points.parts = {{"rim", range(0, static_cast<std::int64_t>(fixed))}};
  return points;
}

}  // namespace

SpecimenPoints random_sheet(const SheetSpecimen& s, const SourcePlace& place) {
  return flat_surface(s.size[0] / s.spacing, s.size[1] / s.spacing, false, s.seed, place,
                      [&s](const Vec3d& p) { return s.origin + s.spacing * p; });
}

SpecimenPoints random_cylinder(const CylinderSpecimen& s, const SourcePlace& place) {
  const double a = s.around.spacing.value(), width = s.radius * s.around.angle / a, height = s.length / a;
  const bool closed = s.around.angle >= 2.0 * std::numbers::pi * (1.0 - 1e-12);
  if (closed && width < 8.0)
    throw CaseError({place, fmt::format("a random cylinder {:.6g} spacings around", width),
                     "8 at least: its triangles are made flat and then rolled up", "use a smaller spacing"});
  SpecimenPoints points = flat_surface(width, height, closed, s.seed, place, [&s, a](const Vec3d& p) {
    const double phi = a * p.x / s.radius;
    return Vec3d{s.radius * std::cos(phi), s.radius * std::sin(phi), a * p.y};
  });
  const auto in_circle = static_cast<std::int64_t>(std::max(1.0, std::round(width))) + (closed ? 0 : 1);
  const auto on_border = static_cast<std::int64_t>(points.parts[0].second.size());
  points.parts = {{"ends", range(0, 2 * in_circle)},
                  {"first", range(0, in_circle)},
                  {"last", range(in_circle, 2 * in_circle)}};
  if (!closed) {
    std::vector<std::int64_t> sides = range(2 * in_circle, on_border);
    for (const std::int64_t corner : {std::int64_t{0}, in_circle - 1, in_circle, 2 * in_circle - 1})
      sides.push_back(corner);
    std::sort(sides.begin(), sides.end());
    points.parts.emplace_back("sides", sides);
  }
  place_on_axis(s.around.axis, s.origin, place, points);
  return points;
}

SpecimenPoints random_sphere(const SphereSpecimen& s, const SourcePlace& place) {
  const double R = s.radius / s.around.spacing.value();
  Ground ground;
  ground.any_place = [R](Random& random) {
    const Vec3d p = random.on_half_sphere();
    return R * (random.uniform() < 0.5 ? p : Vec3d{p.x, p.y, -p.z});
  };
  ground.put_back = [R](const Vec3d& r) { return R * normalised(r); };
  ground.normal = [](const Vec3d& r) { return normalised(r); };
  ground.lifted = [](const Vec3d& way) { return way; };
  ground.area = 4.0 * std::numbers::pi * R * R;
  if (R < 1.5)
    throw CaseError({place, fmt::format("a random sphere with a radius of {:.6g} spacings", R),
                     "1.5 at least", "use a smaller spacing"});
  const std::vector<Vec3d> r = spread_points(ground, {}, 2, s.seed);
  const Triangles triangles = triangulate(ground, 0, r);
  check_triangles(triangles, r.size(), 0, 2, place);
  SpecimenPoints points;
  for (const Vec3d& p : r) points.r.push_back(s.around.spacing.value() * p);
  add_surface(triangles, points);
  points.notes.push_back(in_words(triangles, points));
  place_on_axis(s.around.axis, s.centre, place, points);
  return points;
}

}  // namespace vbond
