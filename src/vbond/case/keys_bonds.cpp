#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/case/keys.hpp"

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

/// The radius of capsules: a length, or that of the particles.
struct CapsuleRadius {
  double value = 0;  // 0: of the particles
};

struct CapsuleRadiusCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, CapsuleRadius& out) const {
    const auto* text = std::get_if<std::string>(&n.value);  // a word, or a length with its unit
    out.value = 0.0;
    std::size_t index = 0;
    if (text && !text->empty() && std::isalpha(static_cast<unsigned char>(text->front())))
      return read_word(n, in, path, {word}, index);
    return positive(length).read(n, in, path, out.value);
  }
  std::string write(const CapsuleRadius& r) const {
    return r.value > 0.0 ? positive(length).write(r.value) : "\"" + std::string(word) + "\"";
  }
  std::string type() const { return "length > 0, or \"particles\""; }
  std::string schema() const { return any_of({positive(length).schema(), enum_schema({word})}); }
  std::string example(UnitSystem) const { return "\"particles\""; }
  static constexpr const char* word = "particles";
};

void describe_capsule(Table& t, BondRecipe& recipe) {
  std::optional<CapsuleRadius> radius;
  if (recipe.capsule) radius = CapsuleRadius{recipe.capsule_radius};
  t.key("capsule_radius", radius, CapsuleRadiusCodec{}, default_is("only particles touch"),
        "bonds touch each other and particles as capsules, their axes swept by this radius, so that fibres "
        "cannot pass through one another; \"particles\": the smaller radius of each bond's particles");
  recipe.capsule = radius.has_value();
  recipe.capsule_radius = radius.value_or(CapsuleRadius{}).value;
}

/// The bond laws by name.
ChoiceCodec<const BondLaw*> law_codec() {
  ChoiceCodec<const BondLaw*> codec;
  for (const BondLaw* law : named_laws()) {
    codec.names.emplace_back(law->name);
    codec.values.push_back(law);
  }
  return codec;
}

Dimension dimension_of(const LawDimension& d) {
  for (const Dimension& known : {stiffness, moment, stress, stiffness_per_area, force})
    if (known == Dimension{d.length + d.force, d.force, -2 * d.force, 0}) return known;
  return {d.length + d.force, d.force, -2 * d.force, 0, "number in SI base units", "1"};
}

/// A coefficient as the laws that have it name it, those with the same words for it together.
struct CoefficientKey {
  LawFieldInfo info;  // of the first of them
  std::vector<const BondLaw*> laws;
  std::string meaning;

  bool of(const BondLaw& law) const { return std::find(laws.begin(), laws.end(), &law) != laws.end(); }
  bool of_all() const { return laws.size() == named_laws().size(); }
};

/// Place of that name among the law's fields, or their number.
std::size_t place_in(const BondLaw& law, std::string_view name) {
  const auto at = std::find_if(law.fields.begin(), law.fields.end(),
                               [&](const LawFieldInfo& field) { return field.name == name; });
  return static_cast<std::size_t>(at - law.fields.begin());
}

std::string names_of(const std::vector<const BondLaw*>& laws, const char* between) {
  std::string names;
  for (const BondLaw* law : laws) names += (names.empty() ? "" : between) + std::string(law->name);
  return names;
}

std::string meaning_of(std::string_view name, const std::vector<const BondLaw*>& laws) {
  std::vector<std::pair<std::string_view, std::vector<const BondLaw*>>> meanings;
  for (const BondLaw* law : laws) {
    const std::string_view meaning = law->fields[place_in(*law, name)].meaning;
    const auto same = [&](const auto& m) { return m.first == meaning; };
    const auto at = std::find_if(meanings.begin(), meanings.end(), same);
    if (at == meanings.end())
      meanings.push_back({meaning, {law}});
    else
      at->second.push_back(law);
  }
  if (meanings.size() == 1) return std::string(meanings[0].first);
  std::string text;
  for (const auto& [meaning, of] : meanings)
    text += (text.empty() ? "" : "; ") + names_of(of, ", ") + ": " + std::string(meaning);
  return text;
}

/// Every coefficient of any law, once.
std::vector<CoefficientKey> coefficient_keys() {
  std::vector<CoefficientKey> keys;
  for (const BondLaw* first : named_laws())
    for (const LawFieldInfo& field : first->fields) {
      const auto known = [&](const CoefficientKey& k) { return k.info.name == field.name; };
      if (std::any_of(keys.begin(), keys.end(), known)) continue;
      CoefficientKey key{field, {}, {}};
      for (const BondLaw* law : named_laws())
        if (place_in(*law, field.name) < law->fields.size()) key.laws.push_back(law);
      key.meaning = meaning_of(field.name, key.laws);
      keys.push_back(std::move(key));
    }
  return keys;
}

void describe_coefficient(Table& t, const CoefficientKey& key, const BondLaw& law, Coefficients& values) {
  double unused = 0.0;
  double& value = key.of(law) ? values[place_in(law, key.info.name)] : unused;
  const Dimension d = dimension_of(key.info.dimension);
  t.key(key.info.name.data(), value, key.info.bound == LawBound::positive ? positive(d) : number(d), required,
        key.meaning.c_str());
}

/// Those of the coefficients that `wanted` says, each where the law has it; those of the same laws together.
template <class Wanted>
void describe_coefficients(Table& t, const BondLaw& law, Coefficients& values, Wanted wanted) {
  std::vector<CoefficientKey> keys = coefficient_keys();
  std::erase_if(keys, [&](const CoefficientKey& key) { return !wanted(key); });
  for (auto first = keys.begin(), last = first; first != keys.end(); first = last) {
    last = std::find_if(first, keys.end(), [&](const CoefficientKey& k) { return k.laws != first->laws; });
    const auto all = [&, first, last] {
      for (auto key = first; key != last; ++key) describe_coefficient(t, *key, law, values);
    };
    if (first->of_all())
      all();
    else
      t.when(first->of(law), "law = \"" + names_of(first->laws, "\" or \"") + "\"", all);
  }
}

void describe_given(Table& t, const BondLaw& law, GivenCoefficients& given) {
  t.table("coefficients", required, "the law's own coefficients, for bonds of any length", [&](Table& c) {
    describe_coefficients(c, law, given.values, [](const CoefficientKey&) { return true; });
  });
}

/// Rest is the least energy at every length if it is at one.
bool has_stable_rest(const BondLaw& law, const Coefficients& values) {
  Bond b;
  b.law = &law, b.a = 1.0, b.coefficients = values;
  const BondStiffness<double> c = law.stiffness(b);
  return c.c_A > 0 && c.c_D > 0 && c.c_B > 0 && c.c_T > 0;
}

void check_coefficients(Table& t, const BondLaw& law, const Coefficients& values) {
  std::string here;
  for (std::size_t k = 0; k < law.fields.size(); ++k)
    here += (here.empty() ? "" : ", ") + std::string(law.fields[k].name) + " = " + number_text(values[k]);
  t.check(has_stable_rest(law, values), {"coefficients", "law"},
          std::string(law.name) + " must have " + std::string(law.rest_condition) + " (here " + here +
              "): else rest is not the least energy",
          std::string(law.rest_way_out) + ", or give stiffness = { c_A, c_D, c_B, c_T }");
}

void describe_faces(Table& t, BondSpec& b) {
  t.key("neighbours", b.faces.only, ChoiceCodec<bool>{{"all", "voronoi"}, {false, true}}, optional,
        "of the pairs within distance, gap or gap_factor: all, or those alone whose Voronoi cells share a "
        "face; "
        "cells are those of all particles, radical ones by their radii");
  t.when(b.faces.only, "neighbours = \"voronoi\"", [&] {
    t.key("least_face", b.faces.least, not_negative(pure), optional,
          "least area of the face that two cells share, over the square of the distance of the centres");
  });
  t.check(
      !b.faces.only || (b.reach() && b.when != BondTime::approach), {"neighbours", "when"},
      "neighbours = \"voronoi\" chooses among pairs within distance, gap or gap_factor, before the run or as "
      "stages begin",
      "add gap_factor, for example 1.6; for bonds made on approach leave neighbours out");
}

void describe_share(Table& t, BondShare& share) {
  t.key(
      "share", share.part, NumberCodec{pure, {0, 1, true, false}}, optional,
      "part of the selected pairs that is bonded; which of them, a number of each pair says, in every stage "
      "the same");
  t.when(share.part < 1.0, "share < 1",
         [&] { t.key("seed", share.seed, seed_number, optional, "of the choice of pairs"); });
}

/// The length of a neck is that of the cement in a round section.
void check_neck(Table& t, const BondRecipe& recipe) {
  if (recipe.attachment != Attachment::neck) return;
  const TheoryParameters* theory = theory_with_section(recipe);
  t.check(theory != nullptr, {"attach", "theory", "stiffness", "coefficients"},
          "attach = \"neck\" takes the length of a bond from its section, which only a theory has here",
          "give a theory with a section: theory = \"parallel\" has k_n and k_s per area");
  t.check(theory == nullptr || theory->of_radii.any() || theory->section.r > 0.0, {"attach", "section"},
          "attach = \"neck\" takes the length of a bond from the radius of its section",
          "with shape = \"given\": add radius to the section");
}

/// What bonds that are not between centres cannot have.
void check_crossings(Table& t, const BondSpec& b) {
  if (!std::holds_alternative<AtCrossings>(b.select.value)) return;
  t.check(
      b.recipe.attachment != Attachment::neck, {"attach", "crossing_gap"},
      "attach = \"neck\" is for spheres, and crossings are of fibres",
      "bond their axes (attach = \"centres\") or their surfaces (\"surfaces\", where these do not touch)");
  t.check(!b.recipe.capsule, {"capsule_radius", "crossing_gap"}, "a bond at a crossing is no fibre itself",
          "leave capsule_radius out");
  t.check(b.recipe.expansion == 0.0, {"expansion", "crossing_gap"}, "bonds at crossings do not expand",
          "leave expansion out: the fibres themselves may expand");
}

void describe_time(Table& t, BondSpec& b) {
  t.key("when", b.when,
        ChoiceCodec<BondTime>{{"start", "stage", "approach"},
                              {BondTime::start, BondTime::stage, BondTime::approach}},
        optional,
        "made before the run, as stages begin, or during the run as soon as two particles are near enough");
  t.when(b.when != BondTime::start, "when = \"stage\" or \"approach\"", [&] {
    t.key("stages", b.stages, list_of(stage_name), default_is("approach: all stages"), "in which stages");
    t.check(b.when != BondTime::stage || !b.stages.empty(), {"stages", "when"},
            "when = \"stage\" needs the names of the stages", "add stages = [\"...\"]");
  });
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

void describe(Table& t, BondSpec& b) {
  std::string law_titles;
  for (const BondLaw* law : named_laws())
    law_titles += (law_titles.empty() ? "" : ", ") + std::string(law->title);
  t.locate(b.place);
  t.key("name", b.name, NameCodec{}, default_is("`\"bonds-1\"`, `\"bonds-2\"`, ..."),
        "name of this set of bonds");
  t.key("law", b.recipe.law, law_codec(), optional, law_titles.c_str());
  for (auto& group : b.between) {
    if (group.value.empty()) group.value = "all";
    t.locate(group.place);
  }
  t.key("between", b.between, tuple_of<2>(group_name), optional,
        "the groups that the two particles belong to");
  t.key("attach", b.recipe, AttachCodec{}, optional,
        "bonded points: the centres, the surfaces, or at this distance from the centres; \"neck\": the "
        "middle is "
        "that between the surfaces, the length that of the cement in the section");
  t.key("n_2", b.recipe.n_2, direction_vector, default_is("the axis least aligned with the bond"),
        "n_2 is this direction, made normal to the bond");
  describe_capsule(t, b.recipe);
  describe_time(t, b);

  const std::vector<std::string> selections{"distance", "pairs",      "file",        "from_specimen",
                                            "gap",      "gap_factor", "crossing_gap"};
  const std::size_t selection = t.exactly_one(selections, b.select.value.index());
  t.alternatives(b.select.value, selection, selections);
  t.locate(b.select.place);
  if (selection < selections.size()) t.locate(b.select.place, selections[selection]);
  t.check(b.when != BondTime::approach || b.reach(),
          {"when", "distance", "pairs", "file", "from_specimen", "gap", "gap_factor", "crossing_gap"},
          "bonds made on approach are selected by distance, gap or gap_factor",
          "give distance, gap or gap_factor instead of the other selection");
  describe_faces(t, b);
  describe_share(t, b.share);

  const std::vector<std::string> forms{"coefficients", "stiffness", "theory"};
  const std::size_t form = t.exactly_one(forms, b.recipe.parameters.index());
  const BondLaw& law = *b.recipe.law;
  t.alternatives(b.recipe.parameters, form, forms, [&law](Table& inner, auto& parameters) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(parameters)>, GivenCoefficients>)
      describe_given(inner, law, parameters);
    else
      describe(inner, parameters);
  });
  if (const auto* given = std::get_if<GivenCoefficients>(&b.recipe.parameters); given && form == 0)
    check_coefficients(t, law, given->values);
  t.when(form != 0, "stiffness or theory", [&] {
    describe_coefficients(t, law, b.recipe.given,
                          [](const CoefficientKey& key) { return key.info.input == LawInput::given; });
    t.key("reference_length", b.recipe.reference_length, positive(length),
          default_is("each bond's own length"),
          "the law's coefficients are worked out at this length and are the same for all bonds of the set");
  });
  describe_rules(t, b);
  describe_flow(t, b);
  check_neck(t, b.recipe);
  check_crossings(t, b);
}

void describe(Table& t, WithinDistance& s) {
  t.key("distance", s.distance, positive(length), required,
        "all pairs whose centres are at most this far apart");
}

void describe(Table& t, WithinGap& s) {
  t.key(
      "gap", s.gap, not_negative(length), required,
      "all pairs whose surfaces, as spheres, are at most this far apart: distance of centres - R_i - R_j <= "
      "gap, but for 1e-9 of the radii");
}

void describe(Table& t, WithinFactor& s) {
  t.key("gap_factor", s.factor, positive(pure), required,
        "all pairs whose centres are at most so many times R_i + R_j apart, but for 1e-9 of the radii");
}

void describe(Table& t, AtCrossings& s) {
  t.key("crossing_gap", s.gap, not_negative(length), required,
        "where two fibres are nearest to each other, if their surfaces are at most this far apart: bonded at "
        "their axes (or surfaces, which must not touch) there, also between particles. Fibres are bonds of "
        "sets "
        "before this one with capsule_radius; if there are none, those from specimens");
}

void describe(Table& t, ListedPairs& s) {
  t.key("pairs", s.pairs, list_of(tuple_of<2>(particle_number), 1), required,
        "these pairs of particle numbers");
  bool apart = true;
  for (const auto& p : s.pairs) apart = apart && p[0] != p[1];
  t.check(apart, {"pairs"}, "a particle cannot be bonded to itself",
          "give two different numbers in each pair");
}

void describe(Table& t, PairsFile& s) {
  t.key("file", s.file, FileCodec{}, required,
        "CSV file with header i,j and a pair of particle numbers per line, counted from 0 when specimens are "
        "cut and copied");
}

void describe(Table& t, SpecimenPairs& s) {
  bool yes = true;
  t.key("from_specimen", yes, FlagCodec{}, required,
        "true: the bonds that specimens bring along: those of LAMMPS data files and of the bonds_file of CSV "
        "specimens, and the edges of kinds cylinder, cone and sphere");
  t.check(yes, {"from_specimen"}, "can only be true", "leave it out and select by distance, pairs or file");
  t.key("bond_type", s.bond_type, CountCodec{1}, default_is("bonds of all types"),
        "only those of this bond type of the file");
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
    t.key("nu", p.material.nu, NumberCodec{pure, any_number}, required,
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
