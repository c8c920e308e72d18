#pragma once
#include <algorithm>
#include <cmath>

#include "dynamics/rods.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond::testing {

/// Bernoulli-Euler bonds of the reference's standard rod: EI = 1, EA = 4e4, GJ = 1 / 1.2.
inline BondRecipe rod50_bond(double EA = 4e4) {
  BondRecipe recipe;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {EA, 0.2}, {1.0, 1 / EA, 2 / EA}, 0};
  return recipe;
}

/// Masses that add up to 1 and inertia 3 m EI / EA: with less, rotation would set the step.
inline void set_masses(Specimen& s, double bonds, double EI_over_EA) {
  s.model.mass.assign(s.model.particles(), 1.0 / bonds);
  s.model.inertia.assign(s.model.particles(), 3.0 / bonds * EI_over_EA);
}

/// The standard rod: N bonds, length 1, along x from the origin.
inline Specimen rod50(std::size_t N, double EA = 4e4) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= N; ++k) r.push_back({static_cast<double>(k) / static_cast<double>(N), 0, 0});
  Specimen s = particles_at(r, 0.1 / static_cast<double>(N));
  for (std::size_t k = 0; k < N; ++k) bond(s, k, k + 1, rod50_bond(EA));
  set_masses(s, static_cast<double>(N), 1 / EA);
  return s;
}

inline PointLoad load_on(std::size_t particle, const Vec3d& force, const Vec3d& moment = {}) {
  PointLoad l;
  l.group = "loaded";
  l.particles = {ParticleId{particle}};
  l.force = force;
  l.moment = moment;
  return l;
}

/// A stage in which every mode dies away at the rate `slowest`, the lowest frequency of the body: all modes
/// are then at or below critical damping. 0.7 of the step bound leaves room for bonds that stiffen.
inline Stage damped_stage(const Specimen& s, double slowest, double duration) {
  Stage stage = plain_stage(0.7 * step_bound(s.model, s.state).dt, duration);
  const ParticleId some{1};
  stage.b_translation = 2.0 * slowest * s.model.mass[some];
  stage.b_rotation = 2.0 * slowest * s.model.inertia[some];
  return stage;
}

/// Where the body comes to rest when the loads grow over 3 / slowest and then stay for 25 / slowest, which
/// leaves exp(-25) = 1e-11 of every mode that is no slower than `slowest`.
inline State rest_under(const Specimen& s, std::vector<PointLoad> loads, std::vector<Support> supports,
                        double slowest, const Vec3d& gravity = {}) {
  Stage stage = damped_stage(s, slowest, 28.0 / slowest);
  for (PointLoad& l : loads) l.factor.points = {{0, 0}, {3.0 / slowest, 1}};
  stage.loads = std::move(loads);
  stage.supports = std::move(supports);
  stage.gravity = gravity;
  Simulation run(s.model, stage, s.state);
  run.run();
  return run.state();
}

}  // namespace vbond::testing
