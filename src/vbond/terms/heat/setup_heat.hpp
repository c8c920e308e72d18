#pragma once
#include <vector>

#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/heat/heating.hpp"

namespace vbond {

/// What heats particles in a stage. Records temperatures at which a bond set would have no length left, or
/// that nothing feels.
std::vector<Heating> resolve_heating(const StageResolver& resolver);

}  // namespace vbond
