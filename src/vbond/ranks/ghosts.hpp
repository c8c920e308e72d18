#pragma once
#include <vector>

#include "vbond/dynamics/order.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// What a rank with these particles must know beside them: the second ends of their bonds, and all particles
/// and images within reach of them, or all particles besides. reach: 0: none.  [length]
/// Each once, in order of particles and images.
std::vector<ImageOf> ghosts_of(const std::vector<ParticleId>& own, const Model& model, const State& state,
                               double reach, bool all);

}  // namespace vbond
