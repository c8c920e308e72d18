#pragma once
#include <filesystem>

#include "processes.hpp"
#include "vbond/case/case.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::app {

/// Reads the checkpoint of an output folder; each of several processes reads its own bonds alone where the
/// body was set up with these. The body of the case gives up its state for it. Throws IoError if the file
/// cannot be read, CaseError if the case was edited so that the run cannot go on with it; all processes throw
/// if one does.
Checkpoint resume_from(Processes& processes, const Case& c, Built& built,
                       const std::filesystem::path& folder);

}  // namespace vbond::app
