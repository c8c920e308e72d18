#pragma once
#include <algorithm>
#include <cmath>

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

inline HeldDofs some_dofs(Dice& dice, double part) {
  HeldDofs held{};
  for (bool& h : held) h = dice.chance(part);
  return held;
}

/// The largest way and turn between two states of a body; NaN if one of them is.
inline double distance_between(const State& a, const State& b) {
  double largest = 0.0;
  for (const ParticleId p : a.r.ids())
    for (const double d : {norm(a.r[p] - b.r[p]), norm(rotation_vector(a.q[p] * conjugate(b.q[p])))})
      if (!(d <= largest)) largest = std::isnan(largest) ? largest : d;
  return largest;
}

/// Bonds all pairs nearer than `reach`.
inline void bond_near(Specimen& s, double reach, const BondRecipe& recipe) {
  const std::size_t n = s.model.particles();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (norm(s.state.r[ParticleId{j}] - s.state.r[ParticleId{i}]) < reach) bond(s, i, j, recipe);
}

/// 6 to `most` particles of different mass in a box of 2.5 x 1.5 x 1.5, those within 1.5 bonded. `sorted`:
/// numbered along the box.
inline Specimen random_body(Dice& dice, std::size_t most = 10, bool sorted = false) {
  std::vector<Vec3d> r;
  const std::size_t n = dice.count(6, most);
  while (r.size() < n) {
    const Vec3d x = dice.vector(0.5), at{2.5 * (x.x + 0.5), 1.5 * x.y, 1.5 * x.z};
    if (std::all_of(r.begin(), r.end(), [&](const Vec3d& y) { return norm(y - at) >= 0.6; })) r.push_back(at);
  }
  if (sorted) std::sort(r.begin(), r.end(), [](const Vec3d& a, const Vec3d& b) { return a.x < b.x; });
  Specimen s = particles_at(r);
  for (const ParticleId p : s.model.mass.ids())
    s.model.mass[p] = dice(0.5, 2), s.model.inertia[p] = dice(0.05, 0.2);
  BondRecipe recipe;
  if (dice.chance(0.5)) recipe.law = &bond_law<Evm>;
  recipe.parameters = BondStiffness<double>{dice(0.3, 1), dice(0.05, 0.2), dice(0.02, 0.1), dice(0.02, 0.1)};
  bond_near(s, 1.5, recipe);
  return s;
}

}  // namespace vbond::testing
