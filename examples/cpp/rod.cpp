// A cantilever of eleven bonded particles bends under a force at its tip, until it rests.
// Units: a = m = c_A = 1. Build: see docs/install.md, "The library".
#include <cstdio>
#include <numbers>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/make_bond.hpp"

int main() {
  using namespace vbond;
  const std::size_t N = 11;
  const double d = 0.2, EJ = d * d / 16, L = N - 1, P = 1e-7;  // c_A = 1 means E A = 1

  Model rod;
  rod.T_0 = 2 * std::numbers::pi;
  rod.mass.assign(N, 1.0);
  rod.inertia.assign(N, 0.064);
  rod.radius.assign(N, 0.0);
  State state;
  for (std::size_t k = 0; k < N; ++k) state.r.push_back({static_cast<double>(k), 0, 0});
  rod.r_0 = state.r;
  state.v.assign(N, {});
  state.q.assign(N, {});
  state.omega.assign(N, {});

  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1 / circle(d).A, 0.2}, circle(d)};
  for (ParticleId i{0}, j{1}; j.value < N; ++i.value, ++j.value)
    state.bonds.push_back(*make_bond(recipe, {i, state.r[i], {}, 0.0}, {j, state.r[j], {}, 0.0}));

  Stage bend;
  bend.dt = 0.05 * rod.T_0;
  bend.b_translation = 4e-3;  // near critical for the first mode
  bend.supports = {{"root", {ParticleId{0}}, {true, true, true, true, true, true}, {}, {}, {}}};
  bend.loads = {{"tip", {ParticleId{N - 1}}, {0, P, 0}, {}, {}}};
  bend.stops.duration = 2000 * rod.T_0;

  Simulation run(rod, bend, state);
  run.run();  // or run.step(), one time step
  std::printf("tip deflection %.6f, P L^3 / (3 E J) = %.6f\n", run.state().r[ParticleId{N - 1}].y,
              P * L * L * L / (3 * EJ));
}
