#include "vbond/case/calibration.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/arguments.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/make_bond.hpp"

namespace vbond {
namespace {

struct Theory {
  const char* name;
  BondTheory theory;
  const char* limits;
};
constexpr Theory theories[] = {
    {"bernoulli-euler", BondTheory::bernoulli_euler,
     "slender bonds, length / thickness above about 5; shear deformation is left out"},
    {"timoshenko", BondTheory::timoshenko,
     "length / thickness above about 1; needs a shear coefficient kappa"},
    {"short-cylinder", BondTheory::short_cylinder,
     "bonds shorter than they are thick, ends rigid, strain uniaxial; qualitative; nu < 0.5"},
    {"shell", BondTheory::shell,
     "bonds of a triangular sheet that stands for a thin wall, nu < 1/3; transverse shear is not the wall's"},
};  // parallel bonds have no material: published_bonds.hpp

/// An option that the section does not have would be ignored: better told.
void refuse_foreign(const CalibrateOptions& o, Arguments& arguments) {
  const auto refuse = [&](const char* option, const std::string& text, const std::string& its_own,
                          const char* with) {
    if (!text.empty() && its_own.empty())
      arguments.problem(option, text, std::string("belongs to a section given by ") + with,
                        std::string("leave it out, or give ") + with);
  };
  refuse("--inner-diameter", o.inner_diameter, o.diameter, "--diameter");
  refuse("--J", o.J, o.A, "--A");
  refuse("--J_p", o.J_p, o.A, "--A");
}

/// A shell has a thickness instead of a section: nothing but a shell is asked for with it.
bool is_shell(const CalibrateOptions& o) {
  return o.theory == "shell" || (o.theory == "all" && !o.thickness.empty());
}

double thickness(const CalibrateOptions& o, Arguments& arguments) {
  if (!is_shell(o)) {
    if (!o.thickness.empty())
      arguments.problem("--thickness", o.thickness, "belongs to --theory shell",
                        "leave it out, or take that theory");
    return 0.0;
  }
  const std::pair<const char*, const std::string*> foreign[] = {{"--diameter", &o.diameter},
                                                                {"--inner-diameter", &o.inner_diameter},
                                                                {"--side", &o.side},
                                                                {"--A", &o.A},
                                                                {"--J", &o.J},
                                                                {"--J_p", &o.J_p},
                                                                {"--kappa", &o.kappa}};
  for (const auto& [option, text] : foreign)
    if (!text->empty())
      arguments.problem(option, *text, "belongs to a section, and theory shell has a thickness instead",
                        "leave it out, or --thickness");
  if (!o.thickness.empty()) return arguments.positive(o.thickness, "--thickness", keys::length);
  arguments.problem("--theory", "shell", "needs --thickness", "e.g. --thickness \"1 mm\"");
  return 0.0;
}

Section section(const CalibrateOptions& o, Arguments& arguments) {
  const int given = !o.diameter.empty() + !o.side.empty() + !o.A.empty();
  refuse_foreign(o, arguments);
  if (given != 1)
    arguments.problem("the section", "", "needs exactly one of --diameter, --side, --A",
                      "e.g. --diameter \"1 mm\"");
  if (!o.side.empty()) return square(arguments.positive(o.side, "--side", keys::length));
  if (!o.A.empty()) {
    if (o.J.empty() || o.J_p.empty())
      arguments.problem("--A", o.A, "needs --J and --J_p with it", "give all three");
    return {arguments.positive(o.A, "--A", keys::area),
            o.J.empty() ? NAN : arguments.positive(o.J, "--J", keys::area_moment),
            o.J_p.empty() ? NAN : arguments.positive(o.J_p, "--J_p", keys::area_moment)};
  }
  if (o.diameter.empty()) return {};
  const double d = arguments.positive(o.diameter, "--diameter", keys::length);
  if (o.inner_diameter.empty()) return circle(d);
  const double inner = arguments.number(o.inner_diameter, "--inner-diameter", keys::length);
  if (inner < 0.0)
    arguments.problem("--inner-diameter", o.inner_diameter, "must be >= 0", "0 is a full circle");
  if (inner >= d)
    arguments.problem("--inner-diameter", o.inner_diameter, "must be below --diameter", "use a smaller one");
  return annulus(d, inner);
}

/// Also as an annulus without a hole.
bool is_full_circle(const CalibrateOptions& o) {
  if (o.diameter.empty()) return false;
  if (o.inner_diameter.empty()) return true;
  const auto inner = keys::parse_quantity(o.inner_diameter);
  return std::holds_alternative<keys::Quantity>(inner) && std::get<keys::Quantity>(inner).value == 0.0;
}

CalibratedTheory calibrated(const Theory& t, const TheoryParameters& p, double a) {
  BondRecipe recipe;
  recipe.parameters = p;
  CalibratedTheory all{
      .name = t.name, .limits = t.limits, .left_out = {}, .c = stiffness_of(recipe, a), .laws = {}};
  for (const BondLaw* law : named_laws()) {
    const Coefficients values = law->from_stiffness(all.c, a, {});
    auto& [name, coefficients] =
        all.laws.emplace_back(std::string(law->name), std::vector<std::pair<std::string, double>>{});
    for (std::size_t k = 0; k < law->fields.size(); ++k)
      if (law->fields[k].input == LawInput::from_stiffness)
        coefficients.emplace_back(std::string(law->fields[k].name), values[k]);
  }
  return all;
}

}  // namespace

Material material_asked_for(const CalibrateOptions& o, UnitSystem units) {
  Arguments arguments;
  if (o.E.empty())
    arguments.problem("--E", "", "is required: the Young's modulus of the body", "e.g. --E \"69 GPa\"");
  const Material m{o.E.empty() ? 1.0 : arguments.positive(o.E, "--E", keys::stress),
                   o.nu.empty() ? 0.2 : arguments.number(o.nu, "--nu", keys::pure)};
  if (o.nu.empty())
    arguments.problem("--nu", "", "is required: Poisson's ratio of the body", "e.g. --nu 0.26");
  if (units == UnitSystem::reduced && o.E.find_first_not_of("0123456789.eE+-") != std::string::npos)
    arguments.problem("--E", o.E, "has a unit, and the case is in reduced units", "write a bare number");
  if (o.theory != "all")
    arguments.problem("--theory", o.theory, "belongs to a single bond, and a case has its own",
                      "leave it out");
  if (!(m.nu > -1.0 && m.nu < 0.5))
    arguments.problem("--nu", o.nu, "must satisfy -1 < nu < 0.5", "rock has 0.2 to 0.3, glass 0.2");
  const std::pair<const char*, const std::string*> of_a_bond[] = {{"--length", &o.length},
                                                                  {"--diameter", &o.diameter},
                                                                  {"--inner-diameter", &o.inner_diameter},
                                                                  {"--side", &o.side},
                                                                  {"--A", &o.A},
                                                                  {"--J", &o.J},
                                                                  {"--J_p", &o.J_p},
                                                                  {"--kappa", &o.kappa},
                                                                  {"--thickness", &o.thickness}};
  for (const auto& [option, text] : of_a_bond)
    if (!text->empty())
      arguments.problem(option, *text, "belongs to a single bond, and a case has its own", "leave it out");
  arguments.throw_if_any();
  return m;
}

Calibration calibration(const CalibrateOptions& o) {
  Arguments arguments;
  const auto needed = [&](const std::string& text, const char* option, const keys::Dimension& d) {
    if (!text.empty()) return arguments.positive(text, option, d);
    arguments.problem(option, "", "is required, unless parameters come --from another program",
                      std::string("e.g. ") + option + " \"" + d.example + "\"");
    return 1.0;
  };
  const Material material{needed(o.E, "--E", keys::stress), arguments.number(o.nu, "--nu", keys::pure)};
  const double a = needed(o.length, "--length", keys::length);
  const double h = thickness(o, arguments);
  const Section s = is_shell(o) ? Section{} : section(o, arguments);
  if (is_shell(o) && material.nu > -1.0 && 3.0 * material.nu >= 1.0)
    arguments.problem("--nu", o.nu, "must be < 1/3: a triangular sheet has no larger one", "use nu <= 0.33");
  else if (material.nu <= -1.0 || material.nu > 0.5)
    arguments.problem("--nu", o.nu, "must satisfy -1 < nu <= 0.5", "steel has 0.3, glass 0.2, rubber 0.5");
  if (o.theory == "short-cylinder" && material.nu == 0.5)
    arguments.problem("--nu", o.nu, "the short cylinder divides by 1 - 2 nu",
                      "use nu <= 0.49, or another theory");
  std::optional<double> kappa;
  if (!o.kappa.empty())
    kappa = arguments.positive(o.kappa, "--kappa", keys::pure);
  else if (is_full_circle(o))
    kappa = hutchinson_circle(material.nu);
  else if (o.theory == "timoshenko")
    arguments.problem("--theory", "timoshenko", "needs --kappa for this section",
                      "e.g. --kappa 0.85 for a square");
  arguments.throw_if_any();

  Calibration all{.material = material, .section = s, .thickness = h, .length = a, .theories = {}};
  for (const Theory& t : theories) {
    if ((t.theory == BondTheory::shell) != is_shell(o)) continue;
    if (o.theory != "all" && o.theory != t.name) continue;
    const auto left_out = [&](const char* why) {
      all.theories.push_back({.name = t.name, .limits = t.limits, .left_out = why, .c = {}, .laws = {}});
    };
    if (t.theory == BondTheory::timoshenko && !kappa)
      left_out("this section needs --kappa");
    else if (t.theory == BondTheory::short_cylinder && material.nu == 0.5)
      left_out("it divides by 1 - 2 nu");
    else
      all.theories.push_back(calibrated(t, {t.theory, material, s, kappa.value_or(0.0), h}, a));
  }
  return all;
}

}  // namespace vbond
