#pragma once
#include <vector>

#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/pressure/pressure.hpp"

namespace vbond {

/// The pressures of a stage, but for their facets.
std::vector<Pressure> resolve_pressures(const StageResolver& resolver);

/// Their facets, as the stage begins in this state. Records surfaces that are none.
void find_facets(const StageResolver& resolver, const State& state, std::vector<Pressure>& pressures);

}  // namespace vbond
