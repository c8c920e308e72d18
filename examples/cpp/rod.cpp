// A cantilever of eleven bonded particles bends under a force at its tip, until it rests. Units: a = m = c_A
// = 1.
#include <cstdio>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/make_bond.hpp"

int main() {
  using namespace vbond;
  const double d = 0.2, EJ = d * d / 16, L = 10, P = 1e-7;  // c_A = 1 means E A = 1
  std::vector<Vec3d> points;
  for (int k = 0; k <= 10; ++k) points.push_back({1.0 * k, 0, 0});
  const Model rod = equal_particles(points, 1.0, 0.064, 0.0);
  State state = at_rest(rod);

  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1 / circle(d).A, 0.2}, circle(d)};
  for (ParticleId i{0}, j{1}; j.value <= 10; ++i.value, ++j.value)
    state.bonds.push_back(*make_bond(recipe, bond_site(rod, state, i), bond_site(rod, state, j)));

  Stage bend;
  bend.dt = 0.3;
  bend.b_translation = 4e-3;  // near critical for the first mode
  bend.supports = {{"root", {ParticleId{0}}, {true, true, true, true, true, true}, {}, {}, {}}};
  bend.loads = {{"tip", {ParticleId{10}}, {0, P, 0}, {}, {}}};
  bend.stops.duration = 15000;
  Simulation run(rod, bend, state);
  run.run();  // or run.step(), one time step
  std::printf("tip deflection %.6f, P L^3 / (3 E J) = %.6f\n", run.state().r[ParticleId{10}].y,
              P * L * L * L / (3 * EJ));
}
