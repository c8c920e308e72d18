// rod FOLDER: a rod as a C++ program makes it from the library, without a case; its history.csv goes to the
// folder. test_cases.py compares it with the same rod as a dict and as a file.
#include <memory>
#include <vector>

#include "vbond/model/make_bond.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/run/run.hpp"

int main(int, char** argv) {
  using namespace vbond;
  std::vector<Vec3d> points;
  for (int k = 0; k < 10; ++k) points.push_back({1.0 * k, 0, 0});
  const Model rod = equal_particles(points, 1.0, 0.064, 0.4);
  State state = at_rest(rod);
  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {31.830988618379067, 0.2}, circle(0.2)};
  for (ParticleId i{0}, j{1}; j.value < points.size(); ++i.value, ++j.value)
    state.bonds.push_back(*make_bond(recipe, bond_site(rod, state, i), bond_site(rod, state, j)));
  state.v[ParticleId{0}] = {0.01, 0.002, 0};
  state.omega[ParticleId{0}] = {0.02, 0, 0.03};

  Stage fly;
  fly.name = "fly", fly.dt = 0.125;
  fly.stops.duration = 250;
  OutputPlan plan;
  plan.folder = argv[1];
  plan.history_every = 1.25;
  Run run(rod, state, {fly});
  run.add_observer(std::make_shared<HistoryObserver>(plan, std::nullopt));
  run.run();
}
