#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "random_pose.hpp"
#include "rods.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

/// A sheet whose particles stand and turn anyhow, with both laws and attachments off the centres.
testing::Specimen crumpled_sheet(int side) {
  std::vector<Vec3d> r;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y) r.push_back({1.0 * x, 1.0 * y, 0});
  testing::Specimen s = testing::particles_at(r);
  BondRecipe evm = testing::papers_bond(&bond_law<Evm>);
  evm.attachment = Attachment::surfaces;
  const auto n = static_cast<std::size_t>(side);
  for (std::size_t k = 0; k < n * n; ++k) {
    if (k % n + 1 < n) testing::bond(s, k, k + 1, testing::papers_bond());
    if (k + n < n * n) testing::bond(s, k + n, k, evm);
  }
  testing::PoseSource random(4);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] += random.vector(0.1);
    s.state.q[p] = random.rotation(0.5);
  }
  return s;
}

TEST(AxialForce, IsTheComponentOfTheBondForceAlongTheBond) {
  const testing::Specimen s = crumpled_sheet(5);
  for (const Bond& b : s.state.bonds) {
    const BondPose<double> pose = bond_pose(b, s.state);
    const Vec3d d = normalised(bonded_points(pose, b.R_i, b.R_j));
    const Vec3d F = b.law->loads(b, pose, no_history).F;
    EXPECT_NEAR(axial_force(b, no_history, between(s.state, b), s.state.q[b.i], s.state.q[b.j]), dot(F, d),
                1e-14);  // rounding of terms of order 0.1
  }
}

// A bond made between particles that have turned anyhow carries nothing; rounding of turning axes forth and
// back leaves some 1e-16 times the coefficients.
RC_GTEST_PROP(NewBond, StartsUnstressedWhateverTheOrientations, (unsigned seed)) {
  testing::PoseSource random(seed);
  const Vec3d r_i = random.vector(1.0), r_j = r_i + random.vector(1.0) + Vec3d{2.5, 0, 0};
  const Quatd q_i = random.rotation(3.1), q_j = random.rotation(3.1);
  for (const BondLaw* law : bond_laws()) {
    BondRecipe recipe = testing::papers_bond(law);
    recipe.attachment = Attachment::surfaces;
    const Bond b = make_bond(recipe, {ParticleId{0}, r_i, q_i, 0.3}, {ParticleId{1}, r_j, q_j, 0.4}).value();
    const BondPose<double> pose = bond_pose(b, between(r_i, r_j), q_i, q_j);
    const BondLoads<double> l = b.law->loads(b, pose, no_history);
    RC_ASSERT(norm(l.F) + norm(l.M_ij) + norm(l.M_ji) < 1e-13 * stiffness_of(b).c_A);
    RC_ASSERT(std::abs(norm(pose.r_ij) - b.a - 0.7) < 1e-15 * 10);
  }
}

// Turning and moving two bent particles together changes no energy and turns the loads along.
RC_GTEST_PROP(BentBond, IsIndifferentToRigidMotion, (unsigned seed)) {
  testing::PoseSource random(seed);
  for (const BondLaw* law : bond_laws()) {
    testing::Specimen s = testing::straight_rod(2, testing::papers_bond(law));
    State bent = s.state;
    bent.r[ParticleId{1}] += random.vector(0.1);
    bent.q[ParticleId{1}] = random.rotation(0.6);
    const Quatd Q = random.rotation(3.1);
    const Vec3d shift = random.vector(10.0);
    State moved = bent;
    for (const ParticleId p : moved.r.ids()) {
      moved.r[p] = shift + rotate(Q, bent.r[p]);
      moved.q[p] = Q * bent.q[p];
    }
    Loads l{PerParticle<Vec3d>(2), PerParticle<Vec3d>(2)}, m = l;
    add_bond_loads(bent, l);
    add_bond_loads(moved, m);
    // positions of size 10 are known to 2e-15, which stiffness B1 = 1 turns into force
    RC_ASSERT(norm(rotate(Q, l.F[ParticleId{0}]) - m.F[ParticleId{0}]) < 1e-13);
    RC_ASSERT(norm(rotate(Q, l.M[ParticleId{1}]) - m.M[ParticleId{1}]) < 1e-13);
    RC_ASSERT(std::abs(bond_energies(bent).potential() - bond_energies(moved).potential()) < 1e-14);
  }
}

RC_GTEST_PROP(NewBond, DoesNotDependOnTheOrderOfItsParticles, (unsigned seed)) {
  testing::PoseSource random(seed);
  BondRecipe recipe = testing::papers_bond();
  recipe.attachment = Attachment::surfaces;
  const Vec3d r_i{}, r_j = random.vector(1.0) + Vec3d{2, 0, 0};
  const BondSite i{ParticleId{0}, r_i, random.rotation(3.1), 0.2},
      j{ParticleId{1}, r_j, random.rotation(3.1), 0.4};
  State s;
  s.r = {r_i, r_j + random.vector(0.2)};
  s.q = {random.rotation(0.5) * i.q, random.rotation(0.5) * j.q};
  State t = s;
  s.bonds.push_back(make_bond(recipe, i, j).value());
  t.bonds.push_back(make_bond(recipe, j, i).value());
  Loads a{PerParticle<Vec3d>(2), PerParticle<Vec3d>(2)}, b = a;
  add_bond_loads(s, a);
  add_bond_loads(t, b);
  for (const ParticleId p : s.r.ids()) {
    RC_ASSERT(norm(a.F[p] - b.F[p]) < 1e-13);
    RC_ASSERT(norm(a.M[p] - b.M[p]) < 1e-13);
  }
}

TEST(NewBond, IsRefusedWithoutLength) {
  BondRecipe recipe = testing::papers_bond();
  recipe.attachment = Attachment::surfaces;
  const BondSite i{ParticleId{0}, {0, 0, 0}, {}, 0.5}, touching{ParticleId{1}, {1, 0, 0}, {}, 0.5};
  EXPECT_FALSE(make_bond(recipe, i, touching).has_value());
}

TEST(BondN2, FollowsItsRule) {
  EXPECT_EQ(bond_n_2({1, 0, 0}, {}), (Vec3d{0, 1, 0}));  // least aligned, first of equals
  EXPECT_EQ(bond_n_2({0, 0, 1}, {}), (Vec3d{1, 0, 0}));
  EXPECT_EQ(bond_n_2({1, 0, 0}, Vec3d{5, 0, 2}), (Vec3d{0, 0, 1}));  // made normal to the bond
  EXPECT_EQ(bond_n_2({1, 0, 0}, Vec3d{5, 0, 0}), (Vec3d{0, 1, 0}));  // along the bond: back to the rule
}

}  // namespace
}  // namespace vbond
