#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
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
#include "test.hpp"
#include "vbond/case/arguments.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"
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

/// Standard output goes nowhere while this lives.
class NoOutput {
 public:
  NoOutput() {
    std::fflush(stdout);
    kept_ = dup(STDOUT_FILENO);
    const int nowhere = kept_ < 0 ? -1 : open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;  // then the run prints
    dup2(nowhere, STDOUT_FILENO);
    close(nowhere);
  }
  ~NoOutput() {
    std::fflush(stdout);
    if (kept_ < 0) return;
    dup2(kept_, STDOUT_FILENO);
    close(kept_);
  }
  NoOutput(const NoOutput&) = delete;
  NoOutput& operator=(const NoOutput&) = delete;

 private:
  int kept_ = -1;
};

/// Options turned into numbers; all mistakes are told at once.
class Requested {
 public:
  Requested(const TestOptions& o, UnitSystem units) : o_(o), units_(units) {}

  /// One, or of triaxial tests one for each pressure.
  std::vector<labtest::Request> requests() {
    labtest::Request r;
    r.kind = kind();
    r.axis = direction(o_.axis);
    if (!o_.across.empty()) r.across = direction(o_.across);
    if (r.across == r.axis)
      arguments_.problem("--across", o_.across, "is along the axis of the specimen",
                         "give another direction");
    const bool ends = r.kind == Kind::tension || r.kind == Kind::compression;
    if (r.across && ends) only("--across", o_.across, "shear, bend3 and brazilian");
    r.at_rest = !o_.motion;
    r.ends = o_.ends == "grip" ? labtest::Ends::grip : labtest::Ends::slide;
    if (r.ends == labtest::Ends::grip && !ends) only("--ends", o_.ends, "tension and compression");
    r.strain = positive("--strain", o_.strain, keys::pure);
    if (r.strain && *r.strain >= 1.0) arguments_.problem("--strain", o_.strain, "must be < 1", "e.g. 0.02");
    if (r.strain && r.at_rest && *r.strain <= labtest::elastic_strain)
      arguments_.problem("--strain", o_.strain,
                         fmt::format("must be > {:g}, that of the stage for moduli", labtest::elastic_strain),
                         "give a larger one, or leave it out");
    r.rate = positive("--rate", o_.rate, keys::frequency);
    r.area = positive("--area", o_.area, keys::area);
    r.depth = positive("--depth", o_.depth, keys::length);
    r.span = positive("--span", o_.span, keys::length);
    if (r.span && r.kind != Kind::bend3) only("--span", o_.span, "bend3");
    if (!o_.damping.empty()) r.damping = within("--damping", o_.damping, 0.0, true);
    if (!o_.drop.empty()) r.drop = within("--drop", o_.drop, 0.0, false);
    r.frames = o_.frames;
    std::vector<labtest::Request> all = with_pressures(r);
    arguments_.throw_if_any();
    return all;
  }

 private:
  Kind kind() const {
    for (const Kind k : {Kind::tension, Kind::compression, Kind::shear, Kind::bend3, Kind::brazilian})
      if (o_.kind == labtest::to_text(k)) return k;
    return Kind::triaxial;
  }
  std::vector<labtest::Request> with_pressures(const labtest::Request& r) {
    if (r.kind != Kind::triaxial) {
      if (!o_.pressures.empty()) only("--pressure", o_.pressures.front(), "triaxial");
      return {r};
    }
    if (o_.pressures.empty())
      arguments_.problem(
          "vbond test triaxial", "", "needs the pressure all round",
          units_ == UnitSystem::si ? "give --pressure, as in --pressure \"10 MPa\"" : "give --pressure");
    std::vector<labtest::Request> all;
    for (const std::string& text : o_.pressures) {
      if (!is_bare_in_reduced("--pressure", text)) continue;
      all.push_back(r);
      all.back().pressure = arguments_.number(text, "--pressure", keys::stress);
      if (all.back().pressure < 0.0)
        arguments_.problem("--pressure", text, "must be >= 0", "a pressure > 0 presses on the body");
      for (std::size_t k = 0; k + 1 < all.size(); ++k)
        if (all[k].pressure == all.back().pressure)
          arguments_.problem("--pressure", text, "is given already", "give each pressure once");
    }
    return all;
  }
  static int direction(const std::string& name) { return name == "x" ? 0 : name == "y" ? 1 : 2; }
  void only(const char* option, const std::string& text, const char* kinds) {
    arguments_.problem(option, text, std::string("is for ") + kinds, "leave it out");
  }
  /// False after telling that it is none.
  bool is_bare_in_reduced(const char* option, const std::string& text) {
    if (units_ != UnitSystem::reduced || text.find_first_not_of("0123456789.eE+-") == std::string::npos)
      return true;
    arguments_.problem(option, text, "is no bare number, and the case is in reduced units",
                       "write a bare number");
    return false;
  }
  std::optional<double> positive(const char* option, const std::string& text, keys::Dimension dimension) {
    if (text.empty()) return std::nullopt;
    if (!is_bare_in_reduced(option, text)) return std::nullopt;
    return arguments_.positive(text, option, dimension);
  }
  /// A number below 1 and above a bound, or from it on.
  double within(const char* option, const std::string& text, double low, bool including) {
    const double x = arguments_.number(text, option, keys::pure);
    if (x >= 1.0 || x < low || (x == low && !including))
      arguments_.problem(option, text, including ? "must be >= 0 and < 1" : "must be > 0 and < 1",
                         "e.g. 0.5");
    return x;
  }

  const TestOptions& o_;
  UnitSystem units_;
  Arguments arguments_;
};

[[noreturn]] void refuse_folder(const fs::path& folder) {
  throw CaseError({{},
                   folder.string() + " already exists and is not empty",
                   "a test writes a folder of its own, or evaluates the run of the same test again",
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

std::string command_of(const RunOptions& options, const TestOptions& o) {
  std::string text = "vbond test " + o.kind + " " + shell_word(options.case_file.filename().string());
  const auto add = [&text](const char* name, const std::string& value) {
    if (!value.empty()) text += std::string(" ") + name + " " + shell_word(value);
  };
  for (const std::string& change : options.changes) add("--set", change);
  add("--axis", o.axis), add("--across", o.across), add("--ends", o.ends == "slide" ? "" : o.ends);
  if (o.motion) text += " --motion";
  add("--strain", o.strain), add("--drop", o.drop), add("--area", o.area), add("--depth", o.depth);
  add("--span", o.span), add("--rate", o.rate), add("--damping", o.damping);
  for (const std::string& pressure : o.pressures) add("--pressure", pressure);
  if (o.frames) text += " --frames";
  return text;
}

/// Takes away what has been written of a test that is refused before its run begins.
void discard(const fs::path& folder, bool one_of_several) {
  std::error_code e;
  fs::remove_all(folder / inputs_folder, e);
  fs::remove(folder / "test.toml", e), fs::remove(folder, e);
  if (one_of_several) fs::remove(folder.parent_path(), e);  // if it is empty
}

/// Mistakes of the made case, which is not kept, at the case that it was made of.
CaseError as_of(const fs::path& case_file, const CaseError& of_test) {
  std::vector<Problem> problems = of_test.problems();
  for (Problem& p : problems) {
    p.what = "in the case of the test, " + p.what;
    p.place = {case_file.string(), 0, 0};
  }
  return CaseError(std::move(problems));
}

/// Runs the made case as `vbond run` does. What is refused before it begins leaves nothing.
int run_made(const RunOptions& options, const TestOptions& test, const fs::path& folder) {
  RunOptions made = options;
  made.case_file = folder / "test.toml";
  made.changes.clear();
  made.folder = folder / "run";
  const auto has_begun = [&] {
    std::error_code e;
    return fs::exists(folder / "run", e);
  };
  try {
    std::optional<NoOutput> silent;
    if (!test.verbose) silent.emplace();
    return run(made);
  } catch (const CaseError& e) {
    if (has_begun()) throw;
    discard(folder, test.pressures.size() > 1);
    throw as_of(options.case_file, e);
  } catch (...) {
    if (has_begun())
      say("the run of the test has failed: no result; the case is " + (folder / "test.toml").string() +
              ", its run " + (folder / "run").string() + "\n",
          stderr);
    else
      discard(folder, test.pressures.size() > 1);
    throw;
  }
}

/// Whether there is a run of this test. Throws CaseError if it is that of another one, or not complete.
bool has_run(const fs::path& folder, const labtest::MadeTest& made, const std::string& command) {
  std::error_code e;
  if (!fs::exists(folder, e) || fs::is_empty(folder, e)) return false;
  if (!fs::exists(folder / "run", e) || !fs::exists(folder / "test.toml", e) ||
      !labtest::is_case_text(read_all(folder / "test.toml"), made, command))
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

/// What the tests of one call have in common.
struct Call {
  const RunOptions& options;
  const TestOptions& test;
  Case c;
  std::string title, command;
};

/// Writes the case of one test into a new folder, runs it, says what follows. The exit status, and the result
/// of a test that came to its end.
std::pair<int, std::optional<labtest::TestResult>> make_and_run(Call& call, const labtest::MadeTest& made,
                                                                const fs::path& folder) {
  if (has_run(folder, made, call.command)) {
    fmt::print("its run is complete, and is evaluated: {}\n", (folder / "run").string());
  } else {
    make_folder(folder);
    const Case written = keep_inputs(call.c, folder, {});
    replace_file(folder / "test.toml", labtest::case_text(written, made, call.title, call.command));
    if (const int status = run_made(call.options, call.test, folder); status != done) {
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
  Call call{options, o, read_case(options.case_file, options.changes), "", command_of(options, o)};
  call.title = call.c.title.empty() ? o.kind + " test" : o.kind + " test: " + call.c.title;
  const std::vector<labtest::Request> requests = Requested(o, call.c.units).requests();
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
