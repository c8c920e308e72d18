#pragma once
#include "vbond/build/build.hpp"
#include "vbond/build/problems.hpp"

namespace vbond {

/// Stage k with everything looked up but its step, and no bonds made. Records every mistake.
Stage resolve_stage(const Case& c, const Model& model, std::size_t k, Problems& problems);

/// A time in the model's unit; records a multiple of an unknown T_0. `what` names the key.
double look_up_time(const CaseTime& time, const Model& model, const std::string& what,
                    const SourcePlace& place, Problems& problems);

}  // namespace vbond
