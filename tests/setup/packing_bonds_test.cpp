// Bonds of packings: sections that follow radii, stiffnesses per area, necks, strengths.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <tuple>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "packing/plain_voronoi.hpp"
#include "two_sizes.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/setup/bond_pairs.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::packing_bonds_test {
namespace {

using namespace two_sizes;
using testing::campaign;
using testing::Dice;
using testing::Tally;

// ---- sections and stiffnesses ----------------------------------------------------------------------

struct RandomBond {
  BondRecipe recipe;
  BondSite i, j;
  double gap = 0;
  TheoryParameters& theory() { return std::get<TheoryParameters>(recipe.parameters); }
};

double near(double x, double y) {
  return std::abs(x / y - 1.0);
}

/// A bond of theory `parallel` whose section follows radii, between grains of different size anywhere.
RandomBond random_parallel(Dice& dice) {
  RandomBond b;
  TheoryParameters p;
  p.theory = BondTheory::parallel;
  const double R_i = dice.ratio(0.1, 10.0), R_j = R_i * dice.ratio(0.2, 5.0);
  p.of_radii = {dice(0.1, 1.0), dice.chance(0.3)};
  if (p.of_radii.of_mean) p.of_radii.factor *= 2.0 * std::min(R_i, R_j) / (R_i + R_j);
  if (dice.chance(0.4)) {
    p.material.E = dice.ratio(0.1, 10.0), p.per_area.ratio = dice.ratio(0.5, 5.0);
  } else {
    p.per_area.k_n = dice.ratio(0.1, 10.0), p.per_area.k_s = dice.ratio(0.1, 10.0);
  }
  if (dice.chance(0.3))
    p.per_area.grain_k_n = dice.ratio(0.1, 10.0), p.per_area.grain_k_s = dice.ratio(0.1, 10.0);
  b.recipe.parameters = p;
  b.recipe.law = named_laws()[dice.below(named_laws().size())];
  b.recipe.attachment = Attachment::neck;
  b.gap = dice(-0.02, 0.3) * p.of_radii.factor * p.of_radii.factor * std::min(R_i, R_j);
  const Vec3d r = dice.vector(R_i);
  b.i = {ParticleId{0}, r, dice.rotation(3.0), R_i, 1.0, 1.0};
  b.j = {ParticleId{1}, r + (R_i + R_j + b.gap) * dice.direction(), dice.rotation(3.0), R_j, 1.0, 1.0};
  return b;
}

TEST(PackingBonds, OfStiffnessesPerAreaHaveThemTimesTheirOwnSection) {
  const Tally tally = campaign("parallel bonds", 500, [](unsigned seed, Tally& t) {
    Dice dice(seed);
    RandomBond b = random_parallel(dice);
    const TheoryParameters& p = b.theory();
    const double R = p.of_radii.of_mean ? (b.i.radius + b.j.radius) / 2 : std::min(b.i.radius, b.j.radius),
                 r = p.of_radii.factor * R, A = M_PI * r * r, J = M_PI * r * r * r * r / 4;
    double k_n = p.per_area.k_n, k_s = p.per_area.k_s;
    if (p.per_area.ratio > 0) k_n = p.material.E / (b.i.radius + b.j.radius), k_s = k_n / p.per_area.ratio;
    if (p.per_area.grain_k_n > 0) k_n = k_n * p.per_area.grain_k_n / (p.per_area.grain_k_n + 2 * k_n);
    if (p.per_area.grain_k_s > 0) k_s = k_s * p.per_area.grain_k_s / (p.per_area.grain_k_s + 2 * k_s);
    const BondStiffness<double> c = stiffness_of(b.recipe, 1.0, {b.i.radius, b.j.radius});
    t.below("error of c_A, c_D, c_B, c_T",
            std::max(
                {near(c.c_A, A * k_n), near(c.c_D, A * k_s), near(c.c_B, J * k_n), near(c.c_T, 2 * J * k_s)}),
            3e-15);
    const auto bond = make_bond(b.recipe, b.i, b.j);
    ASSERT_TRUE(bond);
    // through the coefficients of a law, B2 = c_B - B3/2: what rounding of the larger one leaves
    const BondStiffness<double> k = stiffness_of(*bond);
    const double scale = c.c_B + c.c_D * bond->a * bond->a + c.c_T;
    t.below("error of the law's",
            std::max({near(k.c_A, c.c_A), near(k.c_D, c.c_D), std::abs(k.c_B - c.c_B) / scale,
                      std::abs(k.c_T - c.c_T) / scale}),
            1e-14);
  });
  EXPECT_EQ(tally["right"], tally.cases);
}

// [PC04] eqs. (13) to (15) in one step from rest: forces k A u at the contact point, moments k I theta and
// k J theta, which act on the two particles with the lever of the contact point.
TEST(PackingBonds, AreParallelBondsAtTheContactPoint) {
  const Tally tally =
      campaign("parallel bonds against their own definition", 500, [](unsigned seed, Tally& t) {
        Dice dice(seed);
        RandomBond b = random_parallel(dice);
        const auto bond = make_bond(b.recipe, b.i, b.j);
        ASSERT_TRUE(bond);
        const BondStiffness<double> c = stiffness_of(b.recipe, 1.0, {b.i.radius, b.j.radius});
        const Vec3d n = normalised(b.j.r - b.i.r);
        const double to_i = b.i.radius + 0.5 * b.gap,
                     to_j = b.j.radius + 0.5 * b.gap;  // of the contact point
        // of the length of the bond, which also the turns of the grains shift their surfaces by
        const double size = 1e-6 * bond->a, turn = size / (to_i + to_j);
        const Vec3d u_i = size * dice.vector(1.0), u_j = size * dice.vector(1.0);
        const Vec3d w_i = turn * dice.vector(1.0), w_j = turn * dice.vector(1.0);
        const Vec3d u = u_j + cross(w_j, -to_j * n) - u_i - cross(w_i, to_i * n), w = w_j - w_i;
        const Vec3d F = c.c_A * dot(u, n) * n + c.c_D * (u - dot(u, n) * n);  // on i
        const Vec3d M = c.c_T * dot(w, n) * n + c.c_B * (w - dot(w, n) * n);
        const Vec3d M_i = M + cross(to_i * n, F), M_j = -M + cross(-to_j * n, -F);

        const Vec3d r_ij = b.j.r + u_j - b.i.r - u_i;
        const BondLoads<double> l = bond->law->loads(
            *bond, bond_pose(*bond, r_ij, rotation_of(w_i) * b.i.q, rotation_of(w_j) * b.j.q), {});
        // a bond turns by M/c_B, and its force by M/a times that: of second order in the motion
        const double force = norm(F) + norm(M) / bond->a,
                     moment = norm(M_i) + norm(M_j) + norm(F) * (to_i + to_j);
        t.below("error of the force", norm(l.F - F) / force, 2e-5);
        t.below("error of the moments", std::max(norm(l.M_ij - M_i), norm(l.M_ji - M_j)) / moment, 2e-5);
      });
  EXPECT_EQ(tally["right"], tally.cases);
}

TEST(PackingBonds, AreMadeOfTheKeysOfACase) {
  const Built b =
      build(of_two_sizes("gap = 0.11\nattach = \"neck\"\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = "
                         "{ shape = \"circle\", factor "
                         "= 0.5 }\n"));
  ASSERT_EQ(b.state.bonds.size(), 3u);
  for (const Bond& bond : b.state.bonds) {
    const double R = std::min(b.model.radius[bond.i], b.model.radius[bond.j]), A = M_PI * 0.25 * R * R;
    EXPECT_NEAR(stiffness_of(bond).c_A, 3 * A, 1e-14 * A);
    EXPECT_NEAR(stiffness_of(bond).c_D, 2 * A, 1e-14 * A);
    EXPECT_NEAR(stiffness_of(bond).c_B, 3 * A * 0.25 * R * R / 4, 1e-14 * A * R * R);
    EXPECT_NEAR(stiffness_of(bond).c_T, 2 * A * 0.25 * R * R / 2, 1e-14 * A * R * R);
  }
  const Built beams =
      build(of_two_sizes("gap = 0.11\ntheory = \"bernoulli-euler\"\nE = 7\nnu = 0.2\nsection = { shape = "
                         "\"circle\", factor = 0.5, of = "
                         "\"mean\" }\n"));
  for (const Bond& bond : beams.state.bonds) {
    const double r = 0.25 * (b.model.radius[bond.i] + b.model.radius[bond.j]);
    EXPECT_NEAR(stiffness_of(bond).c_A, 7 * M_PI * r * r / bond.a, 1e-13);
    EXPECT_NEAR(stiffness_of(bond).c_B, 7 * M_PI * std::pow(r, 4) / 4 / bond.a, 1e-13);
  }
}

// ---- necks -----------------------------------------------------------------------------------------

TEST(PackingBonds, ANeckIsAsLongAsTheCementInItsSection) {
  Dice dice(3);
  for (int k = 0; k < 200; ++k) {
    const double R_i = dice.ratio(0.1, 10.0), R_j = dice.ratio(0.1, 10.0);
    const double r = dice(0.02, 1.0) * std::min(R_i, R_j), gap = dice(-0.1, 0.1) * r;
    // volume between the two surfaces inside a cylinder of radius r, by the midpoint rule in rho^2
    constexpr int n = 20000;
    double mean = 0.0;
    for (int m = 0; m < n; ++m) {
      const double rho2 = r * r * (m + 0.5) / n;
      mean += (gap + R_i - std::sqrt(R_i * R_i - rho2) + R_j - std::sqrt(R_j * R_j - rho2)) / n;
    }
    // the rule is right to 1/n^(3/2) of R where the surface is steep: r = R
    EXPECT_NEAR(neck_length(gap, r, R_i, R_j), mean, 1e-6 * r) << k;
    EXPECT_NEAR(neck_length(gap, 1e-5 * r, R_i, R_j), gap, 1e-9 * r);
  }
}

TEST(PackingBonds, ANeckHasItsMiddleBetweenTheSurfaces) {
  campaign("necks", 200, [](unsigned seed) {
    Dice dice(seed);
    RandomBond b = random_parallel(dice);
    const auto bond = make_bond(b.recipe, b.i, b.j);
    ASSERT_TRUE(bond);
    const Vec3d n = normalised(b.j.r - b.i.r);
    const double distance = norm(b.j.r - b.i.r);
    EXPECT_NEAR(bond->R_i + bond->a + bond->R_j, distance, 1e-13 * distance);
    EXPECT_NEAR(bond->R_i + 0.5 * bond->a, b.i.radius + 0.5 * b.gap, 1e-13 * distance);
    EXPECT_NEAR(
        bond->a,
        neck_length(b.gap, section_of(b.theory(), {b.i.radius, b.j.radius}).r, b.i.radius, b.j.radius),
        1e-13 * distance);
    EXPECT_NEAR(norm(n), 1.0, 1e-14);
  });
}

TEST(PackingBonds, WithoutLengthSayThatNecksHaveOne) {
  const std::string parallel =
      "theory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape = \"circle\", factor = 0.5 }\n";
  const std::string surfaces = mistake_of("gap = 0\nattach = \"surfaces\"\n" + parallel);
  EXPECT_TRUE(contains(surfaces, "attach = \"neck\" takes the length from the section")) << surfaces;
  EXPECT_EQ(mistake_of("gap = 0\nattach = \"neck\"\n" + parallel), "");
  const std::string deep = mistake_of("gap = 0\nattach = \"neck\"\n" + parallel,
                                      "[[specimen]]\nname = \"in\"\nkind = \"list\"\npositions = [[20, 0, "
                                      "0], [21, 0, 0]]\nradius = 1\nmass = 1\n");
  EXPECT_TRUE(contains(deep, "the mean gap of the surfaces over its section")) << deep;
  const std::string wide = mistake_of(
      "gap = 0\nattach = \"neck\"\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape = \"circle\", "
      "factor = 1.1 }\n");
  EXPECT_TRUE(contains(wide, "radius <= R_i and R_j")) << wide;
  EXPECT_TRUE(contains(mistake_of("gap = 0\nattach = \"neck\"\n" + stiff), "which only a theory has here"));
  EXPECT_TRUE(contains(
      mistake_of("gap = 0\nattach = \"neck\"\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape "
                 "= \"given\", A = 1, J = 1, J_p = 1 }\n"),
      "add radius to the section"));
}

TEST(PackingBonds, SectionsByRadiiAreRefusedWhereThereIsNoTheoryForThem) {
  const std::string of_strength = mistake_of(
      "gap = 0\n" + stiff +
      "strength = { criterion = \"stress\", tension = 1, shear = 1, section = { shape = \"circle\", "
      "factor = 1 } }\n");
  EXPECT_TRUE(contains(of_strength, "only the section of a theory follows the radii")) << of_strength;
  const std::string softening = mistake_of(
      "gap = 0.11\ntheory = \"bernoulli-euler\"\nE = 1\nnu = 0\nsection = { shape = \"circle\", factor = 1 "
      "}\n"
      "softening = { tension = 1, fracture_energy = 100 }\n");
  EXPECT_TRUE(contains(softening, "bonds that soften have one section")) << softening;
}

// ---- strengths -------------------------------------------------------------------------------------

// Limits in stresses are those of each bond's own section, whatever factors its stiffnesses have: the same
// shares as with that section given.
TEST(PackingBonds, BreakByTheStressesOfTheirOwnSection) {
  const Tally tally = campaign("strengths of own sections", 500, [](unsigned seed, Tally& t) {
    Dice dice(seed);
    RandomBond own = random_parallel(dice);
    TheoryParameters& p = own.theory();
    if (dice.chance(0.6)) {
      p.theory =
          dice.one_of({BondTheory::bernoulli_euler, BondTheory::timoshenko, BondTheory::short_cylinder});
      p.material = {dice.ratio(0.1, 10.0), dice(-0.2, 0.4)}, p.kappa = 0.9;
    }
    if (dice.chance(0.7))
      own.recipe.factors = {dice.ratio(0.2, 5), dice.ratio(0.2, 5), dice.ratio(0.2, 5), dice.ratio(0.2, 5)};
    const double s = dice.ratio(0.1, 10.0), s_t = dice.ratio(0.1, 10.0), b = dice(0.0, 1.0),
                 s_c = dice.ratio(0.5, 5.0);
    const int which = dice.whole(0, 3);
    const auto strength = [&](const Section& section) {
      if (which == 0) return stress_strength(section, s, s_t, b, s_c);
      if (which == 1) return fibre_strength(section, s, s_t, s_c);
      if (which == 2) return mohr_coulomb_strength(section, s, 0.7, s_t, b);
      return mohr_coulomb_strength(section, s, 0.7, s_t);
    };
    const BondRadii radii{own.i.radius, own.j.radius};
    RandomBond given = own;
    own.recipe.rules.strength = strength(unit_section);
    own.recipe.rules.strength.own_section = true;
    given.theory().section = section_of(p, radii), given.theory().of_radii = {};
    given.recipe.rules.strength = strength(given.theory().section);
    const auto x = make_bond(own.recipe, own.i, own.j), y = make_bond(given.recipe, given.i, given.j);
    ASSERT_TRUE(x && y);
    EXPECT_EQ(rules_of(numbers_of(own.recipe.rules)), own.recipe.rules) << "a checkpoint loses something";
    const double size = x->a;
    const Vec3d r_ij = own.j.r - own.i.r + 0.1 * size * dice.vector(1.0);
    const Quatd q_i = rotation_of(0.1 * dice.vector(1.0)) * own.i.q,
                q_j = rotation_of(0.1 * dice.vector(1.0)) * own.j.q;
    const Failure<double> f = x->law->failure(*x, bond_pose(*x, r_ij, q_i, q_j), {}),
                          g = y->law->failure(*y, bond_pose(*y, r_ij, q_i, q_j), {});
    const double most =
        std::max({std::abs(g.utilisation), std::abs(g.tension), g.shear, g.bending, g.torsion});
    t.below("difference of shares",
            std::max({std::abs(f.tension - g.tension), std::abs(f.shear - g.shear),
                      std::abs(f.bending - g.bending), std::abs(f.torsion - g.torsion),
                      std::abs(f.compression - g.compression), std::abs(f.utilisation - g.utilisation)}) /
                most,
            1e-12);
    const double N = dice(-1.0, 1.0);
    const BreakCause cause = break_cause_of(*x, g, N), wanted = break_cause_of(*y, g, N);
    EXPECT_EQ(cause.mode, wanted.mode);
    t.below("difference of the limit told",
            std::abs(cause.limit - wanted.limit) / (std::abs(wanted.limit) + s), 1e-12);
  });
  EXPECT_EQ(tally["right"], tally.cases);
}

// A bond pulled in its axis breaks at sigma A of its own section, one bent at sigma J/r.
TEST(PackingBonds, BreakAtTheLoadsOfTheirOwnSection) {
  const Built b =
      build(of_two_sizes("gap = 0.11\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape = "
                         "\"circle\", factor = 0.5 }\nstrength = "
                         "{ criterion = \"stress\", tension = 1e-4, shear = 1e-4 }\n"));
  for (const Bond& bond : b.state.bonds) {
    const double r = 0.5 * std::min(b.model.radius[bond.i], b.model.radius[bond.j]), A = M_PI * r * r;
    const double u = 1e-4 * A / stiffness_of(bond).c_A;  // sigma A
    const Vec3d r_ij = between(b.state, bond), e = normalised(r_ij);
    const auto use = [&](double pull, double angle) {
      const Vec3d axis = normalised(cross(e, Vec3d{0.3, 0.5, 0.8}));
      const Quatd turn = rotation_of(0.5 * angle * axis), back = rotation_of(-0.5 * angle * axis);
      // the bonded points stay where they are, so that it only bends
      const Vec3d apart = (bond.a + pull) * e + bond.R_i * rotate(turn, e) + bond.R_j * rotate(back, e);
      return bond.law->failure(bond, bond_pose(bond, apart, turn, back), {}).utilisation;
    };
    EXPECT_NEAR(use(u, 0.0), 1.0, 1e-10);                              // positions round to 1e-11 of u
    const double angle = 1e-4 * (A * r / 4) / stiffness_of(bond).c_B;  // sigma J/r over c_B
    EXPECT_NEAR(use(0.0, angle), 1.0, 1e-4);                           // of small angles: 1e-3 squared, and N
  }
}

}  // namespace
}  // namespace vbond::packing_bonds_test
