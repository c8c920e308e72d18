#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "vbond/core/random.hpp"
#include "vbond/packing/vessel.hpp"

namespace vbond::packing {

/// Random sequential addition: puts spheres one after the other at random places of the vessel, those at
/// which they overlap nothing; radii do not grow. Returns the centres of those that found a place: it ends
/// with the first one that `most_draws` places in a row refuse.  [length]
std::vector<Vec3d> add_sequentially(const Vessel& vessel, std::span<const double> radii, Random& random,
                                    std::size_t most_draws);

}  // namespace vbond::packing
