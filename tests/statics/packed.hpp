#pragma once
#include <algorithm>
#include <cmath>

#include "packings.hpp"
#include "periodic.hpp"

namespace vbond::testing {

/// The stiffnesses of bonds: the same for all, or of a rod between the surfaces.
inline BondRecipe recipe_of(const Packing& p, const PackingBond& b, bool same) {
  BondRecipe recipe;
  if (same) {
    recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
    return recipe;
  }
  const double R = 0.5 * std::min(p.radius[b.i], p.radius[b.j]), A = M_PI * R * R,
               J = M_PI / 4 * R * R * R * R;
  const double nu = 0.2, G = 0.5 / (1 + nu), k = 6 * sq(1 + nu) / (7 + 12 * nu + 4 * nu * nu);
  recipe.attachment = Attachment::given;
  recipe.R_i = 0.7 * p.radius[b.i], recipe.R_j = 0.7 * p.radius[b.j];
  const Vec3d far = double(b.a) * p.edges[0] + double(b.b) * p.edges[1] + double(b.c) * p.edges[2];
  const double a = norm(p.r[b.j] + far - p.r[b.i]) - recipe.R_i - recipe.R_j;
  const double phi = 12 * J / (k * G * A * a * a);  // Timoshenko's
  recipe.parameters = BondStiffness<double>{A / a, 12 * J / (a * a * a * (1 + phi)), J / a, 2 * G * J / a};
  return recipe;
}

inline Specimen packed(const Packing& p, bool same, bool evm, bool triangular) {
  Specimen s = periodic_body(p.edges, p.r);
  s.model.cell.triangular = triangular;
  for (std::size_t k = 0; k < p.radius.size(); ++k) s.model.radius[ParticleId{k}] = p.radius[k];
  for (const PackingBond& b : p.bonds) {
    BondRecipe recipe = recipe_of(p, b, same);
    if (evm) recipe.law = &bond_law<Evm>;
    bond_image(s, b.i, b.j, {b.a, b.b, b.c}, recipe);
  }
  return s;
}

}  // namespace vbond::testing
