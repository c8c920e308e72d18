#pragma once
#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Adds the initial velocities of the case, one after another, each to what is there; components named in
/// `zero` are then set to zero for that group. Random ones are drawn in order of the particles.
void add_velocities(const Case& c, const Model& model, State& state, Problems& problems);

}  // namespace vbond
