#pragma once
#include <cstddef>

#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/model/source.hpp"
#include "vbond/model/state.hpp"
#include "vbond/setup/bond_pairs.hpp"
#include "vbond/setup/build.hpp"

namespace vbond {

/// The first body of a source as it waits, alone in open space, with the bonds that it has so far.
State body_alone(const Built& built, const Source& source);

/// Makes the bonds of a set (when = start) between particles that are there, and tells sources which bonds it
/// makes inside of their bodies. Refuses pairs that are listed and of which one end waits.
void add_bonds_at_start(const Case& c, std::size_t set, Built& built, Problems& problems,
                        SharedCells& shared);
/// Refuses sets that list particles which come in, but for bonds of the start inside of a body.
void check_pairs_of_sources(const Case& c, const Model& model, Problems& problems);

}  // namespace vbond
