#pragma once
#include <cstddef>
#include <vector>

#include "vbond/model/stage.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {

/// Two supports that hold a degree of freedom of a particle and do not move it alike.
struct Disagreement {
  ParticleId particle;
  std::size_t dof;            ///< 0..5, as in HeldDofs
  std::size_t first, second;  ///< of the supports
};

/// Each support that disagrees with one before it, once. Particles that are not among the first `particles`
/// are passed over. Supports move a degree of freedom alike if both hold it at rest, or at the same rate
/// times the same factor. A grip that turns agrees on translations with a grip alone: of the same motion,
/// about the same axis; two without a pivot must be of the same particles.
std::vector<Disagreement> disagreements(const std::vector<Support>& supports, std::size_t particles);
std::vector<Disagreement> disagreements(const std::vector<StaticSupport>& supports, std::size_t particles);

/// E.g. "x" or "the turn about z".
const char* name_of_dof(std::size_t dof);

}  // namespace vbond
