// Validation cases K1, K2, K3, the heavy column of E7, and the rods of data/statics.json: critical loads from
// the growth and decay of small deflections.
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
using testing::validation_case;

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
  recipe.parameters = GivenCoefficients{number(B[0]), number(B[1]), number(B[2]), number(B[3])};
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

// All 14 rods, among them Timoshenko bonds, short cylinders and bonds fastened at the surfaces.
TEST(PinnedRods, BuckleAtTheirExactStaticForce) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/statics.json");
  const auto rods = nlohmann::json::parse(file).at("rods");
  ASSERT_EQ(rods.size(), 14u);
  for (const auto& rod : rods) {
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

// K1: the paper's rod with more bonds.
TEST(PinnedRods, OfFortyParticlesBucklesAtItsExactStaticForce) {
  const double f =
      number(validation_case("K1").at("expected").at("cases").at("N=40 particles").at("Pcr_exact_discrete"));
  const nlohmann::json rod{{"N", 40}, {"a", 1.0}, {"R", 0.0}, {"B", {1.0, -0.005, 0.015, 1.0 / 480.0}}};
  const double k = M_PI / 39, slowest = k * std::sqrt(f / (1 + 0.5 * k * k));
  EXPECT_NEAR(critical_ratio([&](double load) { return pinned_rod(rod, load, slowest); }, f, slowest), 1.0,
              tolerance);
}

constexpr HeldDofs guided{false, true, true, true, true, true};

/// The standard rod with a clamped root, this support of the other end and this axial load on it.
Column standard_column(std::size_t N, HeldDofs end, double P, double slowest) {
  Column c{testing::rod50(N), {}};
  c.stage = testing::damped_stage(c.specimen, slowest, 1e99);
  for (const ParticleId p : c.specimen.state.r.ids()) {
    Vec3d& at = c.specimen.state.r[p];
    at.y = 1e-8 * at.x * at.x * (end[1] ? (1 - at.x) * (1 - at.x) : 1.0);
    at.x *= 1 - P / 4e4;
  }
  c.stage.supports = {testing::held({ParticleId{0}}, testing::clamped), testing::held({ParticleId{N}}, end)};
  c.stage.loads = {load_on(N, {-P, 0, 0})};
  return c;
}

// K2. Lowest frequencies of the unloaded beams: 22.37, 2.8 (see statics_test.cpp) and 15.42.
TEST(Columns, BuckleAtTheirExactDiscreteForce) {
  const struct {
    const char* name;
    HeldDofs end;
    double slowest;
  } ends[] = {{"clamped-clamped", guided, 22.0},
              {"cantilever", {}, 2.8},
              {"fixed-pinned", {false, true, true, false, false, false}, 15.0}};
  for (const auto& end : ends)
    for (const std::size_t N : {10u, 20u}) {
      const double P = validation_case("K2")
                           .at("expected")
                           .at(std::string("buckling_") + end.name + " (EI=L=1,EA=4e4)")
                           .at("discrete")
                           .at(std::to_string(N));
      EXPECT_NEAR(critical_ratio([&](double p) { return standard_column(N, end.end, p, end.slowest); }, P,
                                 end.slowest),
                  1.0, tolerance)
          << end.name << ", N = " << N;
    }
}

// E7: a vertical cantilever under its own weight, half weight on the last particle.
TEST(Columns, BuckleUnderTheirOwnWeightAtTheExactDiscreteValue) {
  for (const std::size_t N : {10u, 20u}) {
    const double q = validation_case("E7").at("expected").at("col").at("discrete").at(std::to_string(N));
    const auto column = [&](double weight) {
      Column c = standard_column(N, {}, 0.0, 2.8);
      c.specimen.model.mass[ParticleId{N}] /= 2;
      c.stage.gravity = {-weight, 0, 0};
      return c;
    };
    EXPECT_NEAR(critical_ratio(column, q, 2.8), 1.0, tolerance) << "N = " << N;
  }
}

// K3: both ends clamped, one free to slide along x, turned about it by the twist that makes the rod leave its
// line. At 20 bonds the torque's peak comes first, so that case is no test of this mode.
TEST(Columns, LeaveTheirLineUnderTheExactDiscreteTwist) {
  const std::size_t N = 40;
  const double expected = validation_case("K3").at("expected").at("discrete").at("40").at("twist");
  const auto column = [&](double twist) {
    Column c = standard_column(N, guided, 0.0, 22.0);
    for (const ParticleId p : c.specimen.state.r.ids())
      c.specimen.state.q[p] = rotation_of({twist * p.value / N, 0, 0});
    return c;
  };
  EXPECT_NEAR(critical_ratio(column, expected, 22.0), 1.0, tolerance);
}

}  // namespace
}  // namespace vbond
