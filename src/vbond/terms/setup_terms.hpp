#pragma once
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/stage_terms.hpp"

namespace vbond {

/// What the terms do in a stage, from names to numbers; records every mistake.
void resolve_terms(const StageResolver& resolver, StageTerms& stage);

}  // namespace vbond
