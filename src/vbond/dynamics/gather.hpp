#pragma once
#include <span>
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/model/state.hpp"

/// State of a whole body from those of its parts, field by field as state_table.hpp says who knows it. All
/// parts call these in the same order.
namespace vbond {

/// What all parts know, as one of them has it, and the sums of what they add up. Bonds, of which there are
/// many, are left as they are. The numbers of `more` are summed over the parts as well.
void gather_values(const State& part, const Exchange& exchange, std::span<double> more, State& whole);

/// What belongs to particles and bonds, and what parts list. `part` has been collected from its rows. Of
/// parts that are not to have it all, only the one that leads gets it.
void gather_owned(const State& part, const std::vector<ParticleId>& own_particles,
                  const std::vector<BondId>& own_bonds, const Exchange& exchange, bool everyone,
                  State& whole);

}  // namespace vbond
