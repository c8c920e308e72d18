#pragma once
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Whether a region holds the centre of a particle, or in a periodic body that of one of its images.
bool holds_image(const Space& region, const Model& model, const State& s, ParticleId p);

}  // namespace vbond
