#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/plan.hpp"

namespace vbond::app {

/// What the case wants written, with names and times resolved. Throws CaseError.
OutputPlan plan_output(const Case& c, const Model& model, const std::filesystem::path& folder);

/// Steps of each stage if none ends early, all with the step dt of the first; of static ones none.
std::vector<std::int64_t> steps_of_stages(const Case& c, const Model& model, double dt);

/// Prints particles, bonds, coordination, contacts, T_0, the step and the bound it comes from.
void print_overview(const Case& c, const Model& model, const State& state, const Stage& first);

/// Prints what the run computes with: the instruction set of the bonds and the number of threads.
void print_machine(int threads);

}  // namespace vbond::app
