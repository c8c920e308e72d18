#include "vbond/dynamics/damping.hpp"

#include <cmath>

#include "vbond/dynamics/parallel.hpp"

namespace vbond {
namespace {

PerParticle<double> decay(double b, double dt, const PerParticle<double>& inertia) {
  PerParticle<double> factor;
  if (b == 0.0) return factor;
  for (const double m : inertia) factor.push_back(std::exp(-0.5 * b * dt / m));
  return factor;
}

/// Scales the rates and returns the kinetic energy that this takes away.
double slow_down(const PerParticle<double>& factor, const PerParticle<double>& inertia, int threads,
                 PerParticle<Vec3d>& rate) {
  if (factor.empty()) return 0.0;
  return sum_over(rate.size(), threads, [&](std::size_t k) {
    const ParticleId p{k};
    const double before = norm2(rate[p]);
    rate[p] = factor[p] * rate[p];
    return 0.5 * inertia[p] * (before - norm2(rate[p]));
  });
}

}  // namespace

Damping::Damping(const Model& model, const Stage& stage)
    : decay_v_(decay(stage.b_translation, stage.dt, model.mass)),
      decay_omega_(decay(stage.b_rotation, stage.dt, model.inertia)) {}

void Damping::apply_half_step(const Model& model, int threads, State& state) const {
  state.books.dissipated += slow_down(decay_v_, model.mass, threads, state.v);
  state.books.dissipated += slow_down(decay_omega_, model.inertia, threads, state.omega);
}

}  // namespace vbond
