#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {
namespace {

void require(bool holds, const SourcePlace& place, const std::string& what, const std::string& rule,
             const std::string& way_out) {
  if (!holds) throw CaseError({place, what, rule, way_out});
}

/// First and last particle, and both.
void name_ends(SpecimenPoints& points) {
  const auto last = static_cast<std::int64_t>(points.r.size()) - 1;
  points.parts = {{"ends", {0, last}}, {"first", {0}}, {"last", {last}}};
}

}  // namespace

SpecimenPoints make_points(const RodSpecimen& s, const SourcePlace& place) {
  require(s.particles >= 2, place, fmt::format("a rod of {} particles", s.particles), "a rod has two ends",
          "use particles = 2 or more, or shape = \"listed\" for a single particle");
  require(norm(s.direction) > 0.0, place, "the rod's direction is zero", "it says where the rod points",
          "use for instance direction = [1, 0, 0]");
  const Vec3d e = normalised(s.direction);
  SpecimenPoints points;
  for (std::int64_t k = 0; k < s.particles; ++k)
    points.r.push_back(s.origin + (static_cast<double>(k) * s.spacing) * e);
  if (s.half_ends) {
    points.mass_factor.assign(points.r.size(), 1.0);
    points.mass_factor.front() = points.mass_factor.back() = 0.5;
  }
  name_ends(points);
  return points;
}

SpecimenPoints make_points(const RingSpecimen& s, const SourcePlace& place) {
  require(s.particles >= 3, place, fmt::format("a ring of {} particles", s.particles),
          "fewer than three particles make no ring", "use particles = 3 or more");
  require(s.radius > 0.0, place, fmt::format("a ring of radius {}", s.radius), "the radius must be positive",
          "give the radius of the circle on which the centres lie");
  SpecimenPoints points;
  for (std::int64_t k = 0; k < s.particles; ++k) {
    const double phi = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(s.particles);
    points.r.push_back(s.centre + s.radius * Vec3d{std::cos(phi), std::sin(phi), 0.0});
  }
  return points;
}

SpecimenPoints make_points(const HelixSpecimen& s, const SourcePlace& place) {
  require(s.particles >= 2, place, fmt::format("a helix of {} particles", s.particles),
          "a helix has two ends", "use particles = 2 or more");
  SpecimenPoints points;
  for (std::int64_t k = 0; k < s.particles; ++k) {
    const double turns = s.turns * static_cast<double>(k) / static_cast<double>(s.particles - 1);
    const double phi = 2.0 * std::numbers::pi * turns;
    points.r.push_back(s.origin + Vec3d{s.radius * std::cos(phi), s.radius * std::sin(phi), s.pitch * turns});
  }
  name_ends(points);
  return points;
}

SpecimenPoints make_points(const ListedSpecimen& s, const SourcePlace& place) {
  require(!s.positions.empty(), place, "no positions are listed", "a specimen has at least one particle",
          "give positions = [[x, y, z], ...]");
  SpecimenPoints points;
  points.r = s.positions;
  return points;
}

}  // namespace vbond
