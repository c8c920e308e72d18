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

/// Whether the case wants the exact critical step.
bool step_is_exact(const Case& c);

/// Bonds to come are not in the exact step, so a stage that may make some is refused.
void refuse_exact_with_bonding(const Case& c, const Stage& stage, Problems& problems);

/// Gives stage k, which begins in this state, the step that the case wants, taken down to one that its times
/// are whole numbers of. Throws CaseError with all that is wrong with step and times.
void choose_fitting_step(const Case& c, std::size_t k, const Model& model, const State& state,
                         const ExactCriticalStep& exact_step, Stage& stage);

/// Refuses a static stage of a body without bonds and contacts.
void refuse_nothing_elastic(const StageSpec& spec, const Model& model, const State& state,
                            Problems& problems);

/// A time in the model's unit; records a multiple of an unknown T_0. `what` names the key.
double look_up_time(const CaseTime& time, const Model& model, const std::string& what,
                    const SourcePlace& place, Problems& problems);

/// Refuses a duration of more steps of dt than any run will take.
void check_number_of_steps(const StageSpec& spec, double duration, double dt, Problems& problems);

}  // namespace vbond
