#pragma once
#include <vector>

#include "vbond/model/bond.hpp"

namespace vbond {

/// The cells of a flat joint, ring by ring from the axis outwards, each ring anticlockwise from n_2 on. With
/// radial >= 1 and around = 1 or >= 3 their areas, and with these their stiffnesses, sum up to those of the
/// whole section: sum A = A, sum A y = 0, sum (J + A y^2) = J, whatever the axis.
std::vector<JointCell> joint_cells(const FlatJoint& joint);

/// The section of a cell: its area and its moments about its own centroid. The radius is of no meaning.
Section section_of_cell(const JointCell& cell, const Section& whole);

/// The rules of a cell: what is known of the round section that its stiffnesses tell (Strength::own_section)
/// is brought to its own area, and to the radius of the joint.
BondRules rules_of_cell(const JointCell& cell, BondRules of_set);

/// The recipes of the bonds that a recipe makes between two particles: itself, or one for each cell of its
/// flat joint.
std::vector<BondRecipe> recipes_of(const BondRecipe& recipe);

}  // namespace vbond
