#pragma once
#include "vbond/core/problems.hpp"
#include "vbond/setup/build.hpp"

namespace vbond {

/// Dynamics stage k with everything looked up but its step, and no bonds made. Records every mistake.
Stage resolve_stage(const Case& c, const Model& model, std::size_t k, Problems& problems);

/// The same for static stage k.
StaticStage resolve_static_stage(const Case& c, const Model& model, std::size_t k, Problems& problems);

/// Looks at all stages of the case, and at the stages that bond sets name.
void check_stages(const Case& c, const Model& model, Problems& problems);

/// Refuses a static stage of a body without bonds and contacts.
void refuse_nothing_elastic(const StageSpec& spec, const Model& model, const State& state,
                            Problems& problems);

/// A time in the model's unit; records a multiple of an unknown T_0. `what` names the key.
double look_up_time(const CaseTime& time, const Model& model, const std::string& what,
                    const SourcePlace& place, Problems& problems);

}  // namespace vbond
