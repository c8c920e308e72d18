#pragma once
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// The model, if model, stage and state belong together: sizes of columns, particles that are named, the
/// step. Throws std::invalid_argument otherwise.
const Model& consistent(const Model& model, const Stage& stage, const State& state);

}  // namespace vbond
