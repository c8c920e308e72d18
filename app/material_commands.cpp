#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
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
#include "vbond/model/cell_drive.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/statics/calibrate_cell.hpp"

namespace vbond::app {
namespace {

using Json = nlohmann::ordered_json;

Json of(const IsotropicConstants& m) {
  return {{"K", m.K}, {"G", m.G}, {"E", m.E()}, {"nu", m.nu()}};
}
Json of(const Vec3d& a) {
  return {a.x, a.y, a.z};
}

constexpr std::pair<const char*, Vec3d> axes[] = {{"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"z", {0, 0, 1}}};

Json json_of(const Homogenised& h, const ElasticConstants* C) {
  Json j{{"particles", h.particles},
         {"bonds", h.bonds},
         {"floating", h.floating},
         {"volume", h.volume},
         {"density", h.density},
         {"stress", h.stress},
         {"moved", h.moved},
         {"solver", h.solver},
         {"order", cell_component_names},
         {"C", h.C}};
  if (C == nullptr) return j;
  j["S"] = C->compliance();
  j["voigt"] = of(C->voigt()), j["reuss"] = of(C->reuss()), j["hill"] = of(C->hill());
  j["anisotropy"] = C->anisotropy();
  for (const auto& [name, n] : axes) j["E"][name] = C->youngs_modulus(n);
  const Directed least = C->least_youngs_modulus(), most = C->largest_youngs_modulus();
  j["E"]["least"] = least.value, j["E"]["least_along"] = of(least.along);
  j["E"]["largest"] = most.value, j["E"]["largest_along"] = of(most.along);
  for (const auto& [name, n] : axes)
    for (const auto& [other, m] : axes)
      if (name != other) {
        j["nu"][std::string(name) + other] = C->poissons_ratio(n, m);
        if (name < other) j["G"][std::string(name) + other] = C->shear_modulus(n, m);
      }
  for (const auto& [name, n] : axes)
    for (const Directed& wave : C->wave_speeds(n, h.density)) j["wave_speeds"][name].push_back(wave.value);
  return j;
}

void print_isotropic(const char* name, const IsotropicConstants& m) {
  fmt::print("  {:<8} {:<14.7g} {:<14.7g} {:<14.7g} {:<.6f}\n", name, m.K, m.G, m.E(), m.nu());
}

void print_directions(const ElasticConstants& C, double density) {
  const Directed least = C.least_youngs_modulus(), most = C.largest_youngs_modulus();
  fmt::print("\nYoung's modulus  x {:.7g}   y {:.7g}   z {:.7g}\n", C.youngs_modulus(axes[0].second),
             C.youngs_modulus(axes[1].second), C.youngs_modulus(axes[2].second));
  for (const auto& [name, at] : {std::pair{"least", least}, std::pair{"largest", most}})
    fmt::print("  {:<14} {:.7g} along ({:.4f}, {:.4f}, {:.4f})\n", name, at.value, at.along.x, at.along.y,
               at.along.z);
  fmt::print("Waves, two of shear and one of pressure where directions allow\n");
  for (const auto& [name, n] : axes) {
    const WaveSpeeds v = C.wave_speeds(n, density);
    fmt::print("  along {}        {:.6g}   {:.6g}   {:.6g}\n", name, v[0].value, v[1].value, v[2].value);
  }
}

void print(const Homogenised& h, const ElasticConstants* C, UnitSystem units) {
  const bool si = units == UnitSystem::si;
  fmt::print("{} particles, {} bonds; volume {:.6g}{}, density {:.6g}{}; solver {}\n", h.particles, h.bonds,
             h.volume, si ? " m^3" : "", h.density, si ? " kg/m^3" : "", h.solver);
  if (h.floating > 0)
    fmt::print("{} particles are of parts that hang together with none of their images: they carry nothing\n",
               h.floating);
  if (h.moved) fmt::print("The body was not in balance as the case makes it: this is the balance near it.\n");
  fmt::print("Stress{}  xx {:.4g}   yy {:.4g}   zz {:.4g}   yz {:.4g}   xz {:.4g}   xy {:.4g}\n",
             si ? " [Pa]" : "", h.stress[0], h.stress[1], h.stress[2], h.stress[3], h.stress[4], h.stress[5]);
  fmt::print("\nC{}: xx yy zz yz xz xy, engineering shear\n", si ? " [Pa]" : "");
  for (const auto& row : h.C)
    fmt::print(" {:14.6g}{:14.6g}{:14.6g}{:14.6g}{:14.6g}{:14.6g}\n", row[0], row[1], row[2], row[3], row[4],
               row[5]);
  if (C == nullptr) return;
  fmt::print("\nIsotropic  K              G              E              nu\n");
  print_isotropic("Voigt", C->voigt());
  print_isotropic("Reuss", C->reuss());
  print_isotropic("Hill", C->hill());
  fmt::print("Anisotropy 5 G_V/G_R + K_V/K_R - 6 = {:.6g}\n", C->anisotropy());
  print_directions(*C, h.density);
}

/// Nothing where some strain has no stiffness, or stress has left C without symmetry; `why` says so.
std::optional<ElasticConstants> constants_of(const Homogenised& h, std::string& why) {
  try {
    return ElasticConstants(h.C);
  } catch (const std::invalid_argument& e) {
    why = e.what();
    return std::nullopt;
  }
}

/// A case whose cell is a piece of a material, and what it is made of.
std::pair<Case, Built> body_of(const RunOptions& options) {
  Case c = read_case(options.case_file, options.changes);
  Built built = build(c);
  if (!built.model.cell.any() || open_axes(built.model.cell) != std::array<bool, 3>{})
    throw CaseError(Problem{{c.file, 0, 0},
                            "the body has no periodic cell, or one that is open in some direction",
                            "constants are those of a cell that repeats in all three directions",
                            "give a [cell]: docs/cell.md"});
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

int homogenise(const RunOptions& options) {
  const auto [c, built] = body_of(options);
  const Homogenised found = homogenise(built.model, built.state);
  std::string why;
  const std::optional<ElasticConstants> C = constants_of(found, why);
  const ElasticConstants* known = C ? &*C : nullptr;
  if (options.json) {
    fmt::print("{}\n", json_of(found, known).dump(2));
  } else {
    print_notes(built.notes);
    print(found, known, built.model.units);
  }
  if (!C) fmt::print(stderr, "vbond: nothing else follows from these constants: {}\n", why);
  return done;
}

}  // namespace vbond::app
