#pragma once
#include <string>

#include "vbond/observe/summary.hpp"

namespace vbond {

/// dispersion.csv: a line for each mode of each wave vector of a stage of modes, with the names of its
/// columns first. Empty if the run has had no such stage.
std::string dispersion_table(const RunSummary& summary);

}  // namespace vbond
