#include "vbond/setup/specimens/lammps_box.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vbond/setup/text_file.hpp"

namespace vbond {
namespace {

constexpr const char* tilts = "three numbers, then xy xz yz";

/// The axis whose two ends such a line gives; 3: it is not one of these.
std::size_t axis_of(const std::vector<std::string_view>& words) {
  std::size_t axis = 0;
  while (axis < 3 && !std::string_view(LammpsBox::lines[axis]).ends_with(words.back())) ++axis;
  return words.back().size() == 3 ? axis : 3;
}

Vec3d vector_of(const FileBond& bond, const SpecimenPoints& points) {
  const auto [i, j] = bond.pair;
  return between(points.r[static_cast<std::size_t>(i)], points.r[static_cast<std::size_t>(j)]);
}

}  // namespace

const char* LammpsBox::form_of(const std::vector<std::string_view>& words) {
  if (words.back() == "yz") return tilts;
  const std::size_t axis = axis_of(words);
  return axis < 3 ? lines[axis] : nullptr;
}

bool LammpsBox::read(const std::vector<std::string_view>& words) {
  if (words.back() == "yz") {
    if (words.size() != 6 || words[3] != "xy" || words[4] != "xz") return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = to_number(words[k]);
      if (!number) return false;
      tilt[k] = *number;
    }
    return true;
  }
  const std::size_t axis = axis_of(words);
  const std::vector<std::string_view> names = words_of(lines[axis]);
  if (words.size() != 4 || words[2] != names[2]) return false;
  const auto low = to_number(words[0]), high = to_number(words[1]);
  if (!low || !high || *low > *high) return false;
  period[axis] = *high - *low;
  return true;
}

Vec3d LammpsBox::nearest_image(Vec3d d) const {
  const Vec3d edges[3] = {{period[0].value_or(0.0), 0, 0},
                          {tilt[0], period[1].value_or(0.0), 0},
                          {tilt[1], tilt[2], period[2].value_or(0.0)}};
  double Vec3d::*const component[3] = {&Vec3d::x, &Vec3d::y, &Vec3d::z};
  for (std::size_t k = 3; k-- > 0;) {
    const double length = period[k].value_or(0.0);
    if (length > 0.0) d = d - std::round(d.*component[k] / length) * edges[k];
  }
  return d;
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
    points.notes.push_back(fmt::format(
        "{}: {} bonds are longer than half of the box: they join particles as these stand, not through "
        "a periodic boundary",
        file, candidates.size()));
}

}  // namespace vbond
