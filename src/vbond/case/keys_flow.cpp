#include <cmath>

#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

constexpr Dimension energy_per_area{0, 1, -2, 0, "energy/area", "100 J/m^2"};

// ---- yield -----------------------------------------------------------------------------------------

void describe_growth(Table& t, FlowLimits& growth, bool of_shear) {
  t.key("axial", growth.axial, not_negative(stiffness), optional, "of the axial force, per elongation");
  if (of_shear)
    t.key("shear", growth.shear, not_negative(stiffness), optional, "of the shear force, per displacement");
  t.key("bending", growth.bending, not_negative(turning_stiffness), optional,
        "of the bending moment, per angle");
  t.key("torsion", growth.torsion, not_negative(turning_stiffness), optional, "of the torque, per angle");
}

Yield resolve(const YieldSpec& s) {
  Yield yield;
  yield.limit = {s.axial_force.value_or(0.0), s.shear_force.value_or(0.0), s.bending_moment.value_or(0.0),
                 s.torque.value_or(0.0)};
  yield.compression = s.compression_force.value_or(yield.limit.axial);
  yield.isotropic = s.isotropic, yield.kinematic = s.kinematic;
  return yield;
}

void describe_yield(Table& t, YieldSpec& s) {
  t.key("axial_force", s.axial_force, positive(force), default_is("the bond does not yield along its axis"),
        "in tension, and in compression unless that has its own");
  t.key("compression_force", s.compression_force, positive(force), default_is("axial_force"),
        "in compression");
  t.key("shear_force", s.shear_force, positive(force), default_is("not in shear"), "in shear");
  t.key("bending_moment", s.bending_moment, positive(moment), default_is("not in bending"),
        "at the middle of the bond");
  t.key("torque", s.torque, positive(moment), default_is("not in torsion"), "in torsion");
  t.table(
      "isotropic", optional, "limits grow with all flow so far: by so much per flow",
      [&](Table& k) { describe_growth(k, s.isotropic, true); }, s.isotropic != FlowLimits{});
  t.table(
      "kinematic", optional, "limits move along with the flow: by so much per flow",
      [&](Table& k) { describe_growth(k, s.kinematic, false); }, s.kinematic != FlowLimits{});
  t.check(s.axial_force || s.shear_force || s.bending_moment || s.torque,
          {"axial_force", "shear_force", "bending_moment", "torque"}, "at least one load must have a limit",
          "add axial_force, shear_force, bending_moment or torque");
  t.check(s.axial_force || !s.compression_force, {"compression_force", "axial_force"},
          "a bond that yields in compression yields in tension, too", "add axial_force, however large");
}

// ---- creep -----------------------------------------------------------------------------------------

Creep resolve(const CreepSpec& s) {
  if (!s.is_norton) return {1.0 / s.viscosity, 1};
  return {s.speed / std::pow(s.force, static_cast<double>(s.exponent)), static_cast<std::size_t>(s.exponent)};
}

void describe_creep(Table& t, CreepSpec& s) {
  const std::size_t form = t.exactly_one({"viscosity", "norton"}, s.is_norton ? 1 : 0);
  s.is_norton = form == 1;
  t.when(form == 0, "viscosity", [&] {
    t.key("viscosity", s.viscosity, positive(damping), required,
          "the length at rest grows at the speed N/viscosity (Maxwell)");
  });
  t.when(form == 1, "norton", [&] {
    t.table("norton", required, "the length at rest grows at the speed speed * (N/force)^exponent",
            [&](Table& k) {
              k.key("exponent", s.exponent, CountCodec{1, 9}, required, "1 to 9");
              k.key("speed", s.speed, positive(velocity), required, "under the force below");
              k.key("force", s.force, positive(force), required, "at which it creeps at that speed");
            });
  });
}

// ---- softening -------------------------------------------------------------------------------------

void describe_softening(Table& t, BondSpec& b) {
  SofteningSpec& s = b.softening ? *b.softening : b.softening.emplace();
  t.locate(s.place);
  t.key("tension", s.tension, positive(stress), required, "stress s_c at which damage begins");
  t.key("fracture_energy", s.fracture_energy, positive(energy_per_area), required,
        "G_f that the bond takes up until it parts, per area; its length must be below 2 E G_f/s_c^2");
  const TheoryParameters* theory = theory_with_section(b.recipe);
  t.when(theory == nullptr, "no theory, or theory = \"shell\"", [&] {
    t.table(
        "section", required, "cross-section of the bond",
        [&](Table& k) { describe_section(k, s.section ? *s.section : s.section.emplace()); },
        s.section.has_value());
  });
  t.check(theory == nullptr || !theory->of_radii.any(), {"tension", "fracture_energy"},
          "bonds that soften have one section: it cannot follow the radii of particles",
          "give the section a diameter in place of factor, or leave softening out");
  const Section section = theory ? theory->section : s.section.value_or(Section{});
  b.recipe.rules.softening = {section.A * s.tension, 2.0 * s.fracture_energy / s.tension};
}

}  // namespace

void describe_flow(Table& t, BondSpec& b) {
  BondRules& rules = b.recipe.rules;
  t.table(
      "yield", optional, "loads at which the bonds flow for good; each alone, and any of them",
      [&](Table& k) {
        describe_yield(k, b.yield ? *b.yield : b.yield.emplace());
        rules.yield = resolve(*b.yield);
      },
      b.yield.has_value());
  t.table(
      "creep", optional, "flow along the axis in time: exactly one of",
      [&](Table& k) {
        describe_creep(k, b.creep ? *b.creep : b.creep.emplace());
        rules.creep = resolve(*b.creep);
      },
      b.creep.has_value());
  t.table(
      "softening", optional, "damage by tension, from a stress on, that takes up a fracture energy",
      [&](Table& k) { describe_softening(k, b); }, b.softening.has_value());
  t.check(!b.softening || (!b.yield && !b.creep), {"softening", "yield", "creep"},
          "bonds that soften do not flow as well: their fracture energy would not be G_f",
          "leave out softening, or yield and creep");
  t.key("expansion", b.recipe.expansion, number(pure), optional,
        "by what part the bonds' lengths grow per temperature, as 1.2e-5 for steel and kelvin");
  const StretchForm form = rules.stretch.form;
  t.check(form != StretchForm::table || b.recipe.expansion == 0.0, {"expansion", "stretching"},
          "a table of energies has no length at rest that could grow", "choose another form of stretching");
  t.check(form != StretchForm::table || b.recipe.prestrain == 0.0, {"prestrain", "stretching"},
          "a table of energies has no length at rest from which a bond could be stretched",
          "shift the distances of the table, or choose another form of stretching");
  t.check(form == StretchForm::harmonic || (!b.softening && !b.creep), {"softening", "creep", "stretching"},
          "bonds that soften or creep stretch harmonically", "leave out stretching");
  t.check(form != StretchForm::table || !b.yield, {"yield", "stretching"},
          "a table of energies has no length at rest that could grow", "choose another form of stretching");
}

}  // namespace vbond::keys
