#include "vbond/labtest/broken_bonds.hpp"

#include <fmt/format.h>

#include <cmath>

#include "vbond/labtest/table.hpp"

namespace vbond::labtest {

std::vector<FirstBreak> breaks_of(const std::filesystem::path& folder) {
  Table table(folder / "breaks.csv");
  std::vector<FirstBreak> breaks;
  while (table.next())
    breaks.push_back({{table.number("x"), table.number("y"), table.number("z")}, table.word("mode")});
  return breaks;
}

namespace {

/// A crack that does not begin at the notch: its toughness would be that of something else.
void tell_break_off_notch(const MadeTest& test, const FirstBreak& b, TestResult& result) {
  constexpr double near = 0.25;  // of the ligament
  const double along = component(b.place, test.request.axis) - test.notch->plane;
  const double above = component(b.place, test.direction) - component(test.middle, test.direction) +
                       0.5 * test.height - test.notch->depth;
  const double off = std::hypot(along, above);
  if (off <= near * (test.height - test.notch->depth)) return;
  result.notes.push_back(
      fmt::format("the first bond breaks {:.6g} from the tip of the notch: K_Ic is that of the material only "
                  "if the crack "
                  "grows from there; make the notch deeper, or particles smaller",
                  off));
}

}  // namespace

void tell_break_of_beam(const MadeTest& test, TestResult& result) {
  const FirstBreak& b = *result.first_break_at;
  if (test.notch) return tell_break_off_notch(test, b, result);
  const Vec3d from = b.place - test.middle;
  const bool in_tension = b.mode != "shear" && b.mode != "torsion" && b.mode != "compression";
  const bool far = test.sign * component(from, test.direction) > 0.0 &&
                   std::abs(component(from, test.request.axis)) <= 0.25 * test.length;
  if (in_tension && far) return;
  result.notes.push_back(fmt::format(
      "the first bond breaks in {} at ({:.6g}, {:.6g}, {:.6g}){}: the modulus of rupture says nothing of the "
      "tensile strength",
      b.mode, b.place.x, b.place.y, b.place.z,
      far ? "" : ", not in the middle half of the side that the load stretches"));
}

std::optional<Splitting> splitting_of(const MadeTest& test, const std::vector<FirstBreak>& breaks) {
  Splitting s;
  double n = 0;
  const int third = test.third;
  const double radius = 0.5 * test.length;
  for (const auto& [at, mode] : breaks) {
    const double aside = std::abs(component(at, third) - component(test.middle, third)) / radius;
    if (n == 0) {
      s.first_from_plane = aside;
      s.first_from_middle =
          std::abs(component(at, test.direction) - component(test.middle, test.direction)) / radius;
    }
    s.mean_from_plane += aside;
    if (mode == "tension") s.in_tension += 1;
    ++n;
  }
  if (n == 0) return std::nullopt;
  s.mean_from_plane /= n, s.in_tension /= n;
  return s;
}

}  // namespace vbond::labtest
