// Validation cases E1d, E5, R1 once more, brought to rest by damping: dynamics come to the same rest as
// statics. All of them, at all sizes and tolerances: tests/statics, statics_exact_test.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "rests.hpp"

namespace vbond::statics_test {
namespace {

using testing::load_on;
using testing::number;
using testing::validation_case;

const Support root = testing::held({ParticleId{0}}, testing::clamped);
/// Lowest frequency: 3.516 for a beam of EI = L = mass = 1, less for a chain whose tip weighs as much as its
/// other particles; 0.8 of it covers five bonds and more.
constexpr double cantilever_frequency = 2.8;

double turn_about_z(const State& s, std::size_t particle) {
  return rotation_vector(s.q[ParticleId{particle}]).z;
}

// Tolerances of this file: lengths are 1 and stiffness ratios EA / EI = 4e4; rounding of positions, 1e-16,
// makes forces uncertain by EA N 1e-16 and, after equilibrium, positions by 4e4 N 1e-16 = 2e-10 at N = 40.
// The reference states its own residual, below 1e-9 of a force of 1.
constexpr double tolerance = 1e-8;

TEST(Elastica, ComesToRestAtTheExactDiscreteTip) {
  const auto& expected = validation_case("E1d").at("expected").at("cantilever_tip_force_10");
  for (const auto& row : expected.at("discrete")) {
    const std::size_t N = row.at("N");
    if (N > 20) continue;
    const State s =
        testing::rest_under(testing::rod50(N), {load_on(N, {0, 10, 0})}, {root}, cantilever_frequency);
    const Vec3d tip = s.r[ParticleId{N}];
    EXPECT_NEAR(tip.x, row.at("tip")[0], tolerance) << "N = " << N;
    EXPECT_NEAR(tip.y, row.at("tip")[1], tolerance) << "N = " << N;
    EXPECT_NEAR(turn_about_z(s, N), row.at("theta"), tolerance) << "N = " << N;
    EXPECT_EQ(tip.z, 0.0);
  }
}

// R1: clamp at the origin, tangent +x, bend towards +y, load along z.
TEST(BatheBolourchiBend, ComesToRestAtTheExactDiscreteTip) {
  const double R = 100.0, E = 1e7, EI = E / 12, length = R * M_PI / 4;
  for (const int P : {300, 600})
    for (const auto& row : validation_case("R1")
                               .at("expected")
                               .at("discrete")
                               .at("bathe_bolourchi_BE_" + std::to_string(P))
                               .at("discrete")) {
      const std::size_t N = row.at("N");
      if (N > 8) continue;
      std::vector<Vec3d> r;
      for (std::size_t k = 0; k <= N; ++k) {
        const double phi = M_PI / 4 * static_cast<double>(k) / static_cast<double>(N);
        r.push_back({R * std::sin(phi), R * (1 - std::cos(phi)), 0});
      }
      testing::Specimen s = testing::particles_at(r);
      BondRecipe recipe;  // nu = 0 and polar moment 1/6: G J_p = E / 12
      recipe.parameters =
          TheoryParameters{BondTheory::bernoulli_euler, {E, 0.0}, {1.0, 1.0 / 12, 1.0 / 6}, 0};
      recipe.n_2 = Vec3d{0, 0, 1};
      for (std::size_t k = 0; k < N; ++k) testing::bond(s, k, k + 1, recipe);
      testing::set_masses(s, static_cast<double>(N), EI / E);
      const double slowest = cantilever_frequency * std::sqrt(EI / std::pow(length, 3));
      const State rest = testing::rest_under(s, {load_on(N, {0, 0, 1.0 * P})}, {root}, slowest);
      const Vec3d tip = rest.r[ParticleId{N}];
      EXPECT_LE(norm(tip - testing::vector(row.at("tip"))), 100 * tolerance)
          << "P = " << P << ", N = " << N << ": " << tip.x << " " << tip.y << " " << tip.z;
    }
}

/// Lee's frame: two legs of N bonds, pinned at (0, 0) and (1, 1), corner at (0, 1); load P downwards on the
/// beam at a fifth of its length from the corner. Returns how far the loaded particle has gone down.
double lees_frame(std::size_t N, double P) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= 2 * N; ++k) {
    const double along = static_cast<double>(k) / static_cast<double>(N);
    r.push_back(k <= N ? Vec3d{0, along, 0} : Vec3d{along - 1, 1, 0});
  }
  testing::Specimen s = testing::particles_at(r, 0.1 / static_cast<double>(N));
  BondRecipe recipe = testing::rod50_bond();
  recipe.n_2 = Vec3d{0, 0, 1};
  for (std::size_t k = 0; k < 2 * N; ++k) testing::bond(s, k, k + 1, recipe);
  testing::set_masses(s, static_cast<double>(N), 1.0 / 4e4);
  const double slowest = 9.9;  // pi^2: bending of the legs between pins and a corner that only turns
  Stage stage = testing::damped_stage(s, slowest / 4, 300 / slowest);
  const std::size_t loaded = N + N / 5;
  PointLoad load = load_on(loaded, {0, -P, 0});
  load.factor.points = {{0, 0}, {10 / slowest, 0.9}, {110 / slowest, 1}};
  stage.loads = {load};
  // Between two pins it would topple sideways, from no more than rounding: the frame is held in its plane.
  stage.supports = {testing::held({ParticleId{0}, ParticleId{2 * N}}, testing::translations),
                    testing::held(s.model.groups[0].particles, {false, false, true, true, true, false})};
  Simulation run(s.model, stage, s.state);
  run.run();
  return 1.0 - run.state().r[ParticleId{loaded}].y;
}

// E5: the limit point. Half a per cent below it the frame rests short of the limit's deflection, half a per
// cent above it snaps through. Near a limit point everything slows down, half a per cent from it by
// sqrt(0.005): under a quarter of critical damping the frame needs some pi / 2 / 0.07 = 22 times 1 / slowest
// to creep past it.
TEST(LeesFrame, SnapsThroughAtTheExactDiscreteLimitLoad) {
  for (const auto& row : validation_case("E5").at("expected").at("discrete").at("discrete")) {
    const std::size_t N = row.at("N_per_leg");
    if (N > 10) continue;
    const double P = row.at("Pmax"), limit = row.at("v");
    EXPECT_LT(lees_frame(N, 0.995 * P), limit) << "N = " << N;
    EXPECT_GT(lees_frame(N, 1.005 * P), limit + 0.1) << "N = " << N;
  }
}

}  // namespace
}  // namespace vbond::statics_test
