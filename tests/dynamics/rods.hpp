#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "campaigns/dice.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/make_bond.hpp"

namespace vbond::testing {

/// A body and its state, in reduced units (a = m = c_A = 1) unless a test says otherwise.
struct Specimen {
  Model model;
  State state;
};

/// The paper's bond: d_b / a = 0.2, nu = 0.2, Bernoulli-Euler, between the centres.  [KA12] eq. (42)
inline BondRecipe papers_bond(const BondLaw* law = &bond_law<VModel>) {
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {4.0 / M_PI * 25.0, 0.2}, circle(0.2), 0};
  return recipe;
}

inline Specimen particles_at(const std::vector<Vec3d>& positions, double radius = 0.4,
                             double inertia = 0.064) {
  Specimen s{equal_particles(positions, 1.0, inertia, radius), {}};
  s.state = at_rest(s.model);
  return s;
}

inline void bond(Specimen& s, std::size_t i, std::size_t j, const BondRecipe& recipe) {
  const ParticleId p{i}, q{j};
  s.state.bonds.push_back(
      make_bond(recipe, bond_site(s.model, s.state, p), bond_site(s.model, s.state, q)).value());
}

/// N particles on the x axis, one apart, each bonded to the next.
inline Specimen straight_rod(std::size_t N, const BondRecipe& recipe = papers_bond()) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < N; ++k) r.push_back({static_cast<double>(k), 0, 0});
  Specimen s = particles_at(r);
  for (std::size_t k = 0; k + 1 < N; ++k) bond(s, k, k + 1, recipe);
  return s;
}

inline Stage plain_stage(double dt, double duration) {
  Stage stage;
  stage.name = "test";
  stage.dt = dt;
  stage.stops.duration = duration;
  return stage;
}

inline Support held(const std::vector<ParticleId>& particles, HeldDofs dofs, const Vec3d& velocity = {}) {
  Support s;
  s.group = "held";
  s.particles = particles;
  s.held = dofs;
  s.velocity = velocity;
  return s;
}
inline constexpr HeldDofs translations{true, true, true, false, false, false};
inline constexpr HeldDofs clamped{true, true, true, true, true, true};

/// A chain of eight of these bonds, moved and turning at random.
inline Specimen lively_chain(const BondRecipe& recipe, double speed) {
  Specimen s = straight_rod(8, recipe);
  Dice dice(3);
  for (const ParticleId p : s.state.r.ids())
    s.state.v[p] = dice.vector(speed), s.state.omega[p] = dice.vector(speed);
  return s;
}

}  // namespace vbond::testing
