#pragma once
#include <string>

#include "vbond/observe/summary.hpp"

namespace vbond {

/// fracture.csv: a line for each bond that broke in a stage of fracture, with the names of its columns first.
/// Empty if the run has had no such stage.
std::string fracture_table(const RunSummary& summary);

}  // namespace vbond
