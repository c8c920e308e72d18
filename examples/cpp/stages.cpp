// A cantilever falls under a force at its tip until damping has brought it to rest, is put into exact balance
// and rung: three stages of one run. Units: a = m = c_A = 1.
#include <cstdio>

#include "vbond/model/make_bond.hpp"
#include "vbond/run/run.hpp"

int main() {
  using namespace vbond;
  const double d = 0.2, P = 1e-7;  // c_A = 1 means E A = 1
  std::vector<Vec3d> points;
  for (int k = 0; k <= 10; ++k) points.push_back({1.0 * k, 0, 0});
  const Model rod = equal_particles(points, 1.0, 0.064, 0.0);
  State state = at_rest(rod);
  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1 / circle(d).A, 0.2}, circle(d)};
  for (ParticleId i{0}, j{1}; j.value <= 10; ++i.value, ++j.value)
    state.bonds.push_back(*make_bond(recipe, bond_site(rod, state, i), bond_site(rod, state, j)));

  const ParticleId root{0}, tip{10};
  const HeldDofs all{true, true, true, true, true, true};
  Stage fall;
  fall.name = "fall", fall.dt = 0.3, fall.b_translation = 4e-3;  // near critical for the first mode
  fall.supports = {{"root", {root}, all, {}, {}, {}}};
  fall.loads = {{"tip", {tip}, {0, P, 0}, {}, {}}};
  fall.stops.duration = 3000;
  StaticStage rest;  // of kind equilibrium
  rest.name = "rest";
  rest.supports = {{"root", {root}, all, {}, {}}};
  rest.loads = {{"tip", {tip}, {0, P, 0}}};
  StaticStage ring = rest;
  ring.name = "ring", ring.kind = StageKind::modes, ring.count = 2;

  Run run(rod, state, {fall, rest, ring});  // checks all stages before the first begins
  run.step(5000);                           // or run_stage(), to the end of a stage; or run(), to the last
  std::printf("under way, at step %lld\n", static_cast<long long>(run.clock().step));
  const auto& results = run.run();
  const double w = run.state().r[tip].y, slow = results[2].statics->modes[0].omega;
  std::printf("tip deflection %.9f after %lld steps, slowest frequency %.9g\n", w,
              static_cast<long long>(results[0].steps), slow);
}
