#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"

namespace CLI {
class App;
}

namespace vbond::labtest {
struct MadeTest;
struct PeakStresses;
struct TestResult;
}  // namespace vbond::labtest

namespace vbond::app {

/// Of `vbond test`, as texts with or without units; empty: not given.
struct TestOptions {
  std::string kind, axis = "z", across, ends = "slide";
  bool motion = false, frames = false, verbose = false;
  std::vector<std::string> pressures;
  std::string strain, rate, damping, area, depth, span, drop;
};

/// The command with all its options but --threads.
CLI::App* add_test(CLI::App& app, TestOptions& o, RunOptions& run);

/// Makes a laboratory test of the body of a case, runs it and says what follows: docs/laboratory-tests.md. Of
/// `run`: case_file, changes, folder, threads, program, processes.
int test(const RunOptions& run, const TestOptions& options);

/// Prints the result; and the same as JSON.
void print_result(const labtest::MadeTest& test, const labtest::TestResult& result, UnitSystem units);
std::string result_as_json(const labtest::MadeTest& test, const labtest::TestResult& result, UnitSystem units,
                           const std::string& case_file);

/// What triaxial tests at several pressures say together, printed and as JSON. `tests`: how many there were.
void print_envelope(const std::vector<labtest::PeakStresses>& peaks, std::size_t tests, UnitSystem units);
std::string envelope_as_json(const std::vector<labtest::PeakStresses>& peaks, std::size_t tests,
                             UnitSystem units, const std::string& case_file);

}  // namespace vbond::app
