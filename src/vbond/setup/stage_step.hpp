#pragma once
#include "vbond/core/problems.hpp"
#include "vbond/setup/build.hpp"

/// The time step of a stage of dynamics.
namespace vbond {

/// Whether the case wants the exact critical step.
bool step_is_exact(const Case& c);

/// Bonds to come are not in the exact step, so a stage that may make some is refused.
void refuse_exact_with_bonding(const Case& c, const Stage& stage, Problems& problems);

/// Gives stage k, which begins in this state, the step that the case wants, taken down to one that its times
/// are whole numbers of. Throws CaseError with all that is wrong with step and times.
void choose_fitting_step(const Case& c, std::size_t k, const Model& model, const BodyPart& body,
                         const ExactCriticalStep& exact_step, Stage& stage);

/// Refuses a duration of more steps of dt than any run will take.
void check_number_of_steps(const StageSpec& spec, double duration, double dt, Problems& problems);

/// Refuses a step that is given and too long for what the stage moves to and fro.
void check_swings(const Case& c, const StageSpec& spec, const Model& model, const Stage& stage,
                  Problems& problems);

/// Functions of time of the stage by steps, of which there are whole numbers.
void put_on_steps(Stage& stage);

}  // namespace vbond
