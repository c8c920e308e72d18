#pragma once
#include <cstdlib>

#include "dynamics/rods.hpp"

namespace vbond::testing {

/// The same body in another place in space: everything about it must be the same, turned.
inline Specimen turned(Specimen s, const Quatd& turn) {
  for (Vec3d& r : s.model.r_0) r = rotate(turn, r);
  for (Vec3d& r : s.state.r) r = rotate(turn, r);
  for (Vec3d& v : s.state.v) v = rotate(turn, v);
  for (Vec3d& w : s.state.omega) w = rotate(turn, w);
  for (Quatd& q : s.state.q) q = turn * q;
  return s;
}

/// The axes of the world, turned: degrees of freedom of a support that has turned with its body.
inline HeldAxes turned_axes(const Quatd& turn) {
  HeldAxes axes;
  for (std::size_t k = 0; k < 3; ++k) axes.along[k] = axes.about[k] = rotate(turn, world_axes[k]);
  return axes;
}

inline Vec3d vector_in(Dice& dice, double size) {
  const double x = dice(-size, size), y = dice(-size, size), z = dice(-size, size);
  return {x, y, z};
}

inline HeldDofs some_dofs(Dice& dice, double part) {
  HeldDofs held{};
  for (bool& h : held) h = dice(0, 1) < part;
  return held;
}

/// 6 to 10 particles of different mass in a box of 2.5 x 1.5 x 1.5, those within 1.5 bonded.
inline Specimen random_body(Dice& dice) {
  std::vector<Vec3d> r;
  const auto n = static_cast<std::size_t>(dice(6, 11));
  while (r.size() < n) {
    const Vec3d x = vector_in(dice, 0.5);
    r.push_back({2.5 * (x.x + 0.5), 1.5 * x.y, 1.5 * x.z});
    for (std::size_t k = 0; k + 1 < r.size(); ++k)
      if (norm(r[k] - r.back()) < 0.6) {
        r.pop_back();
        break;
      }
  }
  Specimen s = particles_at(r);
  for (const ParticleId p : s.model.mass.ids())
    s.model.mass[p] = dice(0.5, 2), s.model.inertia[p] = dice(0.05, 0.2);
  BondRecipe recipe;
  if (dice(0, 1) < 0.5) recipe.law = &bond_law<Evm>;
  recipe.parameters = BondStiffness<double>{dice(0.3, 1), dice(0.05, 0.2), dice(0.02, 0.1), dice(0.02, 0.1)};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (norm(r[j] - r[i]) < 1.5) bond(s, i, j, recipe);
  return s;
}

/// How many bodies a campaign makes: VBOND_CAMPAIGN, or so many.
inline unsigned campaign_size(unsigned otherwise) {
  const char* const given = std::getenv("VBOND_CAMPAIGN");
  return given != nullptr ? static_cast<unsigned>(std::atoi(given)) : otherwise;
}

}  // namespace vbond::testing
