// Validation cases B5, E2, E3, K1, P1 and a portal frame: static solutions against exact ones of the same
// discrete body. E1d, E3 (pinned), E4, E5, E7, R1, K2 and K3 stand in tests/statics.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "static_bodies.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond::statics_exact_test {
namespace {

using testing::everybody;
using testing::fixed;
using testing::number;
using testing::pushed;
using testing::static_stage;
using testing::validation_case;

StaticOutcome solved(const testing::Specimen& s, const StaticStage& stage) {
  return run_static_stage(s.model, stage, s.state, {});
}

/// A rod of N bonds clamped at its first particle, with a force and a moment at its last.
StaticStage cantilever(std::size_t N, const Vec3d& force, const Vec3d& moment = {}) {
  return static_stage(StageKind::equilibrium, {fixed({ParticleId{0}}, testing::clamped)},
                      {pushed(N, force, moment)});
}

// B5: six particles bonded at their surfaces, R_i = R_j = 0.4, by short cylinders. The numbers are solutions
// of Newton's method in doubles whose residual is not stated. Stiffnesses and lengths are of order 1, so a
// residual of 1e-16 times the compliance, 17326, is 2e-12: 1e-9 of the smallest deflection.
TEST(SurfaceBondedCantilever, HasTheExactDiscreteTip) {
  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::short_cylinder, {1.0, 0.25}, circle(0.3), 0};
  recipe.attachment = Attachment::surfaces;
  const testing::Specimen s = testing::straight_rod(6, recipe);
  const auto& expected = validation_case("B5").at("expected");
  EXPECT_NEAR(s.state.bonds[BondId{0}].coefficients[1], expected.at("B")[1], 1e-15);
  for (const auto& [P, row] : expected.at("results").items()) {
    const Vec3d tip = solved(s, cantilever(5, {0, std::stod(P), 0})).state.r[ParticleId{5}];
    EXPECT_NEAR(tip.x, row.at("tip")[0], 1e-9) << "P = " << P;
    EXPECT_NEAR(tip.y / row.at("tip")[1].get<double>(), 1.0, 3e-9) << "P = " << P;
  }
  // at 1e-9 what is left of nonlinearity is (w / L)^2 = 1e-11
  const double w = solved(s, cantilever(5, {0, 1e-9, 0})).state.r[ParticleId{5}].y / 1e-9;
  EXPECT_NEAR(w / expected.at("linear_value").get<double>(), 1.0, 1e-9);
}

// E2: at 2 pi EI / L the chain is not yet a closed polygon. Balance is good to 1e-10 of that moment, and the
// tip turns by 1 per moment.
TEST(Cantilever, RolledUpByTwoPiHasTheExactDiscreteTip) {
  for (const auto& row : validation_case("E2").at("expected")) {
    const std::size_t N = row.at("N");
    const State open = solved(testing::rod50(N), cantilever(N, {}, {0, 0, 2 * M_PI})).state;
    const ParticleId tip{N};
    EXPECT_NEAR(open.r[tip].x, row.at("tip_at_2pi")[0], 3e-9) << "N = " << N;
    EXPECT_NEAR(open.r[tip].y, row.at("tip_at_2pi")[1], 3e-9) << "N = " << N;
    const double turn = number(row.at("theta_tip_at_2pi")) - 2 * M_PI;
    EXPECT_NEAR(rotation_vector(open.q[tip]).z, turn, 3e-9) << "N = " << N;
  }
}

// E3: a clamped rod of 2 N bonds and length 2 past buckling is four times half the pinned rod of N bonds and
// length 1, put together where that is straight (its pin: by symmetry no bond bends there) and where it does
// not turn. So it carries the same force, and deflects twice as far when shortened by twice as much. Forces
// are known to EA N eps = 7e-10 of 10 at N = 80.
TEST(ClampedElastica, IsFourHalvesOfThePinnedOnePastBuckling) {
  for (const char* shortening : {"0.1", "0.5"})
    for (const auto& row : validation_case("E3")
                               .at("expected")
                               .at("discrete")
                               .at(std::string("pinned_elastica_") + shortening)
                               .at("discrete")) {
      const std::size_t N = row.at("N");
      std::vector<Vec3d> r;
      for (std::size_t k = 0; k <= 2 * N; ++k)
        r.push_back({static_cast<double>(k) / static_cast<double>(N), 0, 0});
      const testing::Specimen s = testing::chain_through(r, 4e4);
      StaticStage stage =
          static_stage(StageKind::path,
                       {fixed(everybody(s), testing::in_plane), fixed({ParticleId{0}}, testing::clamped),
                        fixed({ParticleId{2 * N}}, testing::clamped, {-2 * std::stod(shortening), 0, 0})});
      stage.path.first_step = 1e-3;
      stage.path.above = 1.0;
      stage.path.branch = BranchSwitch{};
      stage.newton.tolerance = 1e-12;  // adds up over 160 particles to 2e-10 of the largest force
      const StaticOutcome bent = solved(s, stage);
      EXPECT_EQ(bent.result.ended, "load factor");
      Loads loads{PerParticle<Vec3d>(2 * N + 1), PerParticle<Vec3d>(2 * N + 1)};
      add_bond_loads(bent.state, loads);
      EXPECT_NEAR(loads.F[ParticleId{2 * N}].x / number(row.at("P")), 1.0, 1e-9) << "N = " << N;
      EXPECT_NEAR(std::abs(bent.state.r[ParticleId{N}].y), 2 * number(row.at("mid")), 1e-9) << "N = " << N;
    }
}

// K1: the paper's rod and longer ones. Bending at buckling is f kappa^2 against c_D = 0.03 of the tangent:
// at 80 particles rounding, 79 eps c_A + eps c_D / kappa^2, is 6e-9 of f (see tests/statics/buckling_test).
TEST(PapersRod, BucklesAtItsExactStaticForceHoweverLong) {
  for (const auto& [name, row] : validation_case("K1").at("expected").at("cases").items()) {
    const std::size_t N = std::stoul(name.substr(2));
    const testing::Specimen s = testing::straight_rod(N);
    StaticStage stage = static_stage(StageKind::buckling,
                                     {fixed({ParticleId{0}}, {true, true, true, true, false, false}),
                                      fixed({ParticleId{N - 1}}, {false, true, true, false, false, false})},
                                     {pushed(N - 1, {-1, 0, 0})});
    stage.count = 1;
    const StaticResult result = solved(s, stage).result;
    ASSERT_EQ(result.critical_loads.size(), 1u);
    EXPECT_NEAR(result.critical_loads[0].force / number(row.at("Pcr_exact_discrete")), 1.0, 6e-9) << name;
  }
}

// P1: a linear problem; at q = 1e-9 the plate of 48 bonds a side deflects by 8e-6 of a thickness of order 1,
// so nonlinear terms are 1e-10. Bending terms of the stiffness are n^-4 of c_D = 10 in size, and rounding,
// 1e-16 of that, is 5e-10 of what is left at n = 48.
TEST(TriangularPlate, SupportedAtItsEdgesHasTheExactDiscreteDeflection) {
  for (const auto& row : validation_case("P1").at("expected").at("discrete")) {
    const std::size_t n = row.at("n");
    if (n > 48) continue;
    const BondStiffness<double> c{1.0, 10.0, 0.25, 0.1};
    const testing::Plate plate = testing::triangular_plate(n, c, c);
    EXPECT_NEAR(testing::centre_deflection(plate, 1e-9) / 1e-9 / row.at("w_center").get<double>(), 1.0, 1e-8)
        << "n = " << n;
  }
}

// P1 again: its slowest mode. Rounding of the tangent, 1e-16 of c_D = 10, against omega^2 = 1.7e-4 at n = 48.
TEST(TriangularPlate, SupportedAtItsEdgesHasTheExactDiscreteFrequency) {
  for (const auto& row : validation_case("P1").at("expected").at("discrete")) {
    const std::size_t n = row.at("n");
    if (n > 48) continue;
    const BondStiffness<double> c{1.0, 10.0, 0.25, 0.1};
    const testing::Plate plate = testing::triangular_plate(n, c, c);
    StaticStage stage = static_stage(StageKind::modes, testing::supported_edges(plate));
    stage.count = 1;
    EXPECT_NEAR(solved(plate.specimen, stage).result.modes.at(0).omega / row.at("omega1").get<double>(), 1.0,
                1e-10)
        << "n = " << n;
  }
}

/// Sway of the corners of the portal per force on both of them, EI = L = 1, by slope-deflection: a column
/// whose chord turns by psi and whose top turns by theta has the moments 4 theta - 6 psi at the top, 2 theta
/// - 6 psi at a clamped foot, and 3 theta - 3 psi at the top above a pinned foot; the beam between ends that
/// both turn by theta 6 (theta - beta), where beta = 2 V / EA is the turn of its chord because the columns
/// stretch and shorten under its shear V = 12 (theta - beta). So theta - beta = s theta.
double sway_of_portal(double EA, bool clamped_feet) {
  const double s = EA / (EA + 24);
  const double force = clamped_feet ? 24 - 72 / (4 + 6 * s) : 12 * s / (1 + 2 * s);  // both, per psi
  return 2 / force;
}

// A chain of Bernoulli-Euler bonds is an exact beam at small load, and so is a frame of them, for any N. At
// 1e-4 per corner slopes are below 1e-4, and so is what the corners move towards each other, relative to the
// sway: their mean has no such term, and the next are squares of slopes, 1e-8.
TEST(Portal, SwaysAsSlopeDeflectionSays) {
  for (const bool clamped_feet : {false, true})
    for (const std::size_t N : {1u, 5u, 20u}) {
      const double EA = 1e3, H = 1e-4;
      const testing::Specimen s = testing::portal(N, EA);
      const State bent =
          solved(s, testing::portal_stage(StageKind::equilibrium, s, N, clamped_feet, {H, 0, 0})).state;
      const double sway = 0.5 * (bent.r[ParticleId{N}].x + bent.r[ParticleId{2 * N}].x - 1);
      EXPECT_NEAR(sway / (H * sway_of_portal(EA, clamped_feet)), 1.0, 1e-8)
          << "N = " << N << (clamped_feet ? ", clamped" : ", pinned");
    }
}

}  // namespace
}  // namespace vbond::statics_exact_test
