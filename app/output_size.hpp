#pragma once
#include <cstdint>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/plan.hpp"

namespace vbond::app {

/// What a frame of this body takes before compression, particles and bonds together.  [bytes]
double bytes_of_frame(const Model& model, const State& state, const OutputPlan& plan);

/// Prints how many rows and frames the case asks for, and what they take. steps: of each stage.
void print_output_size(const Case& c, const OutputPlan& plan, const Model& model, const State& state,
                       const std::vector<std::int64_t>& steps);

}  // namespace vbond::app
