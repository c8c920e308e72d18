#pragma once
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// A particle of some part, where it is, and where it was at the start.
struct PlacedParticle {
  ParticleId particle;
  Vec3d r, r_0;
};

/// Of a body in parts, particles of other parts, and where they are, that this part may have nearer than
/// `reach` to one of its own, images too. Parts tell each other the boxes that their particles are in, and
/// then all of them which of theirs are near another's box. All call it together.
std::vector<PlacedParticle> particles_across_borders(const Model& model, const State& state,
                                                     const std::vector<ParticleId>& own, double reach,
                                                     const Exchange& exchange);

}  // namespace vbond
