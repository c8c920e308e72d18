#include <fmt/format.h>

#include <cstdio>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "inputs.hpp"
#include "prepare.hpp"
#include "processes.hpp"
#include "shell.hpp"
#include "status.hpp"
#include "test_command.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/labtest/envelope.hpp"
#include "vbond/labtest/result.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;
using labtest::Kind;

[[noreturn]] void refuse_folder(const fs::path& folder) {
  throw CaseError({{},
                   folder.string() + " already exists and is not empty",
                   "a test writes a folder of its own, or evaluates the run of the same body and test again",
                   "choose another one with -o, or remove it"});
}

/// The folder of a test, which must be new or empty, or that of a test.
fs::path folder_of(const RunOptions& options, const TestOptions& test) {
  fs::path folder = options.folder.value_or(options.case_file.stem().string() + "." + test.kind);
  std::error_code e;
  const fs::path first = test.pressures.size() > 1 ? folder / "pressure-1" : folder;
  if (fs::exists(folder, e) && !(fs::is_directory(folder, e) && fs::is_empty(folder, e)) &&
      !fs::exists(first / "test.toml", e))
    refuse_folder(folder);
  return folder;
}

/// What the tests of one call have in common.
struct Call {
  const RunOptions& options;
  const TestOptions& test;
  Case c;
  std::string title, command;
};

/// Whether the case of a folder is that of this test: body, bonds, files that they read, and the test itself.
bool is_case_of(const fs::path& folder, const Call& call, const labtest::MadeTest& made) {
  try {
    const fs::path file = folder / "test.toml";
    Case c = call.c;
    return reads_the_same(c, read_case(file)) &&
           labtest::case_text(c, made, call.title, call.command) == read_all(file);
  } catch (const CaseError&) {
    return false;
  }
}

/// Whether there is a run of this test. Throws CaseError if it is that of another one, or not complete.
bool has_run(const fs::path& folder, const Call& call, const labtest::MadeTest& made) {
  std::error_code e;
  if (!fs::exists(folder, e) || fs::is_empty(folder, e)) return false;
  if (!fs::exists(folder / "run", e) || !fs::exists(folder / "test.toml", e) ||
      !is_case_of(folder, call, made))
    refuse_folder(folder);
  const fs::path run = folder / "run";
  if (read_status(run).state != RunState::complete)
    throw CaseError(
        {{},
         "the run in " + run.string() + " is not complete",
         "only a run that has come to its end is evaluated",
         "go on with vbond resume " + shell_word(run.string()) + ", then give this command again"});
  return true;
}

/// Writes the case of one test into a new folder, runs it, says what follows. The exit status, and the result
/// of a test that came to its end.
std::pair<int, std::optional<labtest::TestResult>> make_and_run(Call& call, const labtest::MadeTest& made,
                                                                const fs::path& folder) {
  if (has_run(folder, call, made)) {
    fmt::print("its run is complete, and is evaluated: {}\n", (folder / "run").string());
  } else {
    const TestText text{call.title, call.command, call.test.verbose ? Prints::everything : Prints::failures};
    const bool one_of_several = call.test.pressures.size() > 1;
    if (const int status = write_and_run(call.options, call.c, made, text, folder, one_of_several);
        status != done) {
      say("no result yet: once that run is complete, the same vbond test command evaluates it\n", stderr);
      return {status, std::nullopt};
    }
  }
  labtest::TestResult result = labtest::result_of(made, folder / "run");
  replace_file(folder / "result.json",
               result_as_json(made, result, call.c.units, call.options.case_file.filename().string()));
  print_result(made, result, call.c.units);
  fmt::print("case in {}, its run in {}, result in {}\n", (folder / "test.toml").string(),
             (folder / "run").string(), (folder / "result.json").string());
  std::fflush(stdout);
  return {done, std::move(result)};
}

std::vector<labtest::MadeTest> make_tests(const Case& c, const std::vector<labtest::Request>& requests,
                                          int threads) {
  const Built built = build(c, threads);
  print_notes(built.notes);
  std::vector<labtest::MadeTest> made;
  for (const labtest::Request& r : requests) {
    made.push_back(labtest::make_test(labtest::body_of(c, built, r), r));
    if (const auto note = labtest::left_out(c)) made.back().notes.push_back(*note);
  }
  return made;
}

}  // namespace

int test(const RunOptions& options, const TestOptions& o) {
  if (has_ranks) throw std::invalid_argument("tests run in one process: use vbond test");
  instruction_set();  // refuses a wrong VBOND_SIMD before anything is written
  if (options.case_file == "-" && !options.folder)
    throw std::invalid_argument("a case of the standard input has no name\n  give the folder with -o DIR");
  Call call{options, o, read_case(options.case_file, options.changes), "", test_command_of(options, o)};
  call.title = call.c.title.empty() ? o.kind + " test" : o.kind + " test: " + call.c.title;
  const std::vector<labtest::Request> requests = requests_of(o, call.c.units);
  if (requests.front().at_rest && !has_statics())
    throw CaseError(
        Problem{{call.c.file, 0, 0},
                "this vbond was built without statics",
                "a test at rest is a sequence of equilibria",
                "make it in motion with --motion, or build with VBOND_STATICS=ON: docs/install.md"});
  const fs::path folder = folder_of(options, o);
  const std::vector<labtest::MadeTest> tests = make_tests(call.c, requests, options.threads);
  for (const labtest::MadeTest& made : tests)  // none has a mistake
    parse_case(labtest::case_text(call.c, made, call.title, call.command), folder / "test.toml");
  if (tests.size() == 1) return make_and_run(call, tests.front(), folder).first;

  std::vector<labtest::PeakStresses> peaks;
  for (std::size_t k = 0; k < tests.size(); ++k) {
    const auto [status, result] = make_and_run(call, tests[k], folder / fmt::format("pressure-{}", k + 1));
    if (status != done) return status;
    const double pressure = requests[k].pressure;
    if (result->peak) peaks.push_back({pressure, result->peak->stress + pressure});
  }
  replace_file(folder / "result.json",
               envelope_as_json(peaks, tests.size(), call.c.units, options.case_file.filename().string()));
  print_envelope(peaks, tests.size(), call.c.units);
  fmt::print("envelope in {}\n", (folder / "result.json").string());
  return done;
}

}  // namespace vbond::app
