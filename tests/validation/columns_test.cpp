// Critical loads from the growth and decay of small deflections: the paper's rod and a rod bonded at the
// surfaces of its particles, as dynamics sees them. All rods and columns (K1, K2, K3, E7):
// tests/statics/buckling_test.cpp.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "cases.hpp"
#include "rests.hpp"

namespace vbond {
namespace {

using testing::load_on;
using testing::number;

/// A column under a load, slightly bent: the body and the stage it is run in.
struct Column {
  testing::Specimen specimen;
  Stage stage;
};

double deflection(const State& s) {
  double sum = 0.0;
  for (const Vec3d& r : s.r) sum += r.y * r.y + r.z * r.z;
  return std::sqrt(sum);
}

/// omega^2 / slowest^2 of the mode that is about to buckle. Damping is critical for `slowest`, the lowest
/// frequency without load, so mu^2 + 2 slowest mu + omega^2 = 0 for the rate mu of that mode. All others have
/// died away as exp(-25) or less when the rate is measured.
double stiffness_left(const Column& c, double slowest) {
  Simulation run(c.specimen.model, c.stage, c.specimen.state);
  const std::int64_t early = steps_in(25.0 / slowest, c.stage.dt),
                     late = steps_in(35.0 / slowest, c.stage.dt);
  while (run.state().clock.step < early) run.step();
  const double y_early = deflection(run.state());
  while (run.state().clock.step < late) run.step();
  const double time = static_cast<double>(late - early) * c.stage.dt;
  const double mu = std::log(deflection(run.state()) / y_early) / time / slowest;
  return -mu * (mu + 2.0);
}

/// The load, relative to `expected`, at which a column buckles: linear between 0.1 % below and above, where
/// omega^2 is a smooth function of the load; its curvature moves the result by some 1e-6. Checks that
/// deflections decay below and grow above.
double critical_ratio(const std::function<Column(double load)>& column, double expected, double slowest) {
  const double h = 1e-3;
  const double below = stiffness_left(column((1 - h) * expected), slowest),
               above = stiffness_left(column((1 + h) * expected), slowest);
  EXPECT_GT(below, 0.0) << "stable below";
  EXPECT_LT(above, 0.0) << "unstable above";
  return 1 - h + 2 * h * below / (below - above);
}

constexpr double tolerance = 5e-6;

/// A rod of statics.json: N particles, pinned at both ends, the far end free to move along x under -f.
/// Already shortened by f / c_A per bond, so that nothing swings along it.
Column pinned_rod(const nlohmann::json& rod, double f, double slowest) {
  const std::size_t N = rod.at("N");
  const double R = rod.at("R"), spacing = rod.at("a").get<double>() + 2 * R;
  const auto& B = rod.at("B");
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < N; ++k) r.push_back({spacing * static_cast<double>(k), 0, 0});
  Column c{testing::particles_at(r, R, 0.5), {}};
  BondRecipe recipe;
  recipe.parameters = GivenCoefficients{{number(B[0]), number(B[1]), number(B[2]), number(B[3])}};
  recipe.attachment = Attachment::given;
  recipe.R_i = recipe.R_j = R;
  for (std::size_t k = 0; k + 1 < N; ++k) testing::bond(c.specimen, k, k + 1, recipe);
  c.stage = testing::damped_stage(c.specimen, slowest, 1e99);
  const double length = spacing * static_cast<double>(N - 1);
  for (const ParticleId p : c.specimen.state.r.ids()) {
    Vec3d& at = c.specimen.state.r[p];
    at.y = 1e-8 * std::sin(M_PI * at.x / length);
    at.x -= f / number(B[0]) * p.value;
  }
  c.stage.supports = {testing::held({ParticleId{0}}, testing::translations),
                      testing::held({ParticleId{N - 1}}, {false, true, true, false, false, false})};
  c.stage.loads = {load_on(N - 1, {-f, 0, 0})};
  return c;
}

TEST(PinnedRods, BuckleInMotionAtTheirExactStaticForce) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/statics.json");
  const auto rods = nlohmann::json::parse(file).at("rods");
  for (const std::size_t which : {1u, 13u}) {
    const auto& rod = rods.at(which);
    const double f = number(rod.at("f_crit_exact")), N = rod.at("N");
    const double length = (N - 1) * (rod.at("a").get<double>() + 2 * rod.at("R").get<double>());
    // omega^2 = f k^2 / (mass per length), k = pi / length, less what the spin of the particles takes
    const double k = M_PI / length;
    const double slowest = k * std::sqrt(f * length / (N - 1) / (1 + 0.5 * k * k));
    EXPECT_NEAR(critical_ratio([&](double load) { return pinned_rod(rod, load, slowest); }, f, slowest), 1.0,
                tolerance)
        << rod.at("label");
  }
}

}  // namespace
}  // namespace vbond
