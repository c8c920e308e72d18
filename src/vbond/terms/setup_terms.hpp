#pragma once
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {

/// What the terms do in a stage, from names to numbers; records every mistake.
void resolve_terms(const StageResolver& resolver, StageTerms& stage);

/// What follows from where the particles stand as the stage begins; records every mistake.
void complete_terms(const StageResolver& resolver, const State& state, StageTerms& stage);

}  // namespace vbond
