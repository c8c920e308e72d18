#pragma once
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// A particle, where it is and was at the start, and the part that has it.
struct PlacedParticle {
  ParticleId particle;
  int part;
  Vec3d r, r_0;
};

/// Of a body in parts, particles of other parts, and where they are, that this part may have nearer than
/// `reach` to one of its own, images too. Parts tell each other the boxes that their particles are in, and
/// then those whose box is near which of theirs are near it. All call it together.
std::vector<PlacedParticle> particles_across_borders(const Model& model, const State& state,
                                                     const std::vector<ParticleId>& own, double reach,
                                                     const Exchange& exchange);

}  // namespace vbond
