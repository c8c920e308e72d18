#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "vbond/case/case.hpp"
#include "vbond/case/dimension.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vbond {
class Arguments;
}
namespace vbond::labtest {
struct MadeTest;
struct PeakStresses;
struct Request;
struct TestResult;
}  // namespace vbond::labtest

namespace vbond::app {

/// Of `vbond test`, as texts with or without units; empty: not given.
struct TestOptions {
  std::string kind, axis = "z", across, ends = "slide";
  bool motion = false, frames = false, verbose = false;
  std::vector<std::string> pressures;
  std::string strain, rate, damping, area, depth, span, drop, notch, modulus;
};

/// Options that every test of a body takes which is tension or compression. Returned are all of them.
std::vector<CLI::Option*> add_test_of_ends(CLI::App* command, TestOptions& o);
/// The command with all its options but --threads.
CLI::App* add_test(CLI::App& app, TestOptions& o, RunOptions& run);

/// Makes a laboratory test of the body of a case, runs it and says what follows: docs/laboratory-tests.md. Of
/// `run`: case_file, changes, folder, threads, program, processes.
int test(const RunOptions& run, const TestOptions& options);

/// The options as numbers: one request, or of triaxial tests one for each pressure. Throws CaseError with all
/// mistakes.
std::vector<labtest::Request> requests_of(const TestOptions& options, UnitSystem units);
/// Of an option; nothing if it is not given, or after telling that it has a unit in a reduced case.
std::optional<double> positive_argument(Arguments& arguments, const char* option, const std::string& text,
                                        const keys::Dimension& dimension, UnitSystem units);
/// The command of that test as a shell takes it, without its folder.
std::string test_command_of(const RunOptions& options, const TestOptions& test);

/// What the run of a test prints. Nothing: it is log.txt in the folder of the test.
enum class Prints : std::uint8_t { everything, failures, nothing };
/// What stands at the head of the case of a test, and what its run prints.
struct TestText {
  std::string title, command;
  Prints prints = Prints::failures;
};
/// Writes the case of a test and copies of its files into a new folder, and runs it as `vbond run` does. The
/// exit status. What is refused before it begins leaves nothing. one_of_several: the folder above it goes
/// likewise, if it is empty then. Of `options`: case_file, for messages, threads, program, processes.
int write_and_run(const RunOptions& options, Case c, const labtest::MadeTest& made, const TestText& text,
                  const std::filesystem::path& folder, bool one_of_several);

/// Prints the result; and the same as JSON.
void print_result(const labtest::MadeTest& test, const labtest::TestResult& result, UnitSystem units);
std::string result_as_json(const labtest::MadeTest& test, const labtest::TestResult& result, UnitSystem units,
                           const std::string& case_file);

/// What triaxial tests at several pressures say together, printed and as JSON. `tests`: how many there were.
void print_envelope(const std::vector<labtest::PeakStresses>& peaks, std::size_t tests, UnitSystem units);
std::string envelope_as_json(const std::vector<labtest::PeakStresses>& peaks, std::size_t tests,
                             UnitSystem units, const std::string& case_file);

}  // namespace vbond::app
