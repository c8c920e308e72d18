// Unbonded particles that a grip holds together.
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "campaigns/bodies.hpp"

namespace vbond::testing {

inline Support grip(std::vector<ParticleId> particles, const HeldDofs& held) {
  Support s;
  s.group = "grip";
  s.particles = std::move(particles);
  s.held = held;
  s.rigid = true;
  return s;
}

/// Unbonded particles of different masses, turned anyhow.
inline Specimen cloud(std::size_t n, unsigned seed = 7) {
  Dice dice(seed);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) r.push_back(dice.vector(2.0));
  Specimen s = testing::particles_at(r);
  for (const ParticleId p : s.state.q.ids()) {
    s.state.q[p] = rotation_of(dice.vector(3.0));
    s.model.mass[p] = dice(0.5, 2.0);
    s.model.inertia[p] = dice(0.05, 0.1);
  }
  return s;
}

inline double mass_of(const Specimen& s) {
  double mass = 0.0;
  for (const double m : s.model.mass) mass += m;
  return mass;
}

}  // namespace vbond::testing
