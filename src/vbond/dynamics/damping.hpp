#pragma once
#include "vbond/core/column.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Viscous drag -b v and -b omega over half a step, solved exactly (v decays by exp(-b dt / 2m)): stable
/// for any b, and what it takes out of the kinetic energy is known to the last digit.
class Damping {
 public:
  Damping(const Model& model, const Stage& stage);
  /// Slows every particle down and books the energy; supports put their own velocities back after it.
  void apply_half_step(const Model& model, int threads, State& state) const;

 private:
  PerParticle<double> decay_v_, decay_omega_;  // factors per half step; empty: no such damping
};

}  // namespace vbond
