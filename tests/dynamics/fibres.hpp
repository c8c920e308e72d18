#pragma once
// Fibres whose bonds touch as capsules, for tests.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "rods.hpp"
#include "vbond/model/capsules.hpp"

namespace vbond::testing {

inline constexpr double pi = std::numbers::pi;

inline ContactModel hertz(double E = 100.0) {
  return {.law = ContactLaw::hertz, .pairs = ContactPairs::unbonded, .E = E, .nu = 0.0};
}
inline ContactModel rough(double friction = 0.4, double restitution = 1.0) {
  ContactModel c = hertz();
  c.surface = {.friction = friction, .restitution = restitution};
  c.tangential = TangentialForm::mindlin;
  return c;
}
/// 4/3 E* of hertz() for equal bodies.
inline constexpr double K = 4.0 / 3.0 * 50.0;

inline BondRecipe capsules(double radius) {
  BondRecipe recipe = papers_bond();
  recipe.capsule = true, recipe.capsule_radius = radius;
  return recipe;
}

/// Chains of particles, each through these points, bonded as they stand; radius 0.2 unless said.
inline Specimen fibres(const std::vector<std::vector<Vec3d>>& chains, const ContactModel& contact,
                       double R = 0.2, double mass = 1.0) {
  std::vector<Vec3d> r;
  for (const auto& chain : chains) r.insert(r.end(), chain.begin(), chain.end());
  Specimen s{equal_particles(r, mass, 0.4 * mass * sq(R), R), {}};
  s.model.contact = contact;
  s.state = at_rest(s.model);
  std::size_t first = 0;
  for (const auto& chain : chains) {
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) bond(s, first + k, first + k + 1, capsules(R));
    first += chain.size();
  }
  return s;
}
inline std::vector<Vec3d> line(const Vec3d& middle, const Vec3d& along, std::size_t particles) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < particles; ++k)
    r.push_back(middle + (static_cast<double>(k) - 0.5 * static_cast<double>(particles - 1)) * along);
  return r;
}
inline Loads loads_of(const Specimen& s) {
  return Simulation(s.model, plain_stage(1e-3, 1.0), s.state).loads();
}
inline double energy_of(const Specimen& s) {
  return fibre_energy(s.model, s.state);
}
inline Vec3d total_moment(const Specimen& s, const State& state, const Loads& loads) {
  Vec3d sum;
  for (const ParticleId p : s.model.mass.ids()) sum += cross(state.r[p], loads.F[p]) + loads.M[p];
  return sum;
}
inline Vec3d total(const PerParticle<Vec3d>& F) {
  Vec3d sum;
  for (const Vec3d& x : F) sum += x;
  return sum;
}

/// Two bars of two particles each, crossed at their middles.
inline Specimen crossed_bars(const ContactModel& contact, double speed) {
  Specimen s = fibres({line({0, 0, -0.201}, {0.8, 0, 0}, 2), line({0, 0, 0.201}, {0, 0.8, 0}, 2)}, contact);
  s.state.v = {{0, 0, speed}, {0, 0, speed}, {0, 0, -speed}, {0, 0, -speed}};
  return s;
}

/// The least distance of the axes of two fibres, bond by bond.
inline double least_distance(const State& s, std::size_t particles_of_first) {
  double least = INFINITY;
  for (const Bond& a : s.bonds)
    for (const Bond& b : s.bonds)
      if (a.i.value < particles_of_first && b.i.value >= particles_of_first)
        least =
            std::min(least, std::sqrt(nearest_on_segments(s.r[a.i], s.r[a.j], s.r[b.i], s.r[b.j]).distance2));
  return least;
}

}  // namespace vbond::testing
