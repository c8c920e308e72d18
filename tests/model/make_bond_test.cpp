// Bonds made of a recipe, with laws that lack what the recipe sets.
#include "vbond/model/make_bond.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "dynamics/rods.hpp"

namespace vbond {
namespace {

/// A program's own law that reads rules and has no coefficients for damping and strength.
const BondLaw& own_law() {
  static const BondLaw law = [] {
    BondLaw l = bond_law<RuledVModel>;
    l.name = "own", l.fields = l.fields.first(4);
    return l;
  }();
  return law;
}

std::string refusal(const BondRecipe& recipe) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  try {
    testing::bond(s, 0, 1, recipe);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(MakeBond, OfAnOwnLawWithoutTheCoefficientSaysSo) {
  BondRecipe recipe = testing::papers_bond(&own_law());
  EXPECT_EQ(refusal(recipe), "");
  recipe.damping = {DampingBy::coefficients, {0.1, 0.1, 0.1, 0.1}};
  EXPECT_EQ(refusal(recipe),
            "make_bond: law \"own\" has no coefficient \"g_A\", which the recipe's damping sets");
  recipe.damping = {};
  recipe.weibull.modulus = 5.0;
  EXPECT_EQ(refusal(recipe),
            "make_bond: law \"own\" has no coefficient \"weakness\", which the recipe's weibull sets");
}

}  // namespace
}  // namespace vbond
