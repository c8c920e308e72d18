// Trajectories and frequencies against references made outside this code: data/trajectories.json (a pair
// integrated to 1e-12), data/statics.json (frequencies), and recorded numbers of another program.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "rods.hpp"

namespace vbond::trajectories_test {
namespace {

nlohmann::json read(const std::string& name) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/" + name);
  return nlohmann::json::parse(file);
}
Vec3d vector(const nlohmann::json& j) {
  return {j[0], j[1], j[2]};
}

/// Distance between the run at `time` and the reference, over positions, velocities, turns and spins.
double trajectory_error(const nlohmann::json& t, std::size_t which, double dt) {
  const double time = t["times"][which];
  std::vector<Vec3d> r;
  for (const auto& p : t["r0"]) r.push_back(vector(p));
  testing::Specimen s = testing::particles_at(r, 0.4, t["Theta"]);
  BondRecipe recipe;
  recipe.parameters = GivenCoefficients{{t["B"][0], t["B"][1], t["B"][2], t["B"][3]}};
  for (std::size_t k = 0; k + 1 < r.size(); ++k) testing::bond(s, k, k + 1, recipe);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = vector(t["v0"][p.value]);
    s.state.omega[p] = vector(t["w0"][p.value]);
  }
  Simulation run(s.model, testing::plain_stage(dt, time), s.state);
  run.run();
  const auto& expected = t["states"][which];
  double error = 0.0;
  for (const ParticleId p : s.state.r.ids()) {
    const auto& q = expected["q"][p.value];
    const Quatd turn = run.state().q[p] * conjugate(Quatd{q[0], q[1], q[2], q[3]});
    error += norm(run.state().r[p] - vector(expected["r"][p.value])) + norm(rotation_vector(turn)) +
             norm(run.state().v[p] - vector(expected["v"][p.value])) +
             norm(run.state().omega[p] - vector(expected["w"][p.value]));
  }
  return error;
}

TEST(Trajectories, ConvergeToTheReferenceAtSecondOrder) {
  for (const auto& t : read("trajectories.json"))
    for (std::size_t which = 0; which < t["times"].size(); ++which) {
      const double coarse = trajectory_error(t, which, 0.025), fine = trajectory_error(t, which, 0.0125),
                   finest = trajectory_error(t, which, 0.00625);
      // order 2 within what the next term, of relative size (omega dt)^2 < 1e-3 a halving, can change
      EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.02);
      EXPECT_NEAR(std::log2(fine / finest), 2.0, 0.01);
      // The Richardson value of the error constant: what remains is far below the coarse error.
      EXPECT_LT(finest, 2e-4);
    }
}

/// Angular frequency of a quantity that swings about zero, from its upward zero crossings.
template <class Quantity>
double frequency(Simulation& run, Quantity quantity, int periods) {
  double first = 0.0, last = 0.0, before = quantity(run.state());
  int crossings = 0;
  while (crossings <= periods) {
    run.step();
    const double now = quantity(run.state());
    if (before < 0.0 && now >= 0.0) {
      last = run.state().clock.time() - run.stage().dt * now / (now - before);
      if (crossings++ == 0) first = last;
    }
    before = now;
  }
  return 2 * M_PI * periods / (last - first);
}

// 1e-4 is asked for. Leap-frog is off by (omega dt)^2 / 24 < 1e-5 at dt = 0.01; the amplitude by its square.
TEST(TwoBodies, SwingWithTheFrequenciesOfTheFourStiffnesses) {
  const auto expected = read("statics.json")["two_body_frequencies"]["paper_params"];
  const double tiny = 1e-4;
  const ParticleId i{0}, j{1};
  const auto run_with = [&](auto set_velocities) {
    testing::Specimen s = testing::straight_rod(2);
    set_velocities(s.state);
    return s;
  };
  {
    const auto s = run_with([&](State& x) { x.v[i] = {tiny, 0, 0}, x.v[j] = {-tiny, 0, 0}; });
    Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
    EXPECT_NEAR(frequency(
                    run, [&](const State& x) { return x.r[j].x - x.r[i].x - 1.0; }, 20) /
                    expected["axial"].get<double>(),
                1.0, 1e-4);
  }
  {
    const auto s = run_with([&](State& x) { x.omega[i] = {tiny, 0, 0}, x.omega[j] = {-tiny, 0, 0}; });
    Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
    EXPECT_NEAR(frequency(
                    run, [&](const State& x) { return x.q[j].x - x.q[i].x; }, 20) /
                    expected["torsion"].get<double>(),
                1.0, 1e-4);
  }
  {
    const auto s = run_with([&](State& x) { x.omega[i] = {0, 0, tiny}, x.omega[j] = {0, 0, -tiny}; });
    Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
    EXPECT_NEAR(frequency(
                    run, [&](const State& x) { return x.q[j].z - x.q[i].z; }, 20) /
                    expected["bending"].get<double>(),
                1.0, 1e-4);
  }
  {  // the rocking mode without net spin: both ends turn one way, the centres the other
    const auto s = run_with([&](State& x) {
      x.omega[i] = x.omega[j] = {0, 0, tiny};
      x.v[i] = {0, 0.064 * tiny * 2.0, 0}, x.v[j] = {0, -0.064 * tiny * 2.0, 0};
    });
    Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
    EXPECT_NEAR(frequency(
                    run, [&](const State& x) { return x.r[j].y - x.r[i].y; }, 20) /
                    expected["shear"].get<double>(),
                1.0, 1e-4);
  }
}

// Recorded by waLBerla (VBondContactIntegration.test.cpp, commit 17a9f647): a nanotube of 10 particles along
// z with the first held, tip force and torque, 500 steps of velocity Verlet with the EVM. 1e-6 is what the
// two codes' different treatment of rotation leaves.
TEST(EvmNanotube, AgreesWithTheEnergiesThatWaLBerlaRecords) {
  const double a = 13.56, E = 6.423018, G = 2.865078;
  std::vector<Vec3d> r;
  for (int k = 0; k < 10; ++k) r.push_back({0, 0, a * k});
  testing::Specimen s = testing::particles_at(r, 6.78, 12710889.73352396);
  s.model.mass.assign(10, 276527.22462059004);
  BondRecipe recipe;
  recipe.law = &bond_law<Evm>;
  recipe.parameters =
      TheoryParameters{BondTheory::bernoulli_euler, {E, E / (2 * G) - 1.0}, {142.7, 3480.0, 6960.0}, 0};
  for (std::size_t k = 0; k < 9; ++k) testing::bond(s, k, k + 1, recipe);
  EXPECT_NEAR(s.state.bonds[BondId{0}].coefficients[1], 19780.621805309736, 1e-8);
  Stage stage = testing::plain_stage(20.0, 500 * 20.0);
  stage.supports = {testing::held({ParticleId{0}}, testing::clamped)};
  PointLoad tip;
  tip.particles = {ParticleId{9}};
  tip.force = {1, 0, 0};
  tip.moment = {0, 0, 1};
  tip.factor.points = {{0, 0}, {1e-6, 1}};  // that program's first half kick is without any force
  stage.loads = {tip};
  Simulation run(s.model, stage, s.state);
  run.run();
  const Energies e = run.energies();
  EXPECT_NEAR(e.U_L / 0.018811163896477433, 1.0, 1e-6);
  EXPECT_NEAR(e.potential() / 33.111007034045706, 1.0, 1e-6);
}

}  // namespace
}  // namespace vbond::trajectories_test
