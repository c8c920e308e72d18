#include <cmath>
#include <optional>

#include "vbond/case/keys.hpp"

/// Flat joints: sections in cells that break one by one, and then rub.
namespace vbond::keys {
namespace {

bool is_circle(const TheoryParameters& t) {
  constexpr double rounding = 1e-12;
  if (t.of_radii.any()) return true;
  const Section c = circle(2.0 * t.section.r);
  return std::abs(t.section.A - c.A) <= rounding * c.A && std::abs(t.section.J - c.J) <= rounding * c.J &&
         std::abs(t.section.J_p - c.J_p) <= rounding * c.J_p;
}

}  // namespace

void describe_flat_joint(Table& t, BondSpec& b) {
  FlatJoint& joint = b.recipe.flat_joint;
  Rubbing& rubbing = b.recipe.rules.rubbing;
  t.table(
      "flat_joint", optional,
      "the section of theory \"parallel\" in cells, each a bond of its own that breaks by itself",
      [&](Table& k) {
        int radial = joint.any() ? joint.radial : 1, around = joint.any() ? joint.around : 4;
        k.key("radial", radial, CountCodec{1, 20}, optional, "rings of cells, of equal thickness");
        k.key("around", around, CountCodec{1, 60}, optional, "cells in each ring: 1, or 3 and more");
        std::optional<double> friction;
        if (rubbing.any()) friction = rubbing.friction;
        k.key("friction", friction, not_negative(pure), default_is("broken cells carry nothing"),
              "coefficient of friction of broken cells: their faces push, and rub, until they have moved "
              "apart by the radius of the section");
        k.check(around != 2, {"around"},
                "two cells in a ring resist bending in one direction more than in the other",
                "use 1, or 3 and more");
        joint = {radial, around};
        rubbing = friction ? Rubbing{*friction, 1.0} : Rubbing{};
      },
      joint.any());
}

void check_flat_joint(Table& t, const BondSpec& b) {
  const BondRecipe& recipe = b.recipe;
  if (!recipe.flat_joint.any()) return;
  const TheoryParameters* theory = theory_with_section(recipe);
  t.check(theory && theory->theory == BondTheory::parallel && is_circle(*theory), {"flat_joint", "theory"},
          "a flat joint is a circle of springs per area",
          "give theory = \"parallel\" with k_n and k_s, or E, and section = {shape = \"circle\", ...}");
  t.check(!b.strength || (b.strength->criterion == Criterion::mohr_coulomb && !b.strength->moments),
          {"strength", "flat_joint"},
          "a cell breaks by the stresses at its middle, tension or shear: moments of its own do not count",
          "give criterion = \"mohr-coulomb\" without moment_share: tension_limit, cohesion, friction_angle");
  t.check(!recipe.rules.rubbing.any() || b.strength, {"flat_joint", "strength"},
          "friction is that of broken cells, and without a strength none breaks",
          "add strength = {criterion = \"mohr-coulomb\", ...}, or leave friction out");
  t.check(!recipe.rules.rubbing.any() || recipe.damping.by == DampingBy::none, {"damping", "flat_joint"},
          "bonds whose cells rub when they are broken do not damp: a crack that stands open would go on "
          "damping",
          "leave damping out: stages have a viscous or local damping; or leave friction out");
  t.check(recipe.damping.by == DampingBy::none || recipe.damping.by == DampingBy::time,
          {"damping", "flat_joint"},
          "a ratio, or coefficients, of the cells would damp the joint by their number",
          "give damping = {time = ...}, which damps the intact joint as the parallel bond; or leave it out");
  const BondStiffness<double>& f = recipe.factors;
  t.check(f.c_A == f.c_B && f.c_D == f.c_T, {"stiffness_factors", "flat_joint"},
          "a flat joint bends and twists by the springs of its cells: c_B follows from c_A, c_T from c_D",
          "give c_B the factor of c_A, and c_T that of c_D; or change k_n and k_s");
  t.check(recipe.rules.stretch.form == StretchForm::harmonic && !b.yield && !b.creep && !b.softening,
          {"flat_joint", "stretching", "yield", "creep", "softening"},
          "the cells of a flat joint are elastic until they break", "leave the others out");
  t.check(recipe.expansion == 0.0 && recipe.prestrain == 0.0 && !recipe.capsule,
          {"flat_joint", "expansion", "prestrain", "capsule_radius"},
          "the cells of a flat joint do not expand, are made at rest, and are no capsules",
          "leave the others out");
  t.check(b.when != BondTime::approach && !std::holds_alternative<AtCrossings>(b.select.value),
          {"flat_joint", "when", "crossing_gap"},
          "flat joints are made before the run or as stages begin, between grains",
          "use when = \"start\" or \"stage\", and gap_factor, gap or another selection of particles");
}

}  // namespace vbond::keys
