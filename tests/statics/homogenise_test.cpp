// Elastic constants of periodic bodies, and what follows from them.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "campaigns/dice.hpp"
#include "crystals.hpp"
#include "derivative.hpp"
#include "packed.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/statics/homogenise.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::homogenise_test {
namespace {

using namespace testing;

double largest(const Constants& C) {
  double most = 0.0;
  for (const auto& row : C)
    for (const double x : row) most = std::max(most, std::abs(x));
  return most;
}
double difference(const Constants& a, const Constants& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) most = std::max(most, std::abs(a[i][j] - b[i][j]));
  return most;
}

/// Numbers of another program, of the same two packings (see packings.hpp).
struct Reference {
  const char* name;
  bool equals;
  double K_V, G_V, K_R, G_R, E_hill, nu_hill, A_U;
  double dE, dnu;                // of Hill's, with the logarithm of c_D
  std::array<double, 4> by_c_D;  // of C11, C12, C44, C56
};
constexpr Reference references[] = {
    {"HG1",
     true,
     0.6712434182689253,
     0.6045041718963423,
     0.6688365848511154,
     0.600954703030691,
     1.3910772815072885,
     0.1539815338714819,
     0.03313045419220817,
     0.4043746886905859,
     -0.09428263457659469,
     {0.3255938024874804, -0.15294814262430748, 0.21041674320017906, -0.004937840206951912}},
    {"HG2",
     false,
     0.35938836268545743,
     0.3040588111552661,
     0.3588668670238441,
     0.30341415529547217,
     0.7108157920409263,
     0.17011921731099508,
     0.012076537993046088,
     0.20053772596143613,
     -0.08695164248513272,
     {0.14707335008959777, -0.060483613981224864, 0.10762031399500717, -0.003839509871589973}}};

Packing packing_of(const Reference& r) {
  return r.equals ? packing_of_equals() : packing_of_sizes();
}

TEST(Homogenise, OfPackingsIsWhatAnotherProgramFinds) {
  for (const Reference& r : references)
    for (const bool evm : {false, true}) {
      const Specimen s = packed(packing_of(r), r.equals, evm, evm);
      const Homogenised found = homogenise(s.model, s.state);
      EXPECT_LT(difference(found.C, packing_of(r).C), 1e-11 * largest(found.C)) << r.name;
      for (const double stress : found.stress) EXPECT_NEAR(stress, 0.0, 1e-14) << r.name;
      EXPECT_EQ(found.floating, 0u);
      EXPECT_FALSE(found.moved);
      const ElasticConstants C(found.C);
      EXPECT_NEAR(C.voigt().K, r.K_V, 1e-11);
      EXPECT_NEAR(C.voigt().G, r.G_V, 1e-11);
      EXPECT_NEAR(C.reuss().K, r.K_R, 1e-11);
      EXPECT_NEAR(C.reuss().G, r.G_R, 1e-11);
      EXPECT_NEAR(C.hill().E(), r.E_hill, 1e-11);
      EXPECT_NEAR(C.hill().nu(), r.nu_hill, 1e-11);
      EXPECT_NEAR(C.anisotropy(), r.A_U, 1e-10);
    }
}

// With c_D alone against the other program; with all four against differences of C of eighth order: h^8/630
// is 1e-15, so that they are as right as C is, over the step.
TEST(Homogenise, KnowsHowConstantsFollowFromStiffnesses) {
  for (const Reference& r : references) {
    const Specimen s = packed(packing_of(r), r.equals, false, false);
    const Homogenised found = homogenise(s.model, s.state, {{}, true});
    ASSERT_EQ(found.derivatives.size(), 1u);
    const ConstantsBySet& by = found.derivatives[0];
    EXPECT_NEAR(by.c_D[0][0], r.by_c_D[0], 1e-10 * r.by_c_D[0]);
    EXPECT_NEAR(by.c_D[0][1], r.by_c_D[1], 1e-10 * r.by_c_D[0]);
    EXPECT_NEAR(by.c_D[3][3], r.by_c_D[2], 1e-10 * r.by_c_D[0]);
    EXPECT_NEAR(by.c_D[4][5], r.by_c_D[3], 1e-10 * r.by_c_D[0]);
    for (std::size_t part = 0; part < 4; ++part) {
      const Constants& exact = *std::array{&by.c_A, &by.c_D, &by.c_B, &by.c_T}[part];
      std::map<double, Constants> known;  // by the logarithm of the factor of this stiffness
      const auto C_at = [&](double x) -> const Constants& {
        if (const auto at = known.find(x); at != known.end()) return at->second;
        Specimen changed = s;
        for (Bond& b : changed.state.bonds) {
          BondStiffness<double> c = b.law->stiffness(b);
          *std::array{&c.c_A, &c.c_D, &c.c_B, &c.c_T}[part] *= std::exp(x);
          b.coefficients = b.law->from_stiffness(c, b.a, b.coefficients);
        }
        return known[x] = homogenise(changed.model, changed.state).C;
      };
      Constants slope{};
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j)
          slope[i][j] = testing::derivative([&](double x) { return C_at(x)[i][j]; }, 0.03);
      EXPECT_LT(difference(slope, exact), 1e-10 * largest(found.C)) << r.name << " " << part;
    }
  }
}

// All stiffnesses twice as large: so is C. So the four derivatives add up to C, over all sets.
TEST(Homogenise, DerivativesOfSetsAddUp) {
  Specimen s = packed(packing_of_sizes(), false, false, false);
  std::uint16_t set = 0;
  for (Bond& b : s.state.bonds) b.set = set++ % 3;
  const Homogenised found = homogenise(s.model, s.state, {{}, true});
  ASSERT_EQ(found.derivatives.size(), 3u);
  Constants sum{};
  for (const ConstantsBySet& by : found.derivatives)
    for (const Constants* part : {&by.c_A, &by.c_D, &by.c_B, &by.c_T})
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) sum[i][j] += (*part)[i][j];
  EXPECT_LT(difference(sum, found.C), 1e-12 * largest(found.C));
}

/// Cauchy's stress where the cell has this strain, symmetric, from where it stands.
SymmetricParts stress_at(const Specimen& s, const State& from, std::size_t k, double strain) {
  Specimen now = s;
  for (std::size_t e = 0; e < 3; ++e) now.model.cell.edges[e] = from.cell[e].along;
  std::array<CellComponent, 6> component{};
  component[k] = strained(k < 3 ? strain : 0.5 * strain);
  return stress_of(now, run_static_stage(now.model, cell_stage(component), from, {}).state);
}

// Of a body that was strained by some per cent, against differences of stresses.
TEST(Homogenise, OfAStrainedBodyIsHowItsStressGoesOn) {
  for (const bool evm : {false, true}) {
    const Specimen s = packed(packing_of_equals(), true, evm, false);
    std::array<CellComponent, 6> component{};
    component[2] = strained(-0.02), component[4] = strained(0.01);
    const State at = run_static_stage(s.model, cell_stage(component), s.state, {}).state;
    const Homogenised found = homogenise(s.model, at);
    EXPECT_GT(std::abs(found.stress[2]), 0.02);
    EXPECT_FALSE(found.moved);
    for (std::size_t k = 0; k < 6; ++k) {
      constexpr double step = 1e-5;
      const SymmetricParts more = stress_at(s, at, k, step), less = stress_at(s, at, k, -step);
      for (std::size_t l = 0; l < 6; ++l)
        EXPECT_NEAR(found.C[l][k], (more[l] - less[l]) / (2 * step), 2e-8) << k << l;
    }
  }
}

// One particle that is bonded to its own images: a simple cubic lattice, C11 = c_A, C44 = c_D/2, and so are
// the derivatives.
TEST(Homogenise, OfOneParticleIsItsLattice) {
  Specimen s = periodic_body(cube(1), {{0.2, 0.4, 0.1}});
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
  bond_within(s, 1.01, recipe);
  ASSERT_EQ(s.state.bonds.size(), 3u);
  const Homogenised found = homogenise(s.model, s.state, {{}, true});
  Constants exact{};
  for (std::size_t k = 0; k < 6; ++k) exact[k][k] = k < 3 ? 1.0 : 0.175;
  EXPECT_LT(difference(found.C, exact), 1e-14);
  Constants shear{};
  for (std::size_t k = 3; k < 6; ++k) shear[k][k] = 0.175;
  EXPECT_LT(difference(found.derivatives[0].c_D, shear), 1e-14);
  EXPECT_LT(largest(found.derivatives[0].c_B), 1e-14);
}

// Velocities, also those of the cell, are no part of the stress.
TEST(Homogenise, DoesNotCountVelocities) {
  Specimen s = packed(packing_of_equals(), true, false, false);
  const Constants C = homogenise(s.model, s.state).C;
  Dice dice(3);
  for (Vec3d& v : s.state.v) v = dice.vector(1.0);
  const Homogenised moving = homogenise(s.model, s.state);
  EXPECT_LT(difference(moving.C, C), 1e-13);
  for (const double stress : moving.stress) EXPECT_NEAR(stress, 0.0, 1e-13);
}

// A body out of balance is brought into balance: the same as if it had been, to the tolerance of an
// equilibrium.
TEST(Homogenise, LooksForBalanceFirst) {
  const Specimen s = packed(packing_of_equals(), true, false, false);
  Specimen shaken = s;
  Dice dice(5);
  for (Vec3d& r : shaken.state.r) r += dice.vector(0.01);
  const Homogenised found = homogenise(shaken.model, shaken.state);
  EXPECT_TRUE(found.moved);
  EXPECT_LT(difference(found.C, homogenise(s.model, s.state).C), 1e-7);
}

TEST(Homogenise, DoesNotDependOnWhereTheCellBegins) {
  const Packing p = packing_of_equals();
  const Constants C = homogenise(packed(p, true, false, false).model, packed(p, true, false, false).state).C;
  Specimen moved = packed(p, true, false, false);
  for (const ParticleId k : moved.state.r.ids()) moved.state.r[k] += Vec3d{0.3, -1.7, 5.1};
  moved.model.r_0 = moved.state.r;
  EXPECT_LT(difference(homogenise(moved.model, moved.state).C, C), 1e-12);
}

TEST(Homogenise, LeavesOutWhatFloats) {
  const Specimen s = packed(packing_of_equals(), true, false, false);
  Packing p = packing_of_equals();
  p.r.push_back({0.1, 0.2, 0.3});
  p.radius.push_back(0.01);
  const Specimen more = packed(p, true, false, false);
  const Homogenised found = homogenise(more.model, more.state);
  EXPECT_EQ(found.floating, 1u);
  EXPECT_LT(difference(found.C, homogenise(s.model, s.state).C), 1e-12);
}

TEST(Homogenise, OfABodyThatHangsTogetherWithNoneOfItsImagesIsZero) {
  Specimen s = packed(packing_of_equals(), true, false, false);
  s.state.bonds.resize(1);
  const Homogenised found = homogenise(s.model, s.state);
  EXPECT_EQ(found.floating, s.model.particles());
  EXPECT_EQ(found.C, decltype(found.C){});
  EXPECT_EQ(found.stress, decltype(found.stress){});
}

void expect_refused(const Specimen& s, const std::string& because, const HomogeniseSettings& settings = {}) {
  try {
    homogenise(s.model, s.state, settings);
    FAIL() << "not refused: " << because;
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find(because), std::string::npos) << e.what();
  }
}

TEST(Homogenise, RefusesWhatIsNoMaterial) {
  Specimen open = packed(packing_of_equals(), true, false, false);
  open.model.cell.periodic[1] = false;
  expect_refused(open, "periodic in all three directions");

  // A chain of hinges across the cell: its middle particles move at no cost.
  Specimen hinges = periodic_body(cube(3), {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  BondRecipe axial;
  axial.parameters = BondStiffness<double>{1.0, 0.0, 0.0, 0.0};
  bond_within(hinges, 1.01, axial);
  expect_refused(hinges, "no stiffness");

  Specimen kinked = packed(packing_of_equals(), true, false, false);
  BondRules rules;
  rules.stretch.form = StretchForm::two_slopes, rules.stretch.compression = 0.5;
  for (Bond& b : kinked.state.bonds) b.law = with_rules(*b.law, rules), b.rules = &kept(rules);
  expect_refused(kinked, "slopes in tension and compression");

  // One particle is bonded to its own images, another one presses against its own.
  Specimen touching = periodic_body(cube(2), {{0, 0, 0}, {1, 1, 1}});
  for (const Image& n : {Image{1, 0, 0}, Image{0, 1, 0}, Image{0, 0, 1}})
    bond_image(touching, 0, 0, n, recipe_of(packing_of_equals(), {}, true));
  touching.model.radius[ParticleId{1}] = 1.01;
  touching.model.contact.law = ContactLaw::linear, touching.model.contact.k = 1.0;
  expect_refused(touching, "particles 1 and 1 touch", {{}, true});

  Specimen stressed = packed(packing_of_equals(), true, false, false);
  for (CellEdge& e : stressed.state.cell) e.along = 1.01 * e.along;
  for (Vec3d& r : stressed.state.r) r = 1.01 * r;
  expect_refused(stressed, "is strained", {{}, true});
}

/// C by differences of stresses, which are sums of forces; of equilibria that Newton's method finds.
Constants by_differences(const Specimen& s) {
  Constants C{};
  constexpr double step = 1e-5;
  for (std::size_t k = 0; k < 6; ++k) {
    const SymmetricParts more = stress_at(s, s.state, k, step), less = stress_at(s, s.state, k, -step);
    for (std::size_t l = 0; l < 6; ++l) C[l][k] = (more[l] - less[l]) / (2 * step);
  }
  return C;
}

// Random cells of 1 to 12 particles and of any shape, bonds of any stiffness to all that are near, also to
// own images, of both laws; against differences of stresses. As many as VBOND_CAMPAIGN says.
TEST(Homogenise, CampaignOfRandomCells) {
  const char* given = std::getenv("VBOND_CAMPAIGN");
  const unsigned count = given != nullptr ? static_cast<unsigned>(std::atoi(given)) : 12;
  unsigned right = 0, wrong = 0, refused = 0;
  for (unsigned seed = 1; seed <= count; ++seed) {
    Dice dice(seed);
    const std::size_t n = dice.count(1, 12);
    const double side = std::cbrt(double(n)) * dice(0.9, 1.1);
    const Edges edges{Vec3d{side, 0, 0}, Vec3d{dice(-0.4, 0.4) * side, side, 0},
                      Vec3d{dice(-0.4, 0.4) * side, dice(-0.4, 0.4) * side, side}};
    std::vector<Vec3d> r;
    for (std::size_t k = 0; k < n; ++k)
      r.push_back(dice(0, 1) * edges[0] + dice(0, 1) * edges[1] + dice(0, 1) * edges[2]);
    Specimen s = periodic_body(edges, r);
    BondRecipe recipe;
    recipe.law = dice.chance(0.5) ? &bond_law<VModel> : &bond_law<Evm>;
    recipe.parameters = BondStiffness<double>{1.0, 1.0, 1.0, 1.0};
    bond_within(s, dice(1.0, 1.6), recipe);
    for (Bond& b : s.state.bonds)
      b.coefficients = b.law->from_stiffness(
          {dice.ratio(0.3, 3), dice.ratio(0.1, 3), dice.ratio(0.03, 1), dice.ratio(0.03, 1)}, b.a,
          b.coefficients);
    std::optional<Homogenised> found;
    try {
      found = homogenise(s.model, s.state, {{}, true});
    } catch (const NoEquilibrium&) {  // nothing holds some particles together
      ++refused;
      continue;
    }
    Constants sum{};
    for (const ConstantsBySet& by : found->derivatives)
      for (const Constants* part : {&by.c_A, &by.c_D, &by.c_B, &by.c_T})
        for (std::size_t i = 0; i < 6; ++i)
          for (std::size_t j = 0; j < 6; ++j) sum[i][j] += (*part)[i][j];
    const double scale = std::max(largest(found->C), 1e-3),
                 off = difference(found->C, by_differences(s)) / scale,
                 off_sum = difference(sum, found->C) / scale;
    if (off < 1e-6 && off_sum < 1e-10) {
      ++right;
    } else {
      ++wrong;
      ADD_FAILURE() << "seed " << seed << ": " << n << " particles, " << found->bonds << " bonds: off by "
                    << off << ", the derivatives by " << off_sum;
    }
  }
  std::printf("homogenise: %u cells: %u right, %u wrong, %u refused\n", count, right, wrong, refused);
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(right, count / 2);
}

// ---- of constants alone -----------------------------------------------------------------------

// Copper. Closed forms of cubic crystals: Nye, Physical Properties of Crystals, and Kittel for waves along
// 110.
TEST(ElasticConstants, OfACubicCrystalAreItsClosedForms) {
  const double C11 = 168.4, C12 = 121.4, C44 = 75.4, density = 8.93;
  const ElasticConstants C(cubic(C11, C12, C44));
  const double d = (C11 - C12) * (C11 + 2 * C12), S11 = (C11 + C12) / d, S12 = -C12 / d, S44 = 1 / C44;
  testing::Dice dice(7);
  for (int k = 0; k < 200; ++k) {
    const Vec3d n = normalised(dice.direction()), m = normalised(across(dice.direction(), n));
    const double J = sq(n.x * n.y) + sq(n.y * n.z) + sq(n.z * n.x),
                 H = sq(n.x * m.x) + sq(n.y * m.y) + sq(n.z * m.z), S = S11 - S12 - 0.5 * S44;
    EXPECT_NEAR(C.youngs_modulus(3.0 * n), 1 / (S11 - 2 * S * J), 1e-11);
    EXPECT_NEAR(C.poissons_ratio(n, m + 2.0 * n), -(S12 + S * H) / (S11 - 2 * S * J), 1e-13);
    EXPECT_NEAR(C.shear_modulus(n, m), 1 / (S44 + 4 * S * H), 1e-11);
  }
  const Directed least = C.least_youngs_modulus(), most = C.largest_youngs_modulus();
  EXPECT_NEAR(least.value, 1 / S11, 1e-8);
  EXPECT_NEAR(std::max({std::abs(least.along.x), std::abs(least.along.y), std::abs(least.along.z)}), 1, 1e-8);
  EXPECT_NEAR(most.value, 1 / (S11 - 2.0 / 3.0 * (S11 - S12 - 0.5 * S44)), 1e-8);
  EXPECT_NEAR(std::abs(most.along.x * most.along.y * most.along.z), std::pow(3.0, -1.5), 1e-6);
  const WaveSpeeds along_110 = C.wave_speeds({1, 1, 0}, density);
  EXPECT_NEAR(along_110[0].value, std::sqrt((C11 - C12) / 2 / density), 1e-13);
  EXPECT_NEAR(along_110[1].value, std::sqrt(C44 / density), 1e-13);
  EXPECT_NEAR(along_110[2].value, std::sqrt((C11 + C12 + 2 * C44) / 2 / density), 1e-13);
  EXPECT_NEAR(std::abs(along_110[1].along.z), 1, 1e-12);
}

TEST(ElasticConstants, OfAnIsotropicMaterialAreAllTheSame) {
  const double K = 50, G = 30;
  const ElasticConstants C(cubic(K + 4 * G / 3, K - 2 * G / 3, G));
  for (const IsotropicConstants& m : {C.voigt(), C.reuss(), C.hill()}) {
    EXPECT_NEAR(m.K, K, 1e-12);
    EXPECT_NEAR(m.G, G, 1e-12);
  }
  EXPECT_NEAR(C.hill().E(), 75, 1e-12);
  EXPECT_NEAR(C.hill().nu(), 0.25, 1e-14);
  EXPECT_NEAR(C.anisotropy(), 0, 1e-13);
  EXPECT_NEAR(C.largest_youngs_modulus().value, 75, 1e-11);
}

TEST(ElasticConstants, WithoutStiffnessAreRefused) {
  EXPECT_THROW(ElasticConstants(cubic(1, 1, 1)), std::invalid_argument);
  EXPECT_THROW(ElasticConstants(cubic(NAN, 0, 1)), std::invalid_argument);
  Constants C = cubic(3, 1, 1);
  C[0][1] = 1.1;
  EXPECT_THROW(ElasticConstants{C}, std::invalid_argument);
}

}  // namespace
}  // namespace vbond::homogenise_test
