#include "vbond/case/keys.hpp"
#include "vbond/physics/touch.hpp"

namespace vbond::keys {
namespace {

/// What two surfaces do; otherwise says what holds for a number that is not given.
void describe(Table& t, Surface& s, const char* mu, const char* e, const char* other) {
  t.key("friction", s.friction, not_negative(pure), default_is(mu), "Coulomb's mu");
  t.key("restitution", s.restitution, NumberCodec{pure, {least_restitution, 1.0}}, default_is(e),
        "e of a head-on impact: speed after over speed before, at any speed");
  t.key("rolling_friction", s.rolling_friction, not_negative(pure), default_is(other),
        "mu_r of the largest moment mu_r R* F_n against rolling");
  t.key("twisting_friction", s.twisting_friction, not_negative(pure), default_is(other),
        "mu_t of the largest moment mu_t R* F_n against twisting about the normal");
  t.key("work_of_adhesion", s.work_of_adhesion, not_negative(surface_energy), default_is(other),
        "w, twice the surface energy of equal bodies");
}

const ChoiceCodec<TangentialForm>& tangential_codec() {
  static const ChoiceCodec<TangentialForm> codec{
      {"none", "mindlin", "linear", "mindlin-force", "mindlin-displacement"},
      {TangentialForm::none, TangentialForm::mindlin, TangentialForm::linear, TangentialForm::mindlin_force,
       TangentialForm::mindlin_displacement}};
  return codec;
}

}  // namespace

void describe(Table& t, ContactPairSpec& p) {
  t.locate(p.place);
  t.key("material", p.material, material_name, required, "one material of the pair");
  t.key("with", p.with, material_name, required, "the other one, or the same");
  const char* const rule = "what follows from the two materials";
  describe(t, p.surface, rule, rule, rule);
}

void describe(Table& t, MaterialSpec& m) {
  t.locate(m.place);
  t.key("name", m.name, NameCodec{}, required, "by which specimens and walls name it");
  t.key("E", m.E, positive(stress), required, "Young's modulus");
  t.key("nu", m.nu, poisson_ratio({-1, 0.5, true, false}), required, "Poisson's ratio");
  const char* const rule = "that of [contact]";
  describe(t, m.surface, rule, rule, rule);
}

void describe(Table& t, ContactModel& c, std::vector<ContactPairSpec>& between, bool materials) {
  t.key("law", c.law,
        ChoiceCodec<ContactLaw>{
            {"none", "paper-hertz", "hertz", "linear"},
            {ContactLaw::none, ContactLaw::paper_hertz, ContactLaw::hertz, ContactLaw::linear}},
        optional,
        "repulsion of an overlap d: c_H/sqrt(length) d^(3/2); Hertz's from E, nu and the radii; or k d");
  t.when(c.law != ContactLaw::none, "law = \"paper-hertz\", \"hertz\" or \"linear\"", [&] {
    t.key("pairs", c.pairs,
          ChoiceCodec<ContactPairs>{{"all", "unbonded", "none"},
                                    {ContactPairs::all, ContactPairs::unbonded, ContactPairs::none}},
          optional, "which particles touch each other; none: only walls are touched");
  });
  t.when(c.law == ContactLaw::paper_hertz, "law = \"paper-hertz\"", [&] {
    t.key("c_H", c.c_H, positive(stiffness), required, "contact stiffness");
    t.key("length", c.length, positive(length), required_in_si, "length scale a under the root");
  });
  t.when(c.law == ContactLaw::linear, "law = \"linear\"",
         [&] { t.key("k", c.k, positive(stiffness), required, "contact stiffness"); });
  t.when(c.law == ContactLaw::hertz, "law = \"hertz\"", [&] {
    std::optional<double> E, nu;
    if (c.E > 0.0) E = c.E, nu = c.nu;
    t.key("E", E, positive(stress), default_is("those of [[material]], else required"),
          "Young's modulus of the particles");
    t.key("nu", nu, poisson_ratio({-1, 0.5, true, false}), default_is("those of [[material]], else required"),
          "Poisson's ratio of the particles");
    t.check(materials || (E && nu), {"law", "E", "nu"}, "E and nu are required: the case has no [[material]]",
            "add them here, or as [[material]] of specimens and walls");
    t.check(!materials || (!E && !nu), {"E", "nu"}, "E and nu stand with [[material]] in this case",
            "remove them here");
    if (E && nu) c.E = *E, c.nu = *nu;
    t.key("adhesion", c.adhesion,
          ChoiceCodec<AdhesionForm>{{"none", "jkr", "dmt"},
                                    {AdhesionForm::none, AdhesionForm::jkr, AdhesionForm::dmt}},
          optional, "by the work of adhesion: of soft bodies (JKR) or of small and hard ones (DMT)");
  });
  t.when(c.law != ContactLaw::none, "law = \"paper-hertz\", \"hertz\" or \"linear\"", [&] {
    describe(t, c.surface, "0", "1: elastic", "0");
    t.key("tangential", c.tangential, tangential_codec(), optional,
          "spring across the contact, up to friction: Mindlin's 8 G* sqrt(R* d), or k_t; mindlin-force and "
          "mindlin-displacement do not rescale it (LAMMPS' mindlin/force and mindlin): they can make energy");
    t.check(!is_mindlin(c.tangential) || c.law == ContactLaw::hertz, {"tangential", "law"},
            "Mindlin's stiffness follows from E and nu, which only law = \"hertz\" has",
            "use tangential = \"linear\" with k_t, or law = \"hertz\"");
    t.check(c.surface.friction.value_or(0.0) == 0.0 || c.tangential != TangentialForm::none,
            {"friction", "tangential"}, "friction without a tangential spring does nothing",
            "add tangential = \"mindlin\" (law hertz) or \"linear\" with k_t");
    t.key("rolling", c.rolling,
          ChoiceCodec<RollingForm>{{"none", "constant", "spring"},
                                   {RollingForm::none, RollingForm::constant, RollingForm::spring}},
          optional, "resistance to rolling and twisting: a constant moment, or a spring up to it (type C)");
    t.check(c.rolling != RollingForm::none || (c.surface.rolling_friction.value_or(0.0) == 0.0 &&
                                               c.surface.twisting_friction.value_or(0.0) == 0.0),
            {"rolling", "rolling_friction", "twisting_friction"}, "without rolling they do nothing",
            "add rolling = \"spring\" or \"constant\"");
    t.check(c.adhesion != AdhesionForm::none || c.surface.work_of_adhesion.value_or(0.0) == 0.0,
            {"work_of_adhesion", "adhesion"}, "without adhesion it does nothing",
            "add adhesion = \"jkr\" or \"dmt\" (law hertz)");
    t.key("attraction", c.attraction, FlagCodec{}, optional,
          "whether damping may pull parting bodies together; restitution is met either way");
    t.key("damping", c.damping, not_negative(damping), optional,
          "c_n of a damper along the contact, one for all speeds and overlaps, in place of a restitution");
    t.check(c.damping == 0.0 || !c.surface.restitution, {"damping", "restitution"},
            "the damping of a contact follows from a restitution, or is given as a coefficient",
            "remove one of the two");
    t.key("tangential_damping", c.tangential_damping, not_negative(pure), optional,
          "damping across the contact over that along it, while it sticks");
  });
  t.when(c.tangential == TangentialForm::linear, "tangential = \"linear\"",
         [&] { t.key("k_t", c.k_t, positive(stiffness), required, "stiffness across the contact"); });
  t.when(c.rolling == RollingForm::spring, "rolling = \"spring\"", [&] {
    std::optional<double> k_r;
    if (c.rolling_stiffness > 0.0) k_r = c.rolling_stiffness;
    t.key("rolling_stiffness", k_r, positive(turning_stiffness), default_is("k_t R*^2"),
          "moment of the spring against rolling over its angle");
    t.check(k_r || c.tangential != TangentialForm::none, {"rolling", "rolling_stiffness"},
            "rolling_stiffness is required: there is no tangential stiffness that it follows from",
            "add rolling_stiffness, or tangential");
    c.rolling_stiffness = k_r.value_or(0.0);
  });
  t.when(c.pairs == ContactPairs::unbonded && c.law != ContactLaw::none, "pairs = \"unbonded\"", [&] {
    t.key("overlap_at_break", c.keeps_overlap, ChoiceCodec<bool>{{"felt", "kept"}, {false, true}}, optional,
          "of a pair whose bond breaks: felt, its energy being taken from what the bond releases; or kept: "
          "only what goes beyond it is felt, until the two have parted");
    t.check(!c.keeps_overlap || c.adhesion == AdhesionForm::none, {"overlap_at_break", "adhesion"},
            "adhesion acts where surfaces meet, and an overlap that is kept has no such place",
            "use overlap_at_break = \"felt\", or no adhesion");
  });
  t.tables("between", between, optional, "exceptions for pairs of materials");
}

}  // namespace vbond::keys
