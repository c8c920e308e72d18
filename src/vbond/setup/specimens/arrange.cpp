#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "vbond/case/value.hpp"
#include "vbond/setup/regions.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {
namespace {

template <class T>
void filter(const std::vector<char>& kept, std::vector<T>& values) {
  if (values.empty()) return;
  std::size_t n = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) values[n++] = values[i];
  values.resize(n);
}

/// Bonds between particles that stay, with their new numbers.
void renumber_bonds(const std::vector<std::int64_t>& number, std::vector<FileBond>& bonds) {
  std::size_t n = 0;
  for (const FileBond& bond : bonds) {
    const std::int64_t i = number[static_cast<std::size_t>(bond.pair[0])],
                       j = number[static_cast<std::size_t>(bond.pair[1])];
    if (i >= 0 && j >= 0) bonds[n++] = {{i, j}, bond.type, bond.across};
  }
  bonds.resize(n);
}

/// Parts of which nothing is left are no parts; their names are returned.
std::string renumber_parts(const std::vector<std::int64_t>& number, SpecimenPoints& points) {
  std::string gone;
  auto parts = std::move(points.parts);
  points.parts.clear();
  for (auto& [name, particles] : parts) {
    std::vector<std::int64_t> left;
    for (const std::int64_t k : particles)
      if (const std::int64_t now = number[static_cast<std::size_t>(k)]; now >= 0) left.push_back(now);
    if (left.empty())
      gone += (gone.empty() ? "" : ", ") + name;
    else
      points.parts.emplace_back(name, std::move(left));
  }
  return gone;
}

/// Takes away the other particles; returns the names of the parts that go with them.
std::string keep_only(const std::vector<char>& kept, SpecimenPoints& points) {
  std::vector<std::int64_t> number(kept.size(), -1);
  std::int64_t n = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) number[i] = n++;
  filter(kept, points.r);
  filter(kept, points.v);
  filter(kept, points.omega);
  filter(kept, points.orientations);
  filter(kept, points.fibre);
  filter(kept, points.radius);
  filter(kept, points.mass);
  filter(kept, points.inertia);
  filter(kept, points.moments);
  filter(kept, points.mass_factor);
  renumber_bonds(number, points.bonds);
  return renumber_parts(number, points);
}

void cut(const SpecimenSpec& spec, const std::string& case_file, SpecimenPoints& points) {
  for (const CutSpec& c : spec.cut) {
    const std::string who = fmt::format("a cut of specimen \"{}\"", spec.name);
    const Inside inside = std::visit(
        [&](const auto& region) {
          return inside_of(region, RegionOwner{case_file, c.place, who, points.notes});
        },
        c.region);
    const std::size_t before = points.r.size(), bonds = points.bonds.size();
    std::vector<char> kept(before);
    for (std::size_t i = 0; i < before; ++i)
      kept[i] = inside(points.r[i]) == (c.keep == CutSpec::Keep::inside);
    const std::string gone = keep_only(kept, points);
    if (points.r.empty())
      throw CaseError({c.place, fmt::format("{} leaves none of {} particles", who, before),
                       "cuts come before turn, move and array, and see the specimen as its kind places it",
                       "make the region smaller, or use the other `keep`"});
    std::string note = fmt::format("{} leaves {} of {} particles", who, points.r.size(), before);
    if (bonds > 0) note += fmt::format(" and {} of the {} bonds that it brings", points.bonds.size(), bonds);
    if (!gone.empty()) note += "; it leaves nothing of its " + gone;
    points.notes.push_back(std::move(note));
  }
}

void turn(const TurnSpec& spec, const SourcePlace& place, SpecimenPoints& points) {
  if (!(norm(spec.axis) > 0.0))
    throw CaseError({place, "the axis of a turn is zero", "it must point somewhere",
                     "use for instance axis = [0, 0, 1]"});
  const Vec3d u = std::sin(0.5 * spec.angle) * normalised(spec.axis);
  const Quatd q{std::cos(0.5 * spec.angle), u.x, u.y, u.z};
  for (Vec3d& r : points.r) r = spec.about + rotate(q, r - spec.about);
  for (Vec3d& v : points.v) v = rotate(q, v);
  for (Vec3d& omega : points.omega) omega = rotate(q, omega);
  points.q = normalised(q * points.q);
  if (!points.box) return;
  for (Vec3d& edge : points.box->edges) edge = rotate(q, edge);
  points.box->corner = spec.about + rotate(q, points.box->corner - spec.about);
}

template <class T>
void repeat(std::size_t times, std::vector<T>& values) {
  const std::size_t n = values.size();
  values.reserve(n * times);
  for (std::size_t k = n; k < n * times; ++k) values.push_back(values[k - n]);
}

/// Fibres of a copy have numbers of their own.
void repeat_fibres(std::size_t particles, SpecimenPoints& points) {
  if (points.fibre.empty()) return;
  const std::int64_t fibres = 1 + *std::max_element(points.fibre.begin(), points.fibre.end());
  for (std::size_t k = particles; k < points.r.size(); ++k)
    points.fibre.push_back(points.fibre[k - particles] + fibres);
}

void copy(const CopiesSpec& row, SpecimenPoints& points) {
  const std::size_t n = points.r.size(), times = static_cast<std::size_t>(row.count);
  repeat(times, points.r);
  for (std::size_t k = n; k < points.r.size(); ++k) points.r[k] += static_cast<double>(k / n) * row.step;
  repeat(times, points.v);
  repeat(times, points.omega);
  repeat(times, points.orientations);
  repeat(times, points.radius);
  repeat(times, points.mass);
  repeat(times, points.inertia);
  repeat(times, points.moments);
  repeat(times, points.mass_factor);
  repeat_fibres(n, points);
  const auto shift = static_cast<std::int64_t>(n);
  const std::size_t bonds = points.bonds.size();
  repeat(times, points.bonds);
  for (std::size_t k = bonds; k < points.bonds.size(); ++k)
    for (std::int64_t& end : points.bonds[k].pair) end += static_cast<std::int64_t>(k / bonds) * shift;
  for (auto& [name, particles] : points.parts) {
    const std::size_t size = particles.size();
    repeat(times, particles);
    for (std::size_t k = size; k < particles.size(); ++k)
      particles[k] += static_cast<std::int64_t>(k / size) * shift;
  }
}

}  // namespace

double count_copies(const SpecimenSpec& spec) {
  double copies = 1.0;
  for (const CopiesSpec& row : spec.array) copies *= static_cast<double>(row.count);
  return copies;
}

void arrange(const SpecimenSpec& spec, const std::string& case_file, SpecimenPoints& points) {
  cut(spec, case_file, points);
  if (spec.turn) turn(*spec.turn, spec.place, points);
  if (spec.move != Vec3d{}) {
    for (Vec3d& r : points.r) r += spec.move;
    if (points.box) points.box->corner += spec.move;
  }
  const double total = static_cast<double>(points.r.size()) * count_copies(spec);
  if (total > static_cast<double>(keys::most_particles))
    throw CaseError({spec.place,
                     fmt::format("the array of specimen \"{}\" makes {:.0f} particles", spec.name, total),
                     "a specimen has at most 1e8", "take fewer copies"});
  for (const CopiesSpec& row : spec.array) {
    if (row.count < 1)
      throw CaseError({spec.place, fmt::format("an array of {} copies", row.count), "must be 1 or more",
                       "take at least one"});
    copy(row, points);
  }
}

}  // namespace vbond
