// The critical force of a pinned rod of ten bonded particles, from its tangent stiffness. Units: a = m = c_A
// = 1.
#include <cstdio>

#include "vbond/model/make_bond.hpp"
#include "vbond/statics/statics.hpp"

int main() {
  using namespace vbond;
  const double d = 0.2;  // c_A = 1 means E A = 1
  std::vector<Vec3d> points;
  for (int k = 0; k < 10; ++k) points.push_back({1.0 * k, 0, 0});
  const Model rod = equal_particles(points, 1.0, 0.064, 0.0);
  State state = at_rest(rod);

  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1 / circle(d).A, 0.2}, circle(d)};
  for (ParticleId i{0}, j{1}; j.value < 10; ++i.value, ++j.value)
    state.bonds.push_back(*make_bond(recipe, bond_site(rod, state, i), bond_site(rod, state, j)));

  StaticStage press;
  press.name = "press";
  press.kind = StageKind::buckling;
  press.count = 1;
  for (const ParticleId p : rod.mass.ids()) {
    const bool first = p.value == 0, last = p.value == 9;  // the x-y plane, and the pins
    press.supports.push_back({"pins", {p}, {first, first || last, true, true, true, false}, {}, {}});
  }
  press.loads = {{"end", {ParticleId{9}}, {-1, 0, 0}}};
  const StaticOutcome outcome = run_static_stage(rod, press, state, {});
  std::printf("critical force %.9g\n", outcome.result.critical_loads.at(0).force);
}
