#pragma once
#include <vector>

#include "dynamics/rods.hpp"

namespace vbond::testing {

/// One particle of these principal moments that turns with omega (world).
inline Specimen free_top(const PrincipalInertia& inertia, const Quatd& q, const Vec3d& omega) {
  Specimen s = particles_at({{0, 0, 0}});
  make_top(s.model, ParticleId{0}, inertia);
  s.state.q[ParticleId{0}] = q;
  s.state.omega[ParticleId{0}] = omega;
  return s;
}

inline Quatd principal_axes(const Model& m, const State& s, ParticleId p) {
  return m.principal.empty() ? s.q[p] : s.q[p] * m.principal[p].axes;
}
/// The state of a free body at time t.
inline State after(const Specimen& s, double dt, double t) {
  Simulation run(s.model, plain_stage(dt, t), s.state);
  run.run();
  return run.state();
}

/// Angular velocity about the principal axes.
inline Vec3d body_rates(const Model& m, const State& s, ParticleId p = ParticleId{0}) {
  return rotate(conjugate(principal_axes(m, s, p)), s.omega[p]);
}
inline Vec3d spin(const Model& m, const State& s, ParticleId p = ParticleId{0}) {
  if (m.principal.empty()) return m.inertia[p] * s.omega[p];
  return angular_momentum(m.principal[p].moments, principal_axes(m, s, p), s.omega[p]);
}
inline Vec3d angular_momentum_of_all(const Model& m, const State& s) {
  Vec3d L;
  for (const ParticleId p : s.r.ids()) L += m.mass[p] * cross(s.r[p], s.v[p]) + spin(m, s, p);
  return L;
}
/// |q - p|, the same rotation being near with either sign.
inline double apart(const Quatd& p, const Quatd& q) {
  const auto square = [&](double sign) {
    return sq(p.w - sign * q.w) + sq(p.x - sign * q.x) + sq(p.y - sign * q.y) + sq(p.z - sign * q.z);
  };
  return std::sqrt(std::min(square(1.0), square(-1.0)));
}

/// Moments of a random mass, from 1 to 4: those of three extents, which keep the triangle inequality.
inline Vec3d drawn_moments(Dice& dice) {
  const double x = dice(0.1, 2), y = dice(0.1, 2), z = dice(0.1, 2);
  return {y + z, z + x, x + y};
}

/// A rod whose particles have random moments and axes, are bonded beside their centres, and move.
inline Specimen rod_of_tops(std::size_t N, const BondLaw* law, unsigned seed, double speed = 0.01) {
  BondRecipe recipe = papers_bond(law);
  recipe.attachment = Attachment::given;
  recipe.R_i = 0.2;
  recipe.R_j = 0.3;
  Specimen s = straight_rod(N, recipe);
  Dice dice(seed);
  for (const ParticleId p : s.state.r.ids()) {
    if (p.value % 3 != 1) make_top(s.model, p, {0.064 * drawn_moments(dice), rotation_of(dice.vector(2.0))});
    s.state.v[p] = dice.vector(speed);
    s.state.omega[p] = dice.vector(5 * speed);
  }
  return s;
}

}  // namespace vbond::testing
