#pragma once
#include <optional>

#include "vbond/core/error.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {

/// What a static stage does not take of its case, as far as it is known before the run: bonds as capsules,
/// and modes of bonds at rest whose slopes in tension and compression differ. now: the stage begins with this
/// state; else bonds may break until then. place: of the stage.
std::optional<Problem> mistake_at_rest(const Model& model, const State& state, const StaticStage& stage,
                                       bool now, const SourcePlace& place);

}  // namespace vbond
