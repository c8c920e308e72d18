#pragma once
#include <vector>

#include "statics/bodies.hpp"

namespace vbond::testing {

/// A lattice of nx * ny * nz particles one apart.
inline Specimen lattice_of(std::size_t nx, std::size_t ny, std::size_t nz,
                           const BondLaw* law = &bond_law<VModel>) {
  std::vector<Vec3d> r;
  for (std::size_t z = 0; z < nz; ++z)
    for (std::size_t y = 0; y < ny; ++y)
      for (std::size_t x = 0; x < nx; ++x)
        r.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
  Specimen s = particles_at(r);
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.1, 0.05};
  for (std::size_t k = 0; k < r.size(); ++k) {
    if (k % nx + 1 < nx) bond(s, k, k + 1, recipe);
    if (k / nx % ny + 1 < ny) bond(s, k, k + nx, recipe);
    if (k + nx * ny < r.size()) bond(s, k, k + nx * ny, recipe);
  }
  return s;
}

inline std::vector<ParticleId> ids(std::size_t first, std::size_t count) {
  std::vector<ParticleId> list;
  for (std::size_t k = first; k < first + count; ++k) list.push_back(ParticleId{k});
  return list;
}

}  // namespace vbond::testing
