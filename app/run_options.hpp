#pragma once
#include <CLI/CLI.hpp>

#include "commands.hpp"

/// Options that vbond and vbond-lammps have in common.
namespace vbond::app {

/// The case, and what of it is to be other than the file says.
void add_case(CLI::App* command, RunOptions& run);
/// What `run` takes besides, but for threads.
void add_output(CLI::App* command, RunOptions& run);
void add_printing(CLI::App* command, RunOptions& run);

/// Sends what would be printed nowhere, if that is asked for, and opens what is printed in its place. Throws
/// IoError.
void choose_printing(RunOptions& run);

}  // namespace vbond::app
