#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "vbond/model/stage.hpp"

namespace vbond {

/// Two supports that hold a degree of freedom of a particle and do not move it alike; or two that hold it
/// along, or about, axes that are neither parallel nor perpendicular to each other.
struct Disagreement {
  ParticleId particle;
  std::string dof;            ///< e.g. "x", "the turn about (0.6, 0.8, 0)"
  std::size_t first, second;  ///< of the supports
  bool oblique = false;       ///< the axes are neither parallel nor perpendicular
};

/// Each support that disagrees with one before it, once. Particles that are not among the first `particles`
/// are passed over. Supports move a degree of freedom alike if both hold it at rest, or at the same rate
/// times the same factor. A grip that turns agrees on translations with a grip alone: of the same motion,
/// about the same axis; two without a pivot must be of the same particles. A grip that is free in part agrees
/// with no other support.
std::vector<Disagreement> disagreements(const std::vector<Support>& supports, std::size_t particles);

}  // namespace vbond
