#pragma once
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/strain/strain.hpp"

namespace vbond {

/// The strain that a stage imposes on a group, about its centroid at the start.
StrainProgram resolve_strain(const StageResolver& resolver, const StrainSpec& s);

}  // namespace vbond
