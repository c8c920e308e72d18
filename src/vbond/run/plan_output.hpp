#pragma once
#include <filesystem>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/observe/plan.hpp"

namespace vbond {

/// What the case wants written into this folder, with names and times resolved: for open_output
/// (observe/observers.hpp), which writes it. Throws CaseError.
OutputPlan plan_output(const Case& c, const Model& model, const std::filesystem::path& folder);

bool any_statics(const Case& c);

}  // namespace vbond
