#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/run/run.hpp"

namespace vbond::app {

/// Duration and strain of a dynamics stage, with the step that they make of dt: what is known of its times
/// before it begins.
Stage expected_times(const StageSpec& spec, const Model& model, double dt);

/// What is known of the step of a stage before it begins.
struct StepAhead {
  double dt = 0;                                             ///< 0: it hangs on the stages before
  double longest = std::numeric_limits<double>::infinity();  ///< by what the stage moves to and fro
};
/// Of all stages; those after the one that comes next are looked at.
std::vector<StepAhead> steps_ahead(const Case& c, const Run& run);

/// Steps of each stage if none ends early; of static ones none. Stage `now` has the step dt, and so have
/// those of which nothing else is known.
std::vector<std::int64_t> steps_of_stages(const Case& c, const Model& model,
                                          const std::vector<StepAhead>& ahead, std::size_t now, double dt);

/// Prints what the run leaves aside or does not do to the letter, a line each.
void print_notes(const std::vector<std::string>& notes);

/// Prints title, particles, bonds, coordination, contacts and T_0.
void print_overview(const Case& c, const Model& model, const BodyPart& body);

/// Prints the step of a stage, the critical one and where it comes from, and what the step does not meet.
void print_step(const Case& c, const Model& model, const BodyPart& body, const Stage& stage);

/// The same of the first stage of dynamics after the one that comes next, as the body stands now. Returns it
/// with the step dt, if nothing else is known of it; none if there is no such stage.
std::optional<Stage> print_step_ahead(const Case& c, const Run& run, double dt);

/// Prints what the run computes with: the instruction set of the bonds and the number of threads; for static
/// stages the kernel of BLAS.
void print_machine(const Case& c, int threads);

}  // namespace vbond::app
