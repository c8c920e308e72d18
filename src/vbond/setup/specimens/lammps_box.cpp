#include "vbond/setup/specimens/lammps_box.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "vbond/case/value.hpp"
#include "vbond/core/images.hpp"
#include "vbond/setup/text_file.hpp"

namespace vbond {
namespace {

constexpr const char* ends_lines[3] = {"low high xlo xhi", "low high ylo yhi", "low high zlo zhi"};
constexpr const char* vector_lines[3] = {"ax ay az avec", "bx by bz bvec", "cx cy cz cvec"};
constexpr const char* tilt_line = "three numbers, then xy xz yz";
constexpr const char* origin_line = "x y z abc origin";

/// The last word of a line.
std::string_view last_of(std::string_view line) {
  return line.substr(line.rfind(' ') + 1);
}

/// Which of three lines ends like this one; 3: none.
std::size_t axis_of(const std::vector<std::string_view>& words, const char* const (&lines)[3]) {
  std::size_t axis = 0;
  while (axis < 3 && last_of(lines[axis]) != words.back()) ++axis;
  return axis;
}

/// The numbers that a line begins with, if it goes on with these words and ends there.
template <std::size_t N>
std::optional<std::array<double, N>> numbers_before(const std::vector<std::string_view>& words,
                                                    std::initializer_list<std::string_view> names) {
  if (words.size() != N + names.size() || !std::equal(names.begin(), names.end(), words.begin() + N))
    return std::nullopt;
  std::array<double, N> numbers{};
  for (std::size_t k = 0; k < N; ++k) {
    const auto number = to_number(words[k]);
    if (!number || !(std::abs(*number) <= keys::largest_number)) return std::nullopt;
    numbers[k] = *number;
  }
  return numbers;
}

std::optional<Vec3d> as_vector(const std::optional<std::array<double, 3>>& x) {
  return x ? std::optional(Vec3d{(*x)[0], (*x)[1], (*x)[2]}) : std::nullopt;
}

double volume_of(const std::array<Vec3d, 3>& edge) {
  return dot(edge[0], cross(edge[1], edge[2]));
}

Vec3d vector_of(const FileBond& bond, const SpecimenPoints& points) {
  const auto [i, j] = bond.pair;
  return between(points.r[static_cast<std::size_t>(i)], points.r[static_cast<std::size_t>(j)]);
}

}  // namespace

const char* LammpsBox::form_of(const std::vector<std::string_view>& words) {
  if (words.back() == "yz") return tilt_line;
  if (words.back() == "origin") return origin_line;
  if (const std::size_t k = axis_of(words, vector_lines); k < 3) return vector_lines[k];
  const std::size_t k = axis_of(words, ends_lines);
  return k < 3 ? ends_lines[k] : nullptr;
}

bool LammpsBox::read(const std::vector<std::string_view>& words) {
  if (words.back() == "yz") return (tilt = numbers_before<3>(words, {"xy", "xz", "yz"})).has_value();
  if (words.back() == "origin")
    return (origin = as_vector(numbers_before<3>(words, {"abc", "origin"}))).has_value();
  if (const std::size_t k = axis_of(words, vector_lines); k < 3)
    return (vectors[k] = as_vector(numbers_before<3>(words, {words.back()}))).has_value();
  const std::size_t k = axis_of(words, ends_lines);
  const auto names = words_of(ends_lines[k]);
  const auto found = numbers_before<2>(words, {names[2], names[3]});
  if (!found || (*found)[0] > (*found)[1]) return false;
  ends[k] = found;
  return true;
}

std::string LammpsBox::mistake() const {
  if (!is_general()) return {};
  if (ends[0] || ends[1] || ends[2] || tilt) return "the box is given by its ends and by vectors";
  for (std::size_t k = 0; k < 3; ++k)
    if (!vectors[k]) return fmt::format("the box has no {}", last_of(vector_lines[k]));
  if (!origin) return "the box has no abc origin";
  const std::array<Vec3d, 3> edges{*vectors[0], *vectors[1], *vectors[2]};
  if (whole()) return {};
  return fmt::format("the vectors of the box span the volume {}", volume_of(edges));
}

std::optional<Vec3d> LammpsBox::edge(std::size_t k) const {
  if (is_general()) return vectors[k];
  if (!ends[k]) return std::nullopt;
  const double length = (*ends[k])[1] - (*ends[k])[0];
  const std::array<double, 3> xy_xz_yz = tilt.value_or(std::array<double, 3>{});
  if (k == 0) return Vec3d{length, 0, 0};
  return k == 1 ? Vec3d{xy_xz_yz[0], length, 0} : Vec3d{xy_xz_yz[1], xy_xz_yz[2], length};
}

const char* LammpsBox::line_of_edge(std::size_t k) const {
  return is_general() ? vector_lines[k] : ends_lines[k];
}

std::optional<FileBox> LammpsBox::whole() const {
  FileBox box;
  double lengths = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::optional<Vec3d> found = edge(k);
    if (!found) return std::nullopt;
    box.edges[k] = *found;
    lengths *= norm(*found);
  }
  if (!(volume_of(box.edges) > 1e-6 * lengths)) return std::nullopt;
  if (is_general())
    box.corner = origin.value_or(Vec3d{});
  else
    box.corner = {(*ends[0])[0], (*ends[1])[0], (*ends[2])[0]};
  return box;
}

Vec3d LammpsBox::nearest_image(const Vec3d& d) const {
  CellEdges cell(3);
  Periodic periodic{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d along = edge(k).value_or(Vec3d{});
    periodic[k] = component(along, static_cast<int>(k)) != 0.0 || is_general();
    cell[k].along = periodic[k] ? along : Vec3d{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
  }
  const Vec3d h = heights(cell);
  double shortest = INFINITY;  // of the periods
  for (std::size_t k = 0; k < 3; ++k)
    if (periodic[k]) shortest = std::min(shortest, component(h, static_cast<int>(k)));
  if (norm(d) < 0.5 * shortest) return d;  // no image is nearer
  const Vec3d half = 0.5 * (cell[0].along + cell[1].along + cell[2].along);
  const Vec3d inside = d + to_image(cell, image_in_cell(cell, periodic, -half, d));
  if (norm(inside) > 100.0 * shortest) return inside;  // long in a flat box: there are too many images to try
  return d + to_image(cell, vbond::nearest_image(cell, periodic, {}, d));
}

void find_bonds_across(const LammpsBox& box, const std::string& file, SpecimenPoints& points) {
  if (points.bonds.empty()) return;
  std::vector<double> across;
  for (const FileBond& bond : points.bonds)
    across.push_back(norm(box.nearest_image(vector_of(bond, points))));
  std::vector<double> sorted = across;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double usual = *middle;
  std::vector<std::size_t> candidates;
  double longest = 0.0;
  for (std::size_t k = 0; k < across.size(); ++k) {
    const double length = norm(vector_of(points.bonds[k], points));
    if (!(across[k] < (1.0 - 1e-9) * length) || across[k] < 0.5 * usual || across[k] > 2.0 * usual) continue;
    candidates.push_back(k);
    longest = std::max(longest, length);
  }
  if (longest > 2.5 * usual)
    for (const std::size_t k : candidates) points.bonds[k].across = across[k];
  else if (!candidates.empty())
    points.notes_on_open_bodies.push_back(fmt::format(
        "{}: {} bonds are longer than half of the box: they join particles as these stand, not through "
        "a periodic boundary",
        file, candidates.size()));
}

}  // namespace vbond
