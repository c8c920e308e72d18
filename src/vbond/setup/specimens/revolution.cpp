#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "vbond/case/value.hpp"
#include "vbond/setup/specimens/random_surface.hpp"
#include "vbond/setup/specimens/surface.hpp"

/// Surfaces of revolution. Rows of particles lie on circles; u with du = ds / r, where s is the way along the
/// meridian, and the angle phi make a conformal map: a triangular lattice in phi and u is one of nearly
/// equilateral triangles on the surface, of size proportional to r.
namespace vbond {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi, row_height = 0.5 * std::numbers::sqrt3;

struct Meridian {
  double u = 0;                                              ///< from the first circle to the last
  double largest = 0;                                        ///< radius of the largest circle
  std::function<std::pair<double, double>(double part)> at;  ///< r and z at this part of u
};

Meridian meridian_of(double r_1, double r_2, double length) {
  const double slope = (r_2 - r_1) / std::hypot(length, r_2 - r_1);
  const double u = slope == 0.0 ? length / r_1 : std::log1p((r_2 - r_1) / r_1) / slope;
  return {u, std::max(r_1, r_2), [=](double part) {
            const double way = slope == 0.0 ? part : std::expm1(slope * u * part) / std::expm1(slope * u);
            return std::pair{r_1 + (r_2 - r_1) * way, length * way};
          }};
}

Meridian meridian_of(const CylinderSpecimen& s) {
  return meridian_of(s.radius, s.radius, s.length);
}
Meridian meridian_of(const ConeSpecimen& s) {
  return meridian_of(s.radii[0], s.radii[1], s.length);
}
Meridian meridian_of(const SphereSpecimen& s) {
  const auto [from, to] = *s.polar;
  const double R = s.radius, u_1 = std::log(std::tan(0.5 * from)), u = std::log(std::tan(0.5 * to)) - u_1;
  const double widest = std::clamp(0.5 * std::numbers::pi, from, to);
  return {u, R * std::sin(widest), [=, first = from, last = to](double part) {
            const double polar = part == 0.0   ? first
                                 : part == 1.0 ? last
                                               : 2.0 * std::atan(std::exp(u_1 + u * part));
            return std::pair{R * std::sin(polar), R * std::cos(polar)};
          }};
}

/// How the surface is divided.
struct Division {
  bool closed = true;
  double around = 0;  ///< spacings on a circle
  double rows = 0;    ///< distances of circles
  double high = 0;    ///< height of a triangle over that of an equilateral one

  double particles() const {
    if (closed) return around * (rows + 1.0);
    return std::floor(0.5 * rows + 1.0) * (around + 1.0) + std::floor(0.5 * (rows + 1.0)) * around;
  }
  std::int64_t in_row(std::int64_t row) const {
    return static_cast<std::int64_t>(around) + (closed || row % 2 == 1 ? 0 : 1);
  }
};

Division divided(const Meridian& m, const AroundSpec& s, double around) {
  Division d;
  d.closed = s.angle >= full_turn * (1.0 - 1e-12);
  d.around = around;
  const double height = row_height * (d.closed ? full_turn : s.angle) / around;
  d.rows = std::max(1.0, std::round(m.u / height));
  d.high = m.u / (d.rows * height);
  return d;
}

/// With a spacing, of all numbers within 3 % of what it asks for the one whose triangles are the most
/// equilateral.
Division divided(const Meridian& m, const AroundSpec& s) {
  const bool closed = divided(m, s, 1.0).closed;
  if (s.particles) return divided(m, s, static_cast<double>(*s.particles - (closed ? 0 : 1)));
  const double least = closed ? 3.0 : 1.0;
  const double wanted = std::max(least, std::round(s.angle * m.largest / s.spacing.value()));
  Division best = divided(m, s, wanted);
  if (!(best.particles() <= static_cast<double>(keys::most_particles))) return best;
  const auto misfit = [](const Division& d) { return std::abs(std::log(d.high)); };
  const double from = std::max(least, std::min(wanted - 1.0, std::ceil(0.97 * wanted)));
  for (double n = from; n <= std::max(wanted + 1.0, 1.03 * wanted); ++n)
    if (const Division d = divided(m, s, n); misfit(d) < misfit(best)) best = d;
  return best;
}

/// Particle `j` of a row, whose first one has the number `first`.
struct CircleRow {
  std::int64_t first, size;
  std::int64_t operator[](std::int64_t j) const { return first + (j + size) % size; }
};

/// The triangles between two rows, of which the odd one is half a spacing farther round.
void add_triangles(const CircleRow& even, const CircleRow& odd, bool closed, Triangles& triangles) {
  const std::int64_t n = odd.size;
  for (std::int64_t j = 0; j < n; ++j) {
    triangles.push_back({even[j], even[j + 1], odd[j]});
    if (closed || j > 0) triangles.push_back({odd[j - 1], odd[j], even[j]});
  }
}

void name_circles(const std::vector<CircleRow>& rows, bool closed, SpecimenPoints& points) {
  const auto all_of = [](const CircleRow& row) {
    std::vector<std::int64_t> particles;
    for (std::int64_t j = 0; j < row.size; ++j) particles.push_back(row.first + j);
    return particles;
  };
  const std::vector<std::int64_t> first = all_of(rows.front()), last = all_of(rows.back());
  std::vector<std::int64_t> ends = first, sides;
  ends.insert(ends.end(), last.begin(), last.end());
  points.parts = {{"ends", ends}, {"first", first}, {"last", last}};
  if (closed) return;
  for (std::size_t k = 0; k < rows.size(); k += 2)  // odd rows end half a spacing before the sides
    sides.push_back(rows[k].first), sides.push_back(rows[k].first + rows[k].size - 1);
  points.parts.emplace_back("sides", sides);
}

std::string division_in_words(const Division& d) {
  std::string text =
      fmt::format("{:.0f} circles of {}, {:.0f} particles", d.rows + 1.0, d.in_row(0), d.particles());
  const double percent = 100.0 * (d.high - 1.0);
  text += fmt::format("; triangles are {:.2g} % {} than equilateral ones", std::abs(percent),
                      percent < 0.0 ? "lower" : "higher");
  if (std::abs(percent) > 2.0) text += ", which makes the sheet stiffer one way: choose other numbers";
  return text;
}

template <class Surface>
SpecimenPoints revolved(const Surface& s, const Vec3d& origin, const SourcePlace& place) {
  const Meridian meridian = meridian_of(s);
  const Division d = divided(meridian, s.around);
  if (!(d.particles() <= static_cast<double>(keys::most_particles)))
    throw CaseError({place, fmt::format("a surface of {:.3g} particles", d.particles()),
                     "a specimen has at most 1e8", "use a larger spacing"});
  SpecimenPoints points;
  std::vector<CircleRow> rows;
  const double step = (d.closed ? full_turn : s.around.angle) / d.around;
  for (std::int64_t k = 0; k <= static_cast<std::int64_t>(d.rows); ++k) {
    rows.push_back({static_cast<std::int64_t>(points.r.size()), d.in_row(k)});
    const auto [r, z] = meridian.at(static_cast<double>(k) / d.rows);
    for (std::int64_t j = 0; j < rows.back().size; ++j) {
      const double phi = step * (static_cast<double>(j) + (k % 2 == 1 ? 0.5 : 0.0));
      points.r.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
  }
  Triangles triangles;
  for (std::size_t k = 0; k + 1 < rows.size(); ++k)
    k % 2 == 0 ? add_triangles(rows[k], rows[k + 1], d.closed, triangles)
               : add_triangles(rows[k + 1], rows[k], d.closed, triangles);
  add_surface(triangles, points);
  name_circles(rows, d.closed, points);
  place_on_axis(s.around.axis, origin, place, points);
  points.notes.push_back(division_in_words(d));
  return points;
}

// ---- the closed sphere: an icosahedron with each face divided into frequency^2 triangles -----------------

double frequency_of(const SphereSpecimen& s) {
  const double wanted =
      8.0 * std::numbers::pi * sq(s.radius / s.around.spacing.value()) / std::numbers::sqrt3;
  return std::max(1.0, std::round(std::sqrt(std::max(0.0, wanted - 2.0) / 10.0)));
}

struct Icosahedron {
  std::vector<Vec3d> corners;
  Triangles faces;
};

/// A corner on each end of the z axis.
Icosahedron icosahedron() {
  Icosahedron solid{{{0, 0, 1}}, {}};
  const double z = std::sqrt(0.2), r = 2.0 * z;
  for (int k = 0; k < 10; ++k) {
    const double phi = full_turn * (k < 5 ? k : k + 0.5) / 5.0;
    solid.corners.push_back({r * std::cos(phi), r * std::sin(phi), k < 5 ? z : -z});
  }
  solid.corners.push_back({0, 0, -1});
  for (int k = 0; k < 5; ++k) {
    const std::int64_t a = 1 + k, b = 1 + (k + 1) % 5, c = 6 + k, d = 6 + (k + 1) % 5;
    for (const auto& face :
         {std::array{std::int64_t{0}, a, b}, {a, c, b}, {b, c, d}, {std::int64_t{11}, d, c}})
      solid.faces.push_back(face);
  }
  return solid;
}

/// Numbers the points of the faces, those on edges once.
class FacePoints {
 public:
  FacePoints(const Icosahedron& solid, double radius, std::int64_t frequency, SpecimenPoints& points)
      : solid_(solid), radius_(radius), frequency_(frequency), points_(points) {}

  /// The point j steps from the face's first corner towards its second and k towards its third.
  std::int64_t number(const std::array<std::int64_t, 3>& face, std::int64_t j, std::int64_t k) {
    using Weight = std::pair<std::int64_t, std::int64_t>;  // corner, steps towards it
    std::array<Weight, 3> key{Weight{face[0], frequency_ - j - k}, {face[1], j}, {face[2], k}};
    for (Weight& w : key)
      if (w.second == 0) w.first = -1;
    std::sort(key.begin(), key.end());
    const auto [known, is_new] = numbers_.try_emplace(key, static_cast<std::int64_t>(points_.r.size()));
    if (!is_new) return known->second;
    Vec3d p;
    for (const auto& [corner, steps] : key)
      if (steps > 0) p += static_cast<double>(steps) * solid_.corners[static_cast<std::size_t>(corner)];
    points_.r.push_back(radius_ * normalised(p));
    return known->second;
  }

 private:
  const Icosahedron& solid_;
  double radius_;
  std::int64_t frequency_;
  SpecimenPoints& points_;
  std::map<std::array<std::pair<std::int64_t, std::int64_t>, 3>, std::int64_t> numbers_;
};

SpecimenPoints closed_sphere(const SphereSpecimen& s, const SourcePlace& place) {
  if (!(count_points(s) <= static_cast<double>(keys::most_particles)))
    throw CaseError({place, fmt::format("a sphere of {:.3g} particles", count_points(s)),
                     "a specimen has at most 1e8", "use a larger spacing"});
  const Icosahedron solid = icosahedron();
  const auto f = static_cast<std::int64_t>(frequency_of(s));
  SpecimenPoints points;
  FacePoints at(solid, s.radius, f, points);
  Triangles triangles;
  for (const auto& face : solid.faces)
    for (std::int64_t j = 0; j < f; ++j)
      for (std::int64_t k = 0; j + k < f; ++k) {
        triangles.push_back({at.number(face, j, k), at.number(face, j + 1, k), at.number(face, j, k + 1)});
        if (j + k + 1 < f)
          triangles.push_back(
              {at.number(face, j + 1, k + 1), at.number(face, j + 1, k), at.number(face, j, k + 1)});
      }
  add_surface(triangles, points);
  const std::int64_t last = at.number(solid.faces[3], 0, 0);  // its first corner is on -z
  points.parts = {{"ends", {0, last}}, {"first", {0}}, {"last", {last}}};
  place_on_axis(s.around.axis, s.centre, place, points);
  points.notes.push_back(
      fmt::format("an icosahedron whose edges are divided by {}, {} particles", f, points.r.size()));
  return points;
}

}  // namespace

SpecimenPoints make_points(const CylinderSpecimen& s, const SourcePlace& place) {
  return s.lattice == SurfaceLattice::random ? random_cylinder(s, place) : revolved(s, s.origin, place);
}
SpecimenPoints make_points(const ConeSpecimen& s, const SourcePlace& place) {
  return revolved(s, s.origin, place);
}
SpecimenPoints make_points(const SphereSpecimen& s, const SourcePlace& place) {
  if (s.lattice == SurfaceLattice::random) return random_sphere(s, place);
  return s.polar ? revolved(s, s.centre, place) : closed_sphere(s, place);
}

double count_points(const CylinderSpecimen& s) {
  if (s.lattice == SurfaceLattice::random) return 0.0;
  return divided(meridian_of(s), s.around).particles();
}
double count_points(const ConeSpecimen& s) {
  return divided(meridian_of(s), s.around).particles();
}
double count_points(const SphereSpecimen& s) {
  if (s.lattice == SurfaceLattice::random) return 0.0;
  if (s.polar) return divided(meridian_of(s), s.around).particles();
  return 10.0 * sq(frequency_of(s)) + 2.0;
}

}  // namespace vbond
