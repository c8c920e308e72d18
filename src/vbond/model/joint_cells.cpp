#include "vbond/model/joint_cells.hpp"

#include <cmath>
#include <numbers>

namespace vbond {

std::vector<JointCell> joint_cells(const FlatJoint& joint) {
  std::vector<JointCell> cells;
  const double n = joint.around, half = std::numbers::pi / n;  // half the angle of a cell
  for (int ring = 0; ring < joint.radial; ++ring) {
    const double r_1 = static_cast<double>(ring) / joint.radial,
                 r_2 = static_cast<double>(ring + 1) / joint.radial;
    const double r2 = sq(r_1) + sq(r_2), area = (sq(r_2) - sq(r_1)) / n;
    // the centroid of a sector of an annulus; that of a whole ring is its centre
    const double middle =
        joint.around == 1 ? 0.0 : 2.0 / 3.0 * (r2 + r_1 * r_2) / (r_1 + r_2) * std::sin(half) / half;
    const double own_moment = 0.5 * (0.5 * r2 - sq(middle));
    for (int k = 0; k < joint.around; ++k) {
      const double angle = (2 * k + 1) * half;
      cells.push_back({area, middle * std::cos(angle), middle * std::sin(angle), own_moment});
    }
  }
  return cells;
}

Section section_of_cell(const JointCell& cell, const Section& whole) {
  const double A = cell.area * whole.A, J = A * cell.own_moment * sq(whole.r);
  return {A, J, 2.0 * J, whole.r};
}

BondRules rules_of_cell(const JointCell& cell, BondRules rules) {
  // c_B/c_A tells a circle of radius 2 sqrt(own moment) where the radius of the joint is 1
  const double told = 4.0 * cell.own_moment;
  for (double* share : {&rules.strength.axial, &rules.strength.shear, &rules.strength.friction})
    *share *= told / cell.area;
  rules.rubbing.reach /= std::sqrt(told);
  return rules;
}

std::vector<BondRecipe> recipes_of(const BondRecipe& recipe) {
  if (!recipe.flat_joint.any()) return {recipe};
  std::vector<BondRecipe> recipes;
  for (const JointCell& cell : joint_cells(recipe.flat_joint)) recipes.emplace_back(recipe).cell = cell;
  return recipes;
}

}  // namespace vbond
