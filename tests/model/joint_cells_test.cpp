// Flat joints: the cells of a section, and what they sum up to.
#include "vbond/model/joint_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "campaigns/dice.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/physics/laws.hpp"
#include "vbond/physics/tangent.hpp"

namespace vbond::joint_cells_test {
namespace {

BondRecipe joint_of(const FlatJoint& joint, double radius = 0.8) {
  BondRecipe recipe;
  TheoryParameters theory;
  theory.theory = BondTheory::parallel;
  theory.section = circle(2.0 * radius);
  theory.per_area.k_n = 3.0, theory.per_area.k_s = 1.3;
  recipe.parameters = theory;
  recipe.flat_joint = joint;
  return recipe;
}

const std::vector<FlatJoint> joints{{1, 1}, {2, 1}, {1, 3},  {1, 4},  {2, 3},
                                    {2, 6}, {3, 5}, {7, 11}, {20, 60}};

TEST(JointCells, SumUpToTheSection) {
  for (const FlatJoint& joint : joints) {
    double A = 0, y = 0, z = 0, yy = 0, yz = 0, zz = 0, own = 0;
    for (const JointCell& c : joint_cells(joint)) {
      A += c.area, own += c.area * c.own_moment;
      y += c.area * c.y, z += c.area * c.z;
      yy += c.area * c.y * c.y, yz += c.area * c.y * c.z, zz += c.area * c.z * c.z;
      EXPECT_GT(c.own_moment, 0.0);
    }
    EXPECT_NEAR(A, 1.0, 1e-14);
    for (const double none : {y, z, yz, yy - zz}) EXPECT_NEAR(none, 0.0, 1e-14);
    EXPECT_NEAR(own + yy, 0.25, 1e-14);  // J/A of a circle of radius 1
  }
}

// A sector by points of its own: 400 x 400 of equal radial and angular width, to second order in that.
TEST(JointCells, HaveTheCentroidAndTheMomentOfTheirSector) {
  for (const FlatJoint& joint : {FlatJoint{1, 3}, FlatJoint{3, 5}}) {
    const std::vector<JointCell> cells = joint_cells(joint);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const auto ring = static_cast<double>(k / static_cast<std::size_t>(joint.around)),
                 part = static_cast<double>(k % static_cast<std::size_t>(joint.around));
      double A = 0, y = 0, z = 0, polar = 0;
      constexpr int n = 400;
      for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
          const double r = (ring + (a + 0.5) / n) / joint.radial,
                       angle = 2.0 * M_PI * (part + (b + 0.5) / n) / joint.around,
                       dA = r * (1.0 / joint.radial / n) * (2.0 * M_PI / joint.around / n);
          A += dA, y += dA * r * std::cos(angle), z += dA * r * std::sin(angle), polar += dA * r * r;
        }
      y /= A, z /= A;
      EXPECT_NEAR(cells[k].area, A / M_PI, 1e-5);
      EXPECT_NEAR(cells[k].y, y, 1e-5);
      EXPECT_NEAR(cells[k].z, z, 1e-5);
      EXPECT_NEAR(cells[k].own_moment, 0.5 * (polar / A - y * y - z * z), 1e-5);
    }
  }
}

/// Loads of all of them and their derivatives, at rest.
std::array<std::array<double, 9>, 9> stiffness_at_rest(const BondRecipe& recipe, const BondSite& i,
                                                       const BondSite& j) {
  std::array<std::array<double, 9>, 9> K{};
  for (const BondRecipe& one : recipes_of(recipe)) {
    const Bond b = make_bond(one, i, j).value();
    const PairTangent<9> t = b.law->tangent(b, bond_pose(b, between(i.r, j.r), i.q, j.q), no_history);
    for (std::size_t r = 0; r < 9; ++r)
      for (std::size_t k = 0; k < 9; ++k) K[r][k] += t.d[r][k];
  }
  return K;
}

// The intact joint is the parallel bond: forces and moments of any small motion of the two grains, wherever
// the bond is fastened, by either law, with rules or without; and to rounding, 1e-14 of the largest.
TEST(JointCells, AreTogetherTheParallelBond) {
  testing::Dice dice(11);
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const FlatJoint& joint : joints)
      for (const Attachment attachment : {Attachment::centres, Attachment::neck}) {
        BondRecipe recipe = joint_of(joint, dice(0.3, 0.8));
        recipe.law = law;
        recipe.attachment = attachment;
        if (joint.around > 3) recipe.rules.strength = mohr_coulomb_strength(unit_section, 1, 0.5, 1, 0.0);
        if (joint.around > 4) recipe.rules.rubbing = {0.5, 1.0};
        const Vec3d r = dice.vector(1.0);
        const BondSite i{ParticleId{0}, {0.1, 0.2, 0.3}, dice.rotation(3.0), 1.0},
            j{ParticleId{1}, Vec3d{0.1, 0.2, 0.3} + (1.9 / norm(r)) * r, dice.rotation(3.0), 0.9};
        BondRecipe whole = recipe;
        whole.flat_joint = {};
        const auto K = stiffness_at_rest(recipe, i, j), same = stiffness_at_rest(whole, i, j);
        double largest = 0.0, error = 0.0;
        for (std::size_t a = 0; a < 9; ++a)
          for (std::size_t b = 0; b < 9; ++b) {
            largest = std::max(largest, std::abs(same[a][b]));
            error = std::max(error, std::abs(K[a][b] - same[a][b]));
          }
        // a neck's B2 = c_B - c_D a^2/4 and the like cancel in sums of 1200 terms
        EXPECT_LT(error, (joint.radial > 7 ? 1e-13 : 1e-14) * largest)
            << joint.radial << " x " << joint.around;
      }
}

// Each cell breaks at the stress of its own area, whatever its ring: pulled straight by the tension limit,
// and sheared under pressure by c - sigma tan phi.
TEST(JointCells, BreakAtTheStressesOfTheirOwnArea) {
  const double sigma_t = 0.02, cohesion = 0.05, tan_phi = 0.7, radius = 0.8;
  for (const FlatJoint& joint : joints) {
    BondRecipe recipe = joint_of(joint, radius);
    recipe.rules.strength = mohr_coulomb_strength(unit_section, cohesion, tan_phi, sigma_t, 0.0);
    recipe.rules.strength.own_section = true;
    const BondSite i{ParticleId{0}, {0, 0, 0}, {}, 1.0}, j{ParticleId{1}, {2, 0, 0}, {}, 1.0};
    for (const BondRecipe& one : recipes_of(recipe)) {
      const Bond b = make_bond(one, i, j).value();
      const auto use = [&](double stretch, double shift) {
        return b.law->failure(b, bond_pose(b, {2.0 + stretch, shift, 0}, {}, {}), no_history).utilisation;
      };
      EXPECT_NEAR(use(sigma_t / 3.0, 0.0), 1.0, 1e-12);  // sigma = k_n u
      // tau = k_s u and sigma = -k_n p; the bond is turned by the shift, which is small: 1e-4
      const double p = 1e-4, tau = cohesion + 3.0 * p * tan_phi;
      EXPECT_NEAR(use(-p, 1e-4) / (1.3 * 1e-4 / tau), 1.0, 3e-4);
    }
  }
}

TEST(JointCells, OfOneStrengthHaveOneSetOfRulesForEachRing) {
  BondRecipe recipe = joint_of({3, 8});
  recipe.rules.strength = mohr_coulomb_strength(unit_section, 1.0, 0.5, 1.0, 0.0);
  recipe.rules.strength.own_section = true;
  recipe.rules.rubbing = {0.5, 1.0};
  const BondSite i{ParticleId{0}, {0, 0, 0}, {}, 1.0}, j{ParticleId{1}, {2, 0, 0}, {}, 1.0};
  std::vector<const BondRules*> rules;
  for (const BondRecipe& one : recipes_of(recipe)) {
    const Bond b = make_bond(one, i, j).value();
    EXPECT_EQ(b.law, &bond_law<WithOffsets<WithRubbing<VModel>::Law>::Law>);
    rules.push_back(b.rules);
    // faces part at the radius of the joint: reach times the radius that the stiffnesses tell
    EXPECT_NEAR(b.rules->rubbing.reach * std::sqrt(own_radius2(b.law->stiffness(b))), 0.8, 1e-14);
  }
  for (std::size_t k = 0; k < rules.size(); ++k) EXPECT_EQ(rules[k], rules[k / 8 * 8]);
  EXPECT_NE(rules[0], rules[8]);
}

TEST(JointCells, AWholeBondOfAJointIsRefused) {
  const BondSite i{ParticleId{0}, {0, 0, 0}, {}, 1.0}, j{ParticleId{1}, {2, 0, 0}, {}, 1.0};
  EXPECT_THROW(make_bond(joint_of({1, 4}), i, j), std::invalid_argument);
}

}  // namespace
}  // namespace vbond::joint_cells_test
