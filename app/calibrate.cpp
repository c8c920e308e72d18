#include <fmt/core.h>

#include <cmath>
#include <string>

#include "commands.hpp"
#include "vbond/case/calibration.hpp"

namespace vbond::app {
namespace {

void print_given(const Calibration& all) {
  const Section& s = all.section;
  if (all.thickness > 0.0)
    return fmt::print("E {:.8g}   nu {:.6g}   thickness {:.8g}   length {:.8g}\n", all.material.E,
                      all.material.nu, all.thickness, all.length);
  const double thickness = 4.0 * std::sqrt(s.J / s.A);
  fmt::print(
      "E {:.8g}   nu {:.6g}   A {:.8g}   J {:.8g}   J_p {:.8g}   length {:.8g}   length / thickness {:.3g}\n",
      all.material.E, all.material.nu, s.A, s.J, s.J_p, all.length, all.length / thickness);
  fmt::print("Thickness is 4 sqrt(J / A): the diameter of a circle with this A and J.\n");
}

void print(const CalibratedTheory& t) {
  if (!t.left_out.empty()) return fmt::print("\n{}  left out: {}\n", t.name, t.left_out);
  fmt::print("\n{}  ({})\n", t.name, t.limits);
  fmt::print("  stiffness  c_A {:<14.8g} c_D {:<14.8g} c_B {:<14.8g} c_T {:<14.8g}\n", t.c.c_A, t.c.c_D,
             t.c.c_B, t.c.c_T);
  for (const auto& [law, coefficients] : t.laws) {
    std::string text = fmt::format("  {:<10}", law);
    for (const auto& [name, value] : coefficients) text += fmt::format(" {:<3} {:<14.8g}", name, value);
    fmt::print("{}\n", text);
  }
}

}  // namespace

int calibrate(const CalibrateOptions& o, const PublishedBonds& published) {
  if (!published.program.empty()) {
    fmt::print("# Units follow from those given: SI base units where units are named.\n{}",
               bonds_as_published(published));
    return done;
  }
  const Calibration all = calibration(o);
  print_given(all);
  fmt::print("Units follow from those given: SI base units where units are named.\n");
  for (const CalibratedTheory& t : all.theories) print(t);
  fmt::print(
      "\nThe four stiffnesses hold for small deformation about rest; beyond about 10 degrees of bend or "
      "twist see docs/theory.md.\n");
  return done;
}

}  // namespace vbond::app
