// Stress and strain of bodies of particles.
#include "vbond/model/stress.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/rods.hpp"

namespace vbond {
namespace {

using testing::Specimen;

constexpr std::size_t side = 4;

/// A cube of particles, one apart, each bonded to its neighbours along the axes; R: attachments at both ends.
Specimen cube(double R = 0.0) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < side * side * side; ++k)
    r.push_back({static_cast<double>(k % side), static_cast<double>(k / side % side),
                 static_cast<double>(k / side / side)});
  Specimen s = testing::particles_at(r);
  BondRecipe recipe = testing::papers_bond();
  recipe.attachment = Attachment::given, recipe.R_i = R, recipe.R_j = 0.5 * R;
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm(r[j] - r[i]) < 1.1) testing::bond(s, i, j, recipe);
  return s;
}
/// Positions stretched by these parts along the axes, then turned as a whole.
void deform(Specimen& s, const Vec3d& by, const Quatd& turn = {}, const Vec3d& shift = {}) {
  for (const ParticleId p : s.state.r.ids()) {
    const Vec3d& r = s.model.r_0[p];
    s.state.r[p] = rotate(turn, {r.x * (1 + by.x), r.y * (1 + by.y), r.z * (1 + by.z)}) + shift;
    s.state.q[p] = turn;
  }
}
SymmetricParts stress_of(const Specimen& s, double volume) {
  return symmetric_part(
      mean_stress(s.state, stress_times_volume(s.model, s.state), s.model.groups[0].particles, volume));
}

// A bond in each of 16 lines: force over area, with the area that the lines have.
TEST(Stress, OfABlockInTensionIsForceOverArea) {
  for (const double R : {0.0, 0.2}) {
    Specimen s = cube(R);
    const double e = 0.01, N = stiffness_of(s.state.bonds[BondId{0}]).c_A * e;
    deform(s, {e, 0, 0});
    const double area = 16.0, length = 3.0 * (1 + e);
    const SymmetricParts sigma = stress_of(s, area * length);
    EXPECT_NEAR(sigma[0], 16 * N / area, 1e-14);
    for (std::size_t k = 1; k < 6; ++k) EXPECT_NEAR(sigma[k], 0.0, 1e-15) << k;
    // inside, a particle's two bonds pull at half a length each, or parts that add up to one
    const ParticleId inner{1 + side + side * side};
    const SymmetricParts own = symmetric_part(stress_times_volume(s.model, s.state)[inner]);
    EXPECT_NEAR(own[0], N * (1 + e), 1e-14);
  }
}

TEST(Stress, OfABlockUnderPressureIsTheSameInAllDirectionsAndTurnsWithIt) {
  Specimen s = cube();
  deform(s, {-0.01, -0.01, -0.01});
  const double N = -0.01 * stiffness_of(s.state.bonds[BondId{0}]).c_A, expected = 16 * N * 3 * 0.99 / 27.0;
  for (const Quatd& turn : {Quatd{}, rotation_of({0.3, -1.0, 2.0})}) {
    deform(s, {-0.01, -0.01, -0.01}, turn, {5, -3, 1});
    const SymmetricParts sigma = stress_of(s, 27.0);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(sigma[k], expected, 1e-14);
    for (std::size_t k = 3; k < 6; ++k) EXPECT_NEAR(sigma[k], 0.0, 1e-14);
  }
  // tension along x, turned by a right angle about z, is tension along y
  deform(s, {0.01, 0, 0}, rotation_of({0, 0, M_PI / 2}));
  const SymmetricParts sigma = stress_of(s, 27.0);
  EXPECT_NEAR(sigma[1], 16 * 0.01 * 3 * 1.01 / 27.0, 1e-14);
  EXPECT_NEAR(sigma[0], 0.0, 1e-14);
}

TEST(Stress, IsZeroAfterARigidMotionAndSoIsStrain) {
  Specimen s = cube(0.2);
  deform(s, {}, rotation_of({0.7, 0.2, -1.5}), {10, -20, 3});
  for (const double x : stress_of(s, 27.0)) EXPECT_NEAR(x, 0.0, 1e-13);
  for (const double x : symmetric_part(mean_strain(s.model, s.state, s.model.groups[0].particles)))
    EXPECT_NEAR(x, 0.0, 1e-13);
}

TEST(Strain, IsThatOfADeformationThatIsTheSameEverywhere) {
  Specimen s = cube();
  deform(s, {0.02, -0.01, 0.0}, rotation_of({0.3, 0.4, 0.5}));
  SymmetricParts E = symmetric_part(mean_strain(s.model, s.state, s.model.groups[0].particles));
  EXPECT_NEAR(E[0], 0.5 * (1.02 * 1.02 - 1), 1e-13);
  EXPECT_NEAR(E[1], 0.5 * (0.99 * 0.99 - 1), 1e-13);
  for (const std::size_t k : {2, 3, 4, 5}) EXPECT_NEAR(E[k], 0.0, 1e-13);
  for (const ParticleId p : s.state.r.ids()) {  // simple shear: x grows by 0.1 y
    const Vec3d& r = s.model.r_0[p];
    s.state.r[p] = {r.x + 0.1 * r.y, r.y, r.z};
  }
  E = symmetric_part(mean_strain(s.model, s.state, s.model.groups[0].particles));
  EXPECT_NEAR(E[5], 0.05, 1e-13);
  EXPECT_NEAR(E[1], 0.005, 1e-13);
}

TEST(Strain, OfParticlesInOnePlaneIsNotANumber) {
  std::vector<Vec3d> r;
  for (int k = 0; k < 9; ++k)
    r.push_back(rotate(rotation_of({0.3, 0.4, 0.5}), Vec3d{k % 3 * 1.1, k / 3 * 0.9, 0.1}));
  const Specimen s = testing::particles_at(r);
  EXPECT_TRUE(std::isnan(symmetric_part(mean_strain(s.model, s.state, s.model.groups[0].particles))[0]));
}

// Two balls that press on each other: force times distance of the centres, compression negative; and what
// they remember of slip comes on top.
TEST(Stress, OfTouchingBallsIsTheirForceTimesTheDistance) {
  Specimen s = testing::particles_at({{0, 0, 0}, {0.7, 0, 0}}, 0.4);
  s.model.contact.law = ContactLaw::linear;
  s.model.contact.k = 10.0;
  SymmetricParts sum = stress_of(s, 1.0);
  EXPECT_NEAR(sum[0], -10.0 * 0.1 * 0.7, 1e-15);
  s.state.contact_history = {{ParticleId{0}, ParticleId{1}, {0, 0.3, 0}}};
  sum = stress_of(s, 1.0);
  EXPECT_NEAR(sum[0], -10.0 * 0.1 * 0.7, 1e-15);
  EXPECT_NEAR(sum[5], 0.5 * 0.3 * 0.7, 1e-15);
  s.model.contact.keeps_overlap = true;  // of an overlap of which a part is not felt
  s.state.contact_history = {{ParticleId{0}, ParticleId{1}, {}, 0.04}};
  EXPECT_NEAR(stress_of(s, 1.0)[0], -10.0 * 0.06 * 0.7, 1e-15);
}

// A pile of two balls between plates: force times the distance of the plates, and half of it for each ball;
// and what a wall remembers of friction, with the arm to where it acts.
TEST(Stress, OfBallsBetweenPlatesIsTheirForceTimesTheDistanceOfThese) {
  Specimen s = testing::particles_at({{0, 0, 0.3}, {0, 0, 1.0}}, 0.4);
  s.model.contact.law = ContactLaw::linear;
  s.model.contact.k = 10.0;
  s.model.walls = {{"floor", PlaneWall{{0, 0, -5}, {0, 0, 1}}, 0, {}},
                   {"lid", PlaneWall{{0, 0, 1.3}, {0, 0, -1}}, 0, {}}};
  s.state.walls.resize(2);
  s.state.walls[0].displacement = {0, 0, 5};
  EXPECT_NEAR(stress_of(s, 1.0)[2], -10.0 * 0.1 * 1.3, 1e-14);
  for (const ParticleId p : s.state.r.ids())
    EXPECT_NEAR(symmetric_part(stress_times_volume(s.model, s.state)[p])[2], -10.0 * 0.1 * 0.65, 1e-14);
  s.state.wall_history = {{ParticleId{1}, 1, {0, 0, -1}, {0.3, 0, 0}}};
  EXPECT_NEAR(stress_of(s, 1.0)[4], 0.5 * 0.3 * 0.3, 1e-14);
  Tensor between;
  for (const Tensor& t : stress_between_particles(s.model, s.state)) between += t;
  EXPECT_NEAR(symmetric_part(between)[2], -10.0 * 0.1 * 0.7, 1e-14);
  s.state.walls[1].off = 1;
  EXPECT_NEAR(stress_of(s, 1.0)[2], -10.0 * 0.1 * 1.0, 1e-14);
}

// Bonds that bend leave moments: the tensor is then not symmetric, by the moment that is left.
TEST(Stress, IsUnsymmetricByTheMomentOnAParticle) {
  Specimen s = cube();
  s.state.q[ParticleId{21}] = rotation_of({0, 0, 0.1});  // one inside is turned
  const Tensor of = stress_times_volume(s.model, s.state)[ParticleId{21}];
  const Vec3d about{of.row[1].z - of.row[2].y, of.row[2].x - of.row[0].z, of.row[0].y - of.row[1].x};
  Vec3d torque;  // of the forces alone, about the centre
  for (const BondId k : s.state.bonds.ids()) {
    const Bond& b = s.state.bonds[k];
    const Vec3d F = bond_loads(s.state, k).F, at = 0.5 * (s.state.r[b.i] + s.state.r[b.j]);
    if (b.i == ParticleId{21}) torque += cross(at - s.state.r[b.i], F);
    if (b.j == ParticleId{21}) torque += cross(at - s.state.r[b.j], -F);
  }
  EXPECT_GT(norm(torque), 1e-4);
  EXPECT_LT(norm(about - torque), 1e-15);
}

}  // namespace
}  // namespace vbond
