#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

constexpr Dimension force_per_area{-1, 1, -2, 0, "force/length^2", "5 N/m^2"},
    per_length{-1, 0, 0, 0, "1/length", "5 1/m"};

/// One number for stretching, shear, bending and torsion alike, or a list of the four.
struct OneOrFourCodec {
  NumberCodec number;
  bool read(const Node& n, ReadContext& in, const std::string& path, std::array<double, 4>& out) const {
    if (std::holds_alternative<NodeList>(n.value)) return tuple_of<4>(number).read(n, in, path, out);
    double one = 0.0;
    if (!number.read(n, in, path, one)) return false;
    out.fill(one);
    return true;
  }
  std::string write(const std::array<double, 4>& x) const {
    const bool alike = std::equal(x.begin() + 1, x.end(), x.begin());
    return alike ? number.write(x[0]) : tuple_of<4>(number).write(x);
  }
  std::string type() const { return number.type() + ", or a list of 4"; }
  std::string schema() const { return any_of({number.schema(), list_schema(number.schema(), 4, 4)}); }
  std::string example(UnitSystem u) const { return number.example(u); }
};

// ---- stretching ------------------------------------------------------------------------------------

/// A number > 0 that may be left out, which is kept as 0.
void describe_positive(Table& t, const char* name, double& value, const Dimension& d, const Need& need,
                       const char* doc) {
  std::optional<double> given;
  if (value > 0.0) given = value;
  t.key(name, given, positive(d), need, doc);
  value = given.value_or(0.0);
}

void describe_stretch(Table& t, Stretch& s) {
  t.key("form", s.form,
        ChoiceCodec<StretchForm>{{"harmonic", "cubic", "two-slopes", "fene", "morse", "table"},
                                 {StretchForm::harmonic, StretchForm::cubic, StretchForm::two_slopes,
                                  StretchForm::fene, StretchForm::morse, StretchForm::table}},
        required, "how the axial force N depends on the elongation u; c_A is its slope at u = 0");
  t.when(s.form == StretchForm::cubic, "form = \"cubic\"", [&] {
    t.key("k3", s.k3, number(force_per_area), required, "of u^2 in N = c_A u + k3 u^2 + k4 u^3");
    t.key("k4", s.k4, number(stiffness_per_area), required, "of u^3");
  });
  t.when(s.form == StretchForm::two_slopes, "form = \"two-slopes\"", [&] {
    t.key("compression", s.compression, positive(pure), required, "slope for u < 0, as a factor of c_A");
  });
  t.when(s.form == StretchForm::fene, "form = \"fene\"", [&] {
    t.key("largest", s.largest, positive(length), required,
          "elongation s at which N = c_A u/(1 - u^2/s^2) has no limit; the step allows for 0.9 s");
  });
  t.when(s.form == StretchForm::morse, "form = \"morse\"", [&] {
    t.key("alpha", s.alpha, positive(per_length), required,
          "of U = c_A/(2 alpha^2) (1 - exp(-alpha u))^2; N is largest at u = ln 2/alpha");
  });
  t.when(s.form == StretchForm::table, "form = \"table\"", [&] {
    std::vector<double> D(s.table.D, s.table.D + s.table.count), U(s.table.U, s.table.U + s.table.count);
    t.key("lengths", D, list_of(positive(length), 3), required,
          "3 to 64 lengths of the bond, increasing; beyond them N stays as it is at the end");
    t.key(
        "energies", U, list_of(number(energy), 3), required,
        "energy of stretching at each: a natural cubic spline joins them, and takes the place of c_A and a");
    const auto not_above = [](double x, double y) { return !(x < y); };
    t.check(std::adjacent_find(D.begin(), D.end(), not_above) == D.end(), {"lengths"},
            "lengths must increase from one to the next", "sort them, with their energies");
    t.check(D.size() == U.size() && D.size() <= StretchTable::most, {"lengths", "energies"},
            "must be as many lengths as energies, at most 64", "add what is missing");
    s.table.count = std::min({D.size(), U.size(), StretchTable::most});
    std::copy_n(D.begin(), s.table.count, s.table.D);
    std::copy_n(U.begin(), s.table.count, s.table.U);
    if (s.table.count >= 3) make_spline(s.table);
  });
}

// ---- damping ---------------------------------------------------------------------------------------

void describe_damping(Table& t, BondDamping& d) {
  const std::vector<std::string> forms{"ratio", "time", "coefficients"};
  constexpr std::array by{DampingBy::ratio, DampingBy::time, DampingBy::coefficients};
  const auto now = static_cast<std::size_t>(std::find(by.begin(), by.end(), d.by) - by.begin());
  const std::size_t form = t.exactly_one(forms, now % by.size());
  if (form < by.size()) d.by = by[form];
  t.when(form == 0, "ratio", [&] {
    t.key("ratio", d.values, OneOrFourCodec{not_negative(pure)}, required,
          "of critical damping of the two particles alone: one number, or [stretching, shear, bending, "
          "torsion]");
  });
  t.when(form == 1, "time", [&] {
    t.key("time", d.values, OneOrFourCodec{not_negative(duration)}, required,
          "g = time * stiffness: a mode of the body at rest has the ratio time * omega/2");
  });
  t.when(form == 2, "coefficients", [&] {
    t.table("coefficients", required, "forces and moments per rate, g", [&](Table& g) {
      g.key("g_A", d.values[0], not_negative(damping), required, "of stretching");
      g.key("g_D", d.values[1], not_negative(damping), required, "of shear");
      g.key("g_B", d.values[2], not_negative(rotary_damping), required, "of bending");
      g.key("g_T", d.values[3], not_negative(rotary_damping), required, "of torsion");
    });
  });
}

// ---- strength --------------------------------------------------------------------------------------

bool needs_section(Criterion c) {
  return c == Criterion::stress || c == Criterion::mohr_coulomb || c == Criterion::fibre;
}

Strength resolve(const StrengthSpec& s, const Section& section) {
  switch (s.criterion) {
    case Criterion::none: break;
    case Criterion::stress:
      return stress_strength(section, s.tension, s.shear, s.moment_share, s.compression);
    case Criterion::fibre: return fibre_strength(section, s.tension, s.shear, s.compression);
    case Criterion::mohr_coulomb:
      return mohr_coulomb_strength(section, s.cohesion, std::tan(s.friction_angle), s.tension, s.moments);
    case Criterion::linear:
      return linear_strength(s.axial_force, s.shear_force, s.bending_moment, s.torque,
                             s.compression_relieves);
    case Criterion::quadratic:
      return quadratic_strength(s.axial_force, s.shear_force, s.bending_moment, s.torque);
    case Criterion::energy: return energy_strength(s.tension_energy, s.other_energy);
    case Criterion::elongation: return elongation_strength(s.elongation);
  }
  return {};
}

void describe_limits(Table& t, StrengthSpec& s) {
  using enum Criterion;
  t.key("criterion", s.criterion,
        ChoiceCodec<Criterion>{
            {"stress", "mohr-coulomb", "linear", "fibre", "quadratic", "energy", "elongation"},
            {stress, mohr_coulomb, linear, fibre, quadratic, energy, elongation}},
        required, "what breaks the bond; docs/theory.md has the formulas");
  t.when(s.criterion == stress || s.criterion == fibre, "criterion = \"stress\" or \"fibre\"", [&] {
    t.key("tension", s.tension, positive(keys::stress), required, "strength against tension and bending");
    t.key("shear", s.shear, positive(keys::stress), required, "strength against shear and torsion");
    describe_positive(t, "compression", s.compression, keys::stress, default_is("compression breaks nothing"),
                      "strength against compression and bending");
  });
  t.when(s.criterion == stress, "criterion = \"stress\"", [&] {
    t.key("moment_share", s.moment_share, NumberCodec{pure, {0, 1, false, false}}, optional,
          "part of the moments that counts");
  });
  t.when(s.criterion == mohr_coulomb, "criterion = \"mohr-coulomb\"", [&] {
    t.key("cohesion", s.cohesion, positive(keys::stress), required, "shear strength without axial force");
    t.key("friction_angle", s.friction_angle, NumberCodec{angle, {0, 1.5, false, true}}, required,
          "its tangent times the compression adds to the shear strength");
    t.key("tension_limit", s.tension, positive(keys::stress), required, "tensile strength: the cut-off");
    t.key("moment_share", s.moments, NumberCodec{pure, {0, 1, false, false}},
          default_is("1 of the torque, 0 of the bending moment"),
          "part of torque and bending moment that counts; bending adds to the tension");
  });
  t.when(s.criterion == linear || s.criterion == quadratic, "criterion = \"linear\" or \"quadratic\"", [&] {
    t.key("axial_force", s.axial_force, positive(force), required, "tension that breaks alone");
    t.key("shear_force", s.shear_force, positive(force), required, "shear force that breaks alone");
    t.key("bending_moment", s.bending_moment, positive(moment), required, "bending moment that breaks alone");
    t.key("torque", s.torque, positive(moment), required, "torque that breaks alone");
  });
  t.when(s.criterion == linear, "criterion = \"linear\"", [&] {
    t.key("compression_relieves", s.compression_relieves, FlagCodec{}, optional,
          "true: N < 0 counts, and hides shear; as LAMMPS has it");
  });
  t.when(s.criterion == energy, "criterion = \"energy\"", [&] {
    t.key("tension_energy", s.tension_energy, positive(keys::energy), required, "W_1: of tension alone");
    t.key("other_energy", s.other_energy, positive(keys::energy), required,
          "W_2: of shear, bending and torsion together");
  });
  t.when(s.criterion == elongation, "criterion = \"elongation\"", [&] {
    t.key("elongation", s.elongation, positive(pure), required, "length over length at rest, less 1");
  });
}

void describe_weibull(Table& t, Weibull& w) {
  t.table(
      "weibull", optional,
      "strengths scatter: one factor for all limits of a bond, for limits that are energies its square",
      [&](Table& k) {
        k.key("modulus", w.modulus, NumberCodec{pure, {0.1, 1e6, false, false}}, required,
              "m: the larger, the less they scatter; below 0.1 factors would leave the range of doubles");
        describe_positive(
            k, "volume", w.volume, volume, default_is("size does not count"),
            "V_0 of the given limits: a bond of volume V = A a has (V_0/V)^(1/m) times these on the scale");
        k.key("seed", w.seed, seed_number, optional, "of the random factors");
      },
      w.modulus > 0.0);
}

void describe_strength(Table& t, BondSpec& b) {
  StrengthSpec& s = b.strength ? *b.strength : b.strength.emplace();
  describe_limits(t, s);
  Weibull& weibull = b.recipe.weibull;
  describe_weibull(t, weibull);
  const TheoryParameters* theory = theory_with_section(b.recipe);
  t.when(theory == nullptr, "no theory, or theory = \"shell\"", [&] {
    t.table(
        "section", default_is("required for stresses, and for a volume"), "cross-section of the bond",
        [&](Table& k) { describe_section(k, s.section ? *s.section : s.section.emplace()); },
        s.section.has_value());
  });
  const bool of_cells = theory && b.recipe.flat_joint.any();
  const bool own = theory && (theory->of_radii.any() || of_cells);
  const Section section = own ? unit_section : theory ? theory->section : s.section.value_or(Section{});
  t.check(!needs_section(s.criterion) || section.r > 0.0, {"criterion", "section"},
          "stresses need a section with the distance of its outermost fibre",
          theory ? "with shape = \"given\": add radius to the section of the theory"
                 : "add section = {shape = \"circle\", diameter = ...}");
  t.check(!(weibull.volume > 0.0) || section.A > 0.0, {"weibull", "section"},
          "a volume needs the area of a section", "add section, or leave out volume");
  weibull.area = of_cells && !theory->of_radii.any() ? theory->section.A : section.A;
  StrengthSpec limits = s;
  if (of_cells) limits.moments = 0.0;
  b.recipe.rules.strength = resolve(limits, section);
  if (own && needs_section(s.criterion)) b.recipe.rules.strength.own_section = true;
}

}  // namespace

void describe_rules(Table& t, BondSpec& b) {
  BondRecipe& recipe = b.recipe;
  t.key("prestrain", recipe.prestrain, NumberCodec{pure, {-0.5, 1, false, false}}, optional,
        "length over length at rest, less 1, when the bond is made: 0.01 pulls from the start"
        "; what that is beyond a yield limit has then flowed already, and beyond the strength is refused");
  t.table(
      "stretching", optional, "a force of stretching that is not c_A u",
      [&](Table& k) { describe_stretch(k, recipe.rules.stretch); },
      recipe.rules.stretch.form != StretchForm::harmonic);
  t.table(
      "damping", optional, "damping of the bonds, which keeps momentum: exactly one of",
      [&](Table& k) { describe_damping(k, recipe.damping); }, recipe.damping.by != DampingBy::none);
  t.table(
      "strength", optional, "what the bonds break by; without it they do not",
      [&](Table& k) { describe_strength(k, b); }, b.strength.has_value());
}

}  // namespace vbond::keys
