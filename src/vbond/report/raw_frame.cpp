// What the files of a frame say of particles and bonds.
#include <algorithm>
#include <numbers>
#include <string_view>

#include "vbond/report/detail/raw_frame.hpp"

namespace vbond::page {
namespace {

using Per = FrameInput::Per;

constexpr double radians = std::numbers::pi / 180.0;

bool have_all(const FrameInput& bonds, std::size_t from, std::size_t to) {
  return std::all_of(bond_fields.begin() + static_cast<std::ptrdiff_t>(from),
                     bond_fields.begin() + static_cast<std::ptrdiff_t>(to),
                     [&bonds](const BondField& f) { return bonds.has(Per::cell, f.array); });
}

/// Displacements of a mode are from its first frame.
std::vector<Vec3d> displacement_in(const FrameInput& particles, const std::vector<Vec3d>* about) {
  if (!about) return particles.vectors(Per::point, "displacement");
  std::vector<Vec3d> d = particles.vectors(Per::point, "Points");
  for (std::size_t p = 0; p < d.size(); ++p) d[p] = d[p] - (*about)[p];
  return d;
}

std::vector<double> field_in(const FrameInput& bonds, const BondField& field) {
  std::vector<double> values = bonds.scalars(Per::cell, field.array);
  for (double& x : values) x *= field.scale;
  if (std::string_view(field.key) != "elongation") return values;
  const std::vector<double> at_rest = bonds.scalars(Per::cell, "length_at_rest");
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = at_rest[k] > 0.0 ? values[k] / at_rest[k] : 0.0;
  return values;
}

/// The shape of a broken bond, whose ends fly apart, says nothing.
void clear_bond(std::size_t b, RawFrame& f) {
  for (std::vector<double>& values : f.fields)
    if (!values.empty()) values[b] = 0.0;
  f.range[b] = 0;
}

}  // namespace

const std::array<BondField, bond_field_count> bond_fields{{
    {"elongation", "elongation", "elongation", 1.0, true, ""},
    {"bend", "bend angle", "bend", radians, false, "rad"},
    {"twist", "twist angle", "twist", radians, true, "rad"},
    {"U_L", "energy of stretching", "U_L", 1.0, false, "J"},
    {"U_B", "energy of bending and shear", "U_B", 1.0, false, "J"},
    {"U_T", "energy of torsion", "U_T", 1.0, false, "J"},
    {"utilisation", "utilisation of the strength", "utilisation", 1.0, false, ""},
    {"axial_force", "axial force, tension is positive", "axial_force", 1.0, true, "N"},
    {"shear_force", "shear force", "shear_force", 1.0, false, "N"},
    {"bending_moment", "bending moment at the middle", "bending_moment", 1.0, false, "N m"},
    {"torque", "torque", "torque", 1.0, true, "N m"},
    {"plastic_elongation", "plastic elongation", "plastic_elongation", 1.0, true, "m"},
    {"creep", "elongation by creep", "creep", 1.0, true, "m"},
    {"plastic_bend", "plastic bend angle", "plastic_bend", radians, false, "rad"},
    {"plastic_twist", "plastic twist angle", "plastic_twist", radians, true, "rad"},
    {"axial_flow", "all axial yielding so far", "axial_flow", 1.0, false, "m"},
    {"shear_flow", "all yielding in shear so far", "shear_flow", 1.0, false, "m"},
    {"bending_flow", "all yielding in bending so far", "bending_flow", radians, false, "rad"},
    {"torsion_flow", "all yielding in torsion so far", "torsion_flow", radians, false, "rad"},
    {"damage", "damage", "damage", 1.0, false, ""},
}};

std::vector<std::size_t> numbers_of_some(const FrameInput& particles, std::size_t all) {
  std::vector<std::size_t> numbers;
  if (particles.points() == all) return numbers;
  for (const std::int64_t id : particles.integers(Per::point, "id"))
    numbers.push_back(static_cast<std::size_t>(id));
  return numbers;
}

bool tells_of_breaks(const FrameInput& particles, const FrameInput& bonds) {
  return particles.has(Per::point, "fragment") && bonds.has(Per::cell, "broken") &&
         have_all(bonds, 0, fields_with_breaks);
}

bool tells_of_flow(const FrameInput& bonds) {
  return have_all(bonds, fields_with_breaks, bond_field_count);
}

RawFrame read_frame(const FrameInput& particles, const FrameInput& bonds, const std::vector<Vec3d>* about,
                    std::size_t all) {
  RawFrame f;
  f.step = particles.step();
  f.displacement = displacement_in(particles, about);
  for (const Vec3d& v : particles.vectors(Per::point, "velocity")) f.speed.push_back(norm(v));
  const bool some = particles.points() != all;
  const std::vector<std::size_t> numbers = numbers_of_some(particles, all);
  if (some) {
    f.there.assign(all, 0);
    for (const std::size_t p : numbers) f.there[p] = 1;
    spread(numbers, all, f.displacement), spread(numbers, all, f.speed);
  }
  const bool may_break = tells_of_breaks(particles, bonds);
  const bool flows = tells_of_flow(bonds);
  for (std::size_t k = 0; k < bond_field_count; ++k)
    if (k < fields_of_all_runs || (k < fields_with_breaks ? may_break : flows))
      f.fields[k] = field_in(bonds, bond_fields[k]);
  f.range = bonds.bytes(Per::cell, "range");
  if (!may_break) return f;
  f.fragment = particles.integers(Per::point, "fragment");
  if (some) spread(numbers, all, f.fragment);
  f.broken = bonds.bytes(Per::cell, "broken");
  for (std::size_t b = 0; b < f.broken.size(); ++b)
    if (f.broken[b] != 0) clear_bond(b, f);
  return f;
}

std::size_t count_without_length(const FrameInput& bonds) {
  const std::vector<double> at_rest = bonds.scalars(Per::cell, "length_at_rest");
  return static_cast<std::size_t>(std::count(at_rest.begin(), at_rest.end(), 0.0));
}

}  // namespace vbond::page
