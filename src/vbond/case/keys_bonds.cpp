#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/case/keys.hpp"
#include "vbond/case/special_values.hpp"

namespace vbond::keys {
namespace {

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

void describe_factors(Table& t, BondStiffness<double>& f) {
  t.table(
      "stiffness_factors", optional,
      "what stiffnesses are multiplied by: `vbond calibrate CASE` finds them for a material",
      [&f](Table& c) {
        c.key("c_A", f.c_A, positive(pure), optional, "of c_A");
        c.key("c_D", f.c_D, positive(pure), optional, "of c_D");
        c.key("c_B", f.c_B, positive(pure), optional, "of c_B");
        c.key("c_T", f.c_T, positive(pure), optional, "of c_T");
      },
      !(f.c_A == 1.0 && f.c_D == 1.0 && f.c_B == 1.0 && f.c_T == 1.0));
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

}  // namespace

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
  describe_selection(t, b);

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
    describe_factors(t, b.recipe.factors);
    describe_coefficients(t, law, b.recipe.given,
                          [](const CoefficientKey& key) { return key.info.input == LawInput::given; });
    t.key("reference_length", b.recipe.reference_length, positive(length),
          default_is("each bond's own length"),
          "the law's coefficients are worked out at this length and are the same for all bonds of the set");
  });
  describe_flat_joint(t, b);
  describe_rules(t, b);
  describe_flow(t, b);
  check_flat_joint(t, b);
  check_neck(t, b.recipe);
  check_crossings(t, b);
}

}  // namespace vbond::keys
