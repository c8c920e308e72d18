#pragma once
#include <optional>
#include <string>

#include "vbond/model/capsules.hpp"

namespace vbond {

/// A capsule of a region of overlap that closes to a ring, and the one that touches it there.
struct RingOfContact {
  std::string first, second;  ///< names
  ParticleId i, j;            ///< the first particles of both
};

/// Such a region, if fibres touch so as particles stand: all around, as two closed fibres or two that go on
/// through the faces of a cell and lie along each other. The energy of contacts counts regions by their Euler
/// characteristic, which is 0 for a ring: it is not felt. For looks now and then, not for a time loop.
std::optional<RingOfContact> ring_of_contact(const Model& model, const State& state);

}  // namespace vbond
