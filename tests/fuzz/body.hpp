#pragma once
#include "vbond/model/make_bond.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond::fuzz {

/// Three particles in a row, bonded: the body whose files are forged.
struct SmallBody {
  Model model;
  State state;

  SmallBody() {
    model.T_0 = 6.25;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto x = static_cast<double>(k);
      model.mass.push_back(1.0 + x);
      model.inertia.push_back(0.1);
      model.radius.push_back(0.3 + 0.01 * x);
      model.r_0.push_back({x, 0, 0});
      state.r.push_back({1.01 * x, 0.1, 0});
      state.v.push_back({0.1 * x, 0, 0});
      state.q.push_back({});
      state.omega.push_back({});
    }
    BondRecipe recipe;
    recipe.parameters = GivenCoefficients{{1.0, -0.005, 0.015, 0.002}};
    for (std::size_t k = 0; k < 2; ++k) {
      const ParticleId i{k}, j{k + 1};
      state.bonds.push_back(*make_bond(recipe, {i, state.r[i], state.q[i], model.radius[i]},
                                       {j, state.r[j], state.q[j], model.radius[j]}));
    }
    state.clock.dt = 0.1;
  }
};

}  // namespace vbond::fuzz
