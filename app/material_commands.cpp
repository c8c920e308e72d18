#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "prepare.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/statics/calibrate_cell.hpp"

namespace vbond::app {
namespace {

/// A case whose cell is a piece of a material, and what it is made of.
std::pair<Case, Built> body_of(const RunOptions& options) {
  Case c = read_case(options.case_file, options.changes);
  Built built = build(c);
  if (!built.model.cell.any() || open_axes(built.model.cell) != std::array<bool, 3>{})
    throw CaseError(Problem{{c.file, 0, 0},
                            "the body has no periodic cell, or one that is open in some direction",
                            "bonds are calibrated in a cell that repeats in all three directions",
                            "calibrate a cell of the same grains, and give its bonds to the body: "
                            "docs/cell.md; vbond homogenise says what E and nu the body has now, and "
                            "--tensile, --compressive and --toughness are for bodies without a cell"});
  return {std::move(c), std::move(built)};
}

BendingFollows bending_of(const std::string& word) {
  if (word == "normal") return BendingFollows::normal;
  return word == "shear" ? BendingFollows::shear : BendingFollows::area;
}

/// What the keys of each set of bonds are to be.
void print_factors(const Case& c, const State& state, const StiffnessFactors& f, BendingFollows bending) {
  const BondStiffness<double> m = multipliers(f, bending);
  std::vector<char> made(c.bonds.size(), 0);
  for (const Bond& b : state.bonds)
    if (b.set < made.size()) made[b.set] = 1;
  for (std::size_t k = 0; k < made.size(); ++k) {
    if (made[k] == 0) continue;
    const BondSpec& spec = c.bonds[k];
    const BondStiffness<double>& had = spec.recipe.factors;
    fmt::print("\n[[bonds]]  # {}\n", printable(spec.name));
    const auto* theory = std::get_if<TheoryParameters>(&spec.recipe.parameters);
    const bool per_area = theory != nullptr && theory->theory == BondTheory::parallel &&
                          !theory->per_area.of_modulus() && theory->per_area.grain_k_n == 0.0 &&
                          theory->per_area.grain_k_s == 0.0 && bending == BendingFollows::area;
    if (per_area)
      fmt::print("k_n = {:.10g}\nk_s = {:.10g}\n", f.normal * theory->per_area.k_n,
                 f.shear * theory->per_area.k_s);
    else
      fmt::print("stiffness_factors = {{ c_A = {:.10g}, c_D = {:.10g}, c_B = {:.10g}, c_T = {:.10g} }}\n",
                 m.c_A * had.c_A, m.c_D * had.c_D, m.c_B * had.c_B, m.c_T * had.c_T);
  }
}

}  // namespace

int calibrate_body(const RunOptions& options, const CalibrateOptions& material, const std::string& bending) {
  const auto [c, built] = body_of(options);
  const Material asked = material_asked_for(material, c.units);
  for (const BondSpec& spec : c.bonds)
    if (std::holds_alternative<GivenCoefficients>(spec.recipe.parameters))
      throw CaseError(Problem{{c.file, 0, 0},
                              fmt::format("bonds {} have coefficients of their law", printable(spec.name)),
                              "factors are those of stiffnesses",
                              "give stiffness = { c_A, c_D, c_B, c_T }, or a theory"});
  const BendingFollows follows = bending_of(bending);
  for (const BondSpec& spec : c.bonds)
    if (spec.recipe.flat_joint.any() && follows != BendingFollows::area)
      throw CaseError(
          Problem{spec.place,
                  fmt::format("bonds {} are flat joints, and --bending is {}", printable(spec.name), bending),
                  "a flat joint bends and twists by the springs of its cells", "leave --bending out"});
  try {
    const CalibratedCell found = calibrate_cell(built.model, built.state, {asked.E, asked.nu}, follows);
    const ElasticConstants C(found.found.C);
    print_notes(built.notes);
    fmt::print("E {:.10g} and nu {:.10g} (Hill's average) after {} bodies; anisotropy {:.3g}\n", C.hill().E(),
               C.hill().nu(), found.iterations, C.anisotropy());
    print_factors(c, built.state, found.factors, follows);
    return done;
  } catch (const OutOfReach& e) {
    fmt::print(stderr, "vbond: {}\n  the nearest, nu = {:.6g} with E as asked for, takes:\n", e.what(), e.nu);
    print_factors(c, built.state, e.nearest, follows);
    return failed;
  }
}

}  // namespace vbond::app
