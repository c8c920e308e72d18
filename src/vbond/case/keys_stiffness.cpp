#include <utility>

#include "vbond/case/keys.hpp"

/// Stiffnesses of bonds: as numbers, or by a theory from a material and a section.
namespace vbond::keys {
namespace {

enum class Shape : unsigned char { circle, annulus, square, given };

/// A section as the file names it; resolved to A, J, J_p once, and written as these. One that follows radii
/// is a circle with a factor.
struct SectionForm {
  Shape shape = Shape::given;
  double diameter = 0, inner_diameter = 0, side = 0;
  SectionOfRadii of_radii;
};

Section resolve(const SectionForm& form, const Section& given) {
  switch (form.shape) {
    case Shape::circle: return circle(form.diameter);
    case Shape::annulus: return annulus(form.diameter, form.inner_diameter);
    case Shape::square: return square(form.side);
    case Shape::given: break;
  }
  return given;
}

/// A shear coefficient: a number, or Hutchinson's, which depends on nu and the section.
struct Kappa {
  double value = 0;
  bool is_hutchinson = false;
};

struct KappaCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, Kappa& out) const {
    const auto* word = std::get_if<std::string>(&n.value);
    out.is_hutchinson = word != nullptr;
    std::size_t index = 0;
    return word ? read_word(n, in, path, {"hutchinson"}, index) : positive(pure).read(n, in, path, out.value);
  }
  std::string write(const Kappa& k) const { return number_text(k.value); }
  std::string type() const { return "number > 0, or \"hutchinson\""; }
  std::string schema() const { return any_of({above_zero.schema(), enum_schema({"hutchinson"})}); }
  std::string example(UnitSystem) const { return "0.9"; }
};

/// The diameter of a section. One that follows radii has a key of its own.
struct DiameterCodec : NumberCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, double& out) const {
    const auto* word = std::get_if<std::string>(&n.value);
    if (word && *word == "particles")
      return in.refuse(
          n, path, "must be a length: a section that follows the radii of the two particles has a factor",
          "write factor = 1 in place of diameter, in the section of a theory: the radius of the section over "
          "the smaller radius of the two particles");
    return NumberCodec::read(n, in, path, out);
  }
};

void describe_circle(Table& t, SectionForm& form) {
  const std::size_t by = t.exactly_one({"diameter", "factor"}, form.of_radii.any() ? 1 : 0);
  t.when(by == 0, "shape = \"circle\"", [&] {
    t.key("diameter", form.diameter, DiameterCodec{positive(length)}, required,
          "of all bonds; a circle has exactly one of diameter and factor");
  });
  t.when(by == 1, "shape = \"circle\" and factor", [&] {
    t.key("factor", form.of_radii.factor, positive(pure), required,
          "radius of the section over the radius that `of` says; strengths in stresses are those of each "
          "bond's own section");
    t.key("of", form.of_radii.of_mean, ChoiceCodec<bool>{{"smaller", "mean"}, {false, true}}, optional,
          "the smaller radius of the two particles, or their mean");
  });
}

/// may_follow: the section may follow radii.
void describe_form(Table& t, SectionForm& form, Section& section, bool may_follow) {
  t.key("shape", form.shape,
        ChoiceCodec<Shape>{{"circle", "annulus", "square", "given"},
                           {Shape::circle, Shape::annulus, Shape::square, Shape::given}},
        required, "form of the cross-section");
  if (may_follow)
    t.when(form.shape == Shape::circle, "shape = \"circle\"", [&] { describe_circle(t, form); });
  else
    t.refuse_key("factor", "only the section of a theory follows the radii of particles",
                 "give diameter, or a theory with its section in place of stiffness or coefficients");
  const auto has_diameter = [&] {
    return form.shape == Shape::annulus || (!may_follow && form.shape == Shape::circle);
  };
  t.when(has_diameter(), may_follow ? "shape = \"annulus\"" : "shape = \"circle\" or \"annulus\"", [&] {
    t.key("diameter", form.diameter, DiameterCodec{positive(length)}, required, "outer diameter");
  });
  t.when(form.shape == Shape::annulus, "shape = \"annulus\"", [&] {
    t.key("inner_diameter", form.inner_diameter, not_negative(length), required,
          "inner diameter, < diameter");
    t.check(form.inner_diameter < form.diameter, {"inner_diameter", "diameter"},
            "must be smaller than diameter: the wall has a thickness", "exchange them");
  });
  t.when(form.shape == Shape::square, "shape = \"square\"",
         [&] { t.key("side", form.side, positive(length), required, "length of a side"); });
  t.when(form.shape == Shape::given, "shape = \"given\"", [&] {
    t.key("A", section.A, positive(area), required, "area");
    t.key("J", section.J, positive(area_moment), required, "second moment of area, the same about all axes");
    t.key("J_p", section.J_p, positive(area_moment), required, "torsion constant");
    t.key("radius", section.r, not_negative(length), default_is("required for strengths in stresses"),
          "distance of the outermost fibre from the axis");
  });
  if (form.of_radii.any()) return;
  section = resolve(form, section);
  t.check(section.A > 0 && section.J > 0 && section.J_p > 0, {"shape", "diameter", "inner_diameter", "side"},
          "A, J and J_p must not vanish: the wall is too thin or the section too small for double precision",
          "choose a larger section, or other units");
}

void describe_per_area(Table& t, TheoryParameters& p) {
  PerArea& k = p.per_area;
  const std::size_t by = t.exactly_one({"k_n", "E"}, k.of_modulus() ? 1 : 0);
  t.when(by == 0, "theory = \"parallel\" and k_n", [&] {
    t.key("k_n", k.k_n, positive(stiffness_per_area), required,
          "normal stiffness per area: c_A = A k_n, c_B = J k_n; exactly one of k_n and E");
    t.key("k_s", k.k_s, positive(stiffness_per_area), required,
          "shear stiffness per area: c_D = A k_s, c_T = J_p k_s");
  });
  t.when(by == 1, "theory = \"parallel\" and E", [&] {
    t.key("E", p.material.E, positive(stress), required,
          "effective modulus, with k_n = E/(R_i + R_j) of each pair");
    t.key("stiffness_ratio", k.ratio, positive(pure), required, "k_n/k_s");
  });
  const auto of_grains = [&t](const char* name, double& value, const char* doc) {
    std::optional<double> given;
    if (value > 0.0) given = value;
    t.key(name, given, positive(stiffness_per_area), default_is("grains are rigid"), doc);
    value = given.value_or(0.0);
  };
  of_grains("grain_k_n", k.grain_k_n,
            "normal stiffness of each grain per area, in series: 1/k = 1/k_n + 2/grain_k_n");
  of_grains("grain_k_s", k.grain_k_s, "shear stiffness of each grain per area, in series as well");
  const auto follows = [](double cement, double grain) {
    return grain > 0.0 ? between_grains(cement, grain) : cement;
  };
  t.check(k.of_modulus() ||
              (std::isfinite(follows(k.k_n, k.grain_k_n)) && std::isfinite(follows(k.k_s, k.grain_k_s))),
          {"k_n", "k_s", "grain_k_n", "grain_k_s"}, "the stiffness in series is out of the range of doubles",
          "use other units");
}

void check_poisson(Table& t, const TheoryParameters& p) {
  if (p.theory == BondTheory::short_cylinder)
    t.check(p.material.nu > -1 && p.material.nu < 0.5, {"nu", "theory"},
            "must satisfy -1 < nu < 0.5: theory \"short-cylinder\" divides by (1 - 2 nu), [KA12] eq. (33)",
            "use nu <= 0.49, or theory = \"bernoulli-euler\" / \"timoshenko\", which accept nu = 0.5");
  else if (p.theory == BondTheory::shell)
    t.check(p.material.nu > -1 && 3.0 * p.material.nu < 1.0, {"nu", "theory"},
            "must satisfy -1 < nu < 1/3: a triangular sheet of theory \"shell\" has no other, its c_D and "
            "c_T are those of (1 - 3 nu)",
            "use nu <= 0.33; no other theory gives a sheet a larger one");
  else
    t.check(p.material.nu > -1 && p.material.nu <= 0.5, {"nu"},
            "must satisfy -1 < nu <= 0.5: outside, an isotropic material is not stable",
            "use for example nu = 0.3");
}

}  // namespace

const TheoryParameters* theory_with_section(const BondRecipe& recipe) {
  const auto* theory = std::get_if<TheoryParameters>(&recipe.parameters);
  return theory && theory->theory != BondTheory::shell ? theory : nullptr;
}

void describe_section(Table& t, Section& section) {
  SectionForm form;
  describe_form(t, form, section, false);
}

void describe(Table& t, BondStiffness<double>& p) {
  t.table("stiffness", required, "four stiffnesses, for bonds of any length", [&p](Table& c) {
    c.key("c_A", p.c_A, positive(stiffness), required, "longitudinal");
    c.key("c_D", p.c_D, positive(stiffness), required, "shear");
    c.key("c_B", p.c_B, positive(turning_stiffness), required, "bending, per radian");
    c.key("c_T", p.c_T, positive(turning_stiffness), required, "torsion, per radian");
  });
}

void describe(Table& t, TheoryParameters& p) {
  t.key("theory", p.theory,
        ChoiceCodec<BondTheory>{{"bernoulli-euler", "timoshenko", "short-cylinder", "shell", "parallel"},
                                {BondTheory::bernoulli_euler, BondTheory::timoshenko,
                                 BondTheory::short_cylinder, BondTheory::shell, BondTheory::parallel}},
        required,
        "stiffnesses from material and section, at each bond's length; shell: of a triangular sheet that "
        "stands for a thin wall, at any length; parallel: from stiffnesses per area, at any length");
  const bool is_parallel = p.theory == BondTheory::parallel;
  t.when(!is_parallel, "theory = \"bernoulli-euler\", \"timoshenko\", \"short-cylinder\" or \"shell\"", [&] {
    t.key("E", p.material.E, positive(stress), required, "Young's modulus");
    t.key("nu", p.material.nu, poisson_ratio(any_number), required,
          "Poisson's ratio, > -1 and <= 0.5 (short-cylinder: < 0.5, shell: < 1/3)");
    check_poisson(t, p);
  });
  t.when(is_parallel, "theory = \"parallel\"", [&] { describe_per_area(t, p); });
  SectionForm form;
  form.of_radii = p.of_radii;
  if (form.of_radii.any()) form.shape = Shape::circle;
  t.when(p.theory != BondTheory::shell,
         "theory = \"bernoulli-euler\", \"timoshenko\", \"short-cylinder\" or \"parallel\"", [&] {
           t.table("section", required, "cross-section of the bond",
                   [&](Table& s) { describe_form(s, form, p.section, true); });
           p.of_radii = form.of_radii;
         });
  t.when(p.theory == BondTheory::shell, "theory = \"shell\"", [&] {
    t.key("thickness", p.thickness, positive(length), required,
          "of the wall, h: the sheet stretches by E h/(1-nu^2) and bends by E h^3/(12 (1-nu^2)), with nu in "
          "both");
  });
  t.when(p.theory == BondTheory::timoshenko, "theory = \"timoshenko\"", [&] {
    std::optional<Kappa> kappa;
    if (p.kappa > 0) kappa = Kappa{p.kappa, false};
    t.key("kappa", kappa, KappaCodec{}, default_is("\"hutchinson\" for a circle, else required"),
          "shear coefficient");
    const bool of_circle = form.shape == Shape::circle;
    t.check(kappa || of_circle, {"kappa", "section"}, "kappa is required: only the circle has a default",
            "add kappa, for example 5/6 = 0.8333 for a square");
    t.check(!kappa || !kappa->is_hutchinson || of_circle, {"kappa", "section"},
            "Hutchinson's formula 6(1+nu)^2/(7+12nu+4nu^2) is for the full circle",
            "give kappa as a number, for example 5/6 = 0.8333 for a square");
    if (kappa && !kappa->is_hutchinson)
      p.kappa = kappa->value;
    else if (t.reading())
      p.kappa = hutchinson_circle(p.material.nu);
  });
}

}  // namespace vbond::keys
