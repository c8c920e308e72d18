#pragma once
#include "rests.hpp"

namespace vbond::testing {

/// Polygon of N particles on the unit circle, EI = 1, bonds along its sides; particle 0 at (1, 0, 0).
inline Specimen ring(std::size_t N, double EA) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < N; ++k) {
    const double phi = 2 * M_PI * static_cast<double>(k) / static_cast<double>(N);
    r.push_back({std::cos(phi), std::sin(phi), 0});
  }
  Specimen s = particles_at(r, 0.1 / static_cast<double>(N));
  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {EA, 0.2}, {1.0, 1 / EA, 2 / EA}, 0};
  recipe.n_2 = Vec3d{0, 0, 1};
  for (std::size_t k = 0; k < N; ++k) bond(s, k, (k + 1) % N, recipe);
  set_masses(s, static_cast<double>(N), 1 / EA);
  return s;
}

}  // namespace vbond::testing
