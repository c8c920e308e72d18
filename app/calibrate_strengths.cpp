#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "calibrate_strengths.hpp"
#include "campaign.hpp"
#include "lock.hpp"
#include "prepare.hpp"
#include "processes.hpp"
#include "shell.hpp"
#include "status.hpp"
#include "vbond/case/arguments.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/labtest/test_body.hpp"
#include "vbond/labtest/toughness_unit.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;
using labtest::Kind;

/// The run of a test was stopped from outside.
struct Stopped {
  int status;
};

/// Of --toughness; nothing if it is not given.
std::optional<double> toughness_of(Arguments& arguments, const std::string& text, UnitSystem units) {
  if (text.empty()) return std::nullopt;
  if (units == UnitSystem::reduced)  // a bare number
    return positive_argument(arguments, "--toughness", text, keys::pure, units);
  const auto parsed = labtest::parse_toughness(text);
  if (const auto* mistake = std::get_if<keys::UnitMistake>(&parsed)) {
    arguments.problem("--toughness", text, mistake->rule, mistake->way_out);
    return std::nullopt;
  }
  const double K = std::get<double>(parsed);
  if (!(K > 0.0)) arguments.problem("--toughness", text, "must be > 0", "give a positive value");
  return K;
}

/// What is asked for, as numbers.
labtest::StrengthGoal goal_of(const StrengthOptions& o, UnitSystem units) {
  Arguments arguments;
  labtest::StrengthGoal goal;
  goal.asked.tensile = positive_argument(arguments, "--tensile", o.tensile, keys::stress, units);
  goal.asked.compressive = positive_argument(arguments, "--compressive", o.compressive, keys::stress, units);
  goal.asked.toughness = toughness_of(arguments, o.toughness, units);
  goal.within = arguments.number(o.within, "--within", keys::pure);
  if (goal.within < 1e-4 || goal.within > 0.5)
    arguments.problem("--within", o.within, "must be from 1e-4 to 0.5, a part of each of them", "e.g. 0.01");
  arguments.throw_if_any();
  return goal;
}

/// Without files, which are told by name: the same command goes on in its folder.
std::string command_of(const RunOptions& options, const StrengthOptions& o) {
  const std::string test = test_command_of(options, o.test), made = "vbond test " + o.test.kind + " ";
  std::string text = "vbond calibrate " + test.substr(made.size());
  const auto add = [&text](const char* name, const std::string& value) {
    if (!value.empty()) text += std::string(" ") + name + " " + shell_word(value);
  };
  add("--tensile", o.tensile), add("--compressive", o.compressive), add("--toughness", o.toughness);
  if (!o.toughness.empty()) add("--notch", o.notch);
  add("--within", o.within);
  return text;
}

/// The folder must be new or empty, or that of the same command.
void require_folder(const fs::path& folder, const std::string& command) {
  std::error_code e;
  if (!fs::exists(folder, e) || (fs::is_directory(folder, e) && fs::is_empty(folder, e))) return;
  std::string rule = "a calibration writes a folder of its own, or goes on in that of the same command";
  if (fs::exists(folder / "result.json", e)) {
    const auto before = nlohmann::json::parse(read_all(folder / "result.json"), nullptr, false);
    if (before.is_object() && before.contains("command") && before["command"].is_string()) {
      if (before["command"] == command) return;
      rule += "; this one is of: " + before["command"].get<std::string>();
    }
  }
  throw CaseError({{},
                   folder.string() + " already exists and is not empty",
                   rule,
                   "choose another one with -o, or remove it"});
}

/// Whether the case in a folder is this one, with the same contents of its files.
bool is_same_case(const fs::path& folder, Case c, const labtest::MadeTest& made, const TestText& text) {
  const std::string before = read_all(folder / "test.toml");
  try {
    Case old = parse_case(before, folder / "test.toml");
    const std::vector<fs::path*> files = files_of(c), old_files = files_of(old);
    if (files.size() != old_files.size()) return false;
    for (std::size_t k = 0; k < files.size(); ++k) {
      if (read_all(*files[k]) != read_all(*old_files[k])) return false;
      *files[k] = fs::relative(*old_files[k], fs::absolute(folder));
    }
  } catch (const std::exception&) {
    return false;
  }
  return labtest::case_text(c, made, text.title, text.command) == before;
}

/// Changes of keys with which the case has these factors: those of the user but for limits, which are set
/// once.
std::vector<std::string> changes_with(const Calibrated& all, const labtest::StrengthFactors& factors) {
  std::vector<std::string> changes;
  for (const std::string& change : all.options.changes) {
    const std::string key = change.substr(0, change.find('='));
    const auto is_limit = [&key](const BondLimit& limit) {
      return key.ends_with(std::string(".strength.") + limit.key);
    };
    if (std::none_of(all.limits.begin(), all.limits.end(), is_limit)) changes.push_back(change);
  }
  const std::vector<std::string> limits = changes_of(all.limits, factors);
  changes.insert(changes.end(), limits.begin(), limits.end());
  return changes;
}

/// By how much a test in motion is too fast: 1 is the limit.
double excess(const labtest::Inertia& i) {
  using labtest::Inertia;
  return std::max({i.at_peak / Inertia::most_at_peak, i.largest / Inertia::most_before,
                   i.ends_differ / Inertia::most_of_ends});
}

/// How a test of this kind is made: that of a notched beam measures its section and has supports of its own.
TestOptions options_for(Kind kind, const StrengthOptions& o) {
  TestOptions test = o.test;
  test.kind = to_text(kind);
  if (kind == Kind::bend3) test.notch = o.notch, test.ends = "slide", test.area.clear(), test.depth.clear();
  return test;
}
labtest::Request request_for(Kind kind, const StrengthOptions& o, UnitSystem units) {
  return requests_of(options_for(kind, o), units).front();
}

/// Tests that are needed for what is asked for.
std::vector<Kind> kinds_of(const labtest::Strengths& asked) {
  std::vector<Kind> kinds;
  if (asked.tensile) kinds.push_back(Kind::tension);
  if (asked.compressive) kinds.push_back(Kind::compression);
  if (asked.toughness) kinds.push_back(Kind::bend3);
  return kinds;
}
std::optional<double>& strength_of(Kind kind, labtest::Strengths& strengths) {
  if (kind == Kind::tension) return strengths.tensile;
  return kind == Kind::compression ? strengths.compressive : strengths.toughness;
}

/// Makes tests with factors. In motion the strain at which a test ends sets its speed: it follows the
/// strain at the peak. Those that are too fast are made slower.
class Tests {
 public:
  Tests(Calibrated& all, const Built& built)
      : all_(all), built_(built), request_(request_for(Kind::tension, all.asked, all.c.units)) {}

  /// A test that was made with these very factors just before is not made again.
  labtest::StrengthsFound operator()(const labtest::StrengthFactors& factors,
                                     const labtest::Strengths& asked) {
    ++number_;
    const Case c = with_factors(all_.c, all_.limits, factors);
    const bool again = !all_.evaluations.empty() &&
                       all_.evaluations.back().factors.tension == factors.tension &&
                       all_.evaluations.back().factors.shear == factors.shear;
    all_.tests.push_back(again ? all_.tests.back() : TestsOfFactors{});
    all_.tests.back().folders.clear();
    labtest::StrengthsFound found;
    for (const Kind kind : kinds_of(asked)) {
      std::optional<double>& to = strength_of(kind, found.strengths);
      if (again) to = strength_of(kind, all_.evaluations.back().found.strengths);
      if (!to && found.why.empty()) to = strength(kind, c, factors, found.why);
    }
    all_.evaluations.push_back({factors, found});
    print_evaluation(all_);
    replace_file(all_.folder / "result.json", strengths_as_json(all_, nullptr));
    return found;
  }

 private:
  /// Of one test. Nothing, and why, if it has none to rely on.
  std::optional<double> strength(Kind kind, const Case& c, const labtest::StrengthFactors& factors,
                                 std::string& why) {
    // strains go with the strengths of bonds, by whichever limit breaks them
    const double size = std::sqrt(factors.tension * factors.shear);
    std::optional<double> strain = request_.strain;  // of a beam it is another one, and only a first guess
    if (!request_.at_rest)
      if (const auto known = strain_.find(kind); known != strain_.end()) strain = known->second * size;
    std::optional<double> before;  // of one that was too fast
    constexpr int tries = 4;
    for (int k = 0; k < tries; ++k) {
      const labtest::TestResult result = run(kind, strain, c, factors, k);
      all_.tests.back().of(kind) = result;
      why = why_no_strength(result);
      if (!why.empty()) why = std::string(to_text(kind)) + ": " + why;
      if (result.peak && !request_.at_rest) strain_[kind] = 2.0 * result.peak->strain / size;
      if (why.empty()) return kind == Kind::bend3 ? result.toughness->K_Ic : result.peak->stress;
      if (request_.at_rest) break;
      if (result.peak) {  // too fast
        if (request_.rate) break;
        const double is = excess(*result.inertia);
        if (before && is > 0.7 * *before) {
          why +=
              "; three times slower it is no better: bonds that break set waves free, which weigh most in a "
              "body "
              "of few grains; take more grains, or tests at rest";
          break;
        }
        before = is;
        slower_[kind] *= 3.0;
        continue;
      }
      const bool over = result.ended == "peak" || result.ended == "parted";  // while the platens set in
      strain = over ? 2.0 * result.largest.strain : 2.0 * strain.value_or(labtest::default_strain);
      if (!(*strain > 0.0) || *strain > largest_strain) break;
    }
    return std::nullopt;
  }

  labtest::TestResult run(Kind kind, std::optional<double> strain, const Case& c,
                          const labtest::StrengthFactors& factors, int again) {
    TestOptions test = options_for(kind, all_.asked);
    labtest::Request request = request_for(kind, all_.asked, c.units);
    if (strain && !request_.at_rest) {
      test.strain = fmt::format("{:.2g}", *strain);
      request.strain = std::strtod(test.strain.c_str(), nullptr);
    }
    labtest::MadeTest made = labtest::make_test(labtest::body_of(c, built_, request), request);
    if (slower_[kind] > 1.0) {
      test.rate = fmt::format("{:.3g}", made.rate / slower_[kind]);
      request.rate = std::strtod(test.rate.c_str(), nullptr);
      made = labtest::make_test(labtest::body_of(c, built_, request), request);
    }
    RunOptions options = all_.options;
    options.changes = changes_with(all_, factors);
    const TestText text{c.title.empty() ? test.kind + " test" : test.kind + " test: " + c.title,
                        test_command_of(options, test), Prints::nothing};
    std::string name = fmt::format("{:02}-{}", number_, test.kind);
    if (again > 0) name += fmt::format("-{}", again + 1);
    all_.tests.back().folders.push_back(name);
    const fs::path folder = all_.folder / name;
    if (!has_run(folder, c, made, text)) {
      std::error_code e;
      fs::remove_all(folder, e);  // a test that was stopped
      if (const int status = write_and_run(all_.options, c, made, text, folder, false); status == failed)
        throw NoEquilibrium("see " + (folder / "log.txt").string());
      else if (status != done)
        throw Stopped{status};
    }
    labtest::TestResult result = labtest::result_of(made, folder / "run");
    replace_file(folder / "result.json",
                 result_as_json(made, result, c.units, all_.options.case_file.filename().string()));
    return result;
  }

  /// Whether the run of this very test is there and complete. Throws CaseError if it is that of another body.
  static bool has_run(const fs::path& folder, const Case& c, const labtest::MadeTest& made,
                      const TestText& text) {
    std::error_code e;
    if (!fs::exists(folder / "test.toml", e)) return false;
    if (!is_same_case(folder, c, made, text))
      throw CaseError({{c.file, 0, 0},
                       "the test in " + folder.string() + " is of another case",
                       "a calibration goes on with its own tests",
                       "choose another folder with -o, or remove that one"});
    if (!fs::exists(folder / "run" / "status.json", e)) return false;
    require_free(folder / "run", run_lock);
    return read_status(folder / "run").state == RunState::complete;
  }

  static constexpr double largest_strain = 0.2;

  Calibrated& all_;
  const Built& built_;
  labtest::Request request_;
  int number_ = 0;
  std::map<Kind, double> strain_;  ///< in motion: at the end of a test over the size of its factors
  std::map<Kind, double> slower_{
      {Kind::tension, 1.0}, {Kind::compression, 1.0}, {Kind::bend3, 1.0}};  ///< than by default
};

/// With failed runs as tests without a strength.
labtest::StrengthsFound told(Tests& tests, Calibrated& all, const labtest::StrengthFactors& factors,
                             const labtest::Strengths& asked) {
  const auto failed_as = [&](const std::exception& e) {
    labtest::StrengthsFound found;
    const std::string text = e.what();
    found.why =
        "the run of " + all.tests.back().folders.back() + " has failed: " + text.substr(0, text.find('\n'));
    all.evaluations.push_back({factors, found});
    print_evaluation(all);
    return found;
  };
  try {
    return tests(factors, asked);
  } catch (const NoEquilibrium& e) {
    return failed_as(e);
  } catch (const Diverged& e) {
    return failed_as(e);
  }
}

/// Takes away what has been written before the first test was refused.
void discard(const fs::path& folder) {
  std::error_code e;
  fs::remove(folder / "result.json", e), fs::remove(folder / run_lock, e), fs::remove(folder, e);
}

}  // namespace

int calibrate_strengths(const RunOptions& options, const StrengthOptions& o) {
  if (has_ranks) throw std::invalid_argument("tests run in one process: use vbond calibrate");
  instruction_set();  // refuses a wrong VBOND_SIMD before anything is written
  if (options.case_file == "-" && !options.folder)
    throw std::invalid_argument("a case of the standard input has no name\n  give the folder with -o DIR");
  StrengthOptions asked = o;
  asked.test.kind = "tension";
  const Case c = read_case(options.case_file, options.changes);
  if (!asked.test.motion && !has_statics())
    throw CaseError(
        Problem{{c.file, 0, 0},
                "this vbond was built without statics",
                "a test at rest is a sequence of equilibria",
                "make them in motion with --motion, or build with VBOND_STATICS=ON: docs/install.md"});
  const labtest::StrengthGoal goal = goal_of(asked, c.units);
  const std::vector<BondLimit> limits = limits_of(c);
  Calibrated all{options, asked, c, goal, limits, command_of(options, asked), {}, {}, {}};
  all.folder = options.folder.value_or(options.case_file.stem().string() + ".calibrate");
  require_folder(all.folder, all.command);
  const Built built = build(c, options.threads);
  print_notes(built.notes);
  if (const auto note = labtest::left_out(c)) print_notes({*note});
  Tests tests(all, built);
  // what is wrong with the body is told before anything is written
  const std::vector<Kind> kinds = kinds_of(goal.asked);
  for (const Kind kind : kinds) {
    const labtest::Request request = request_for(kind, asked, c.units);
    const labtest::MadeTest made = labtest::make_test(labtest::body_of(c, built, request), request);
    parse_case(labtest::case_text(c, made, c.title, all.command), all.folder / "test.toml");
    if (kind == kinds.front()) print_notes(made.notes);
  }
  std::error_code none;
  const bool is_new = !fs::exists(all.folder / "result.json", none);
  make_folder(all.folder);
  labtest::StrengthSearch search;
  try {
    const FolderLock lock(all.folder, run_lock);
    replace_file(all.folder / "result.json", strengths_as_json(all, nullptr));
    print_head(all);
    search = labtest::search_strengths(
        goal, [&](const labtest::StrengthFactors& factors, const labtest::Strengths& which) {
          return told(tests, all, factors, which);
        });
    replace_file(all.folder / "result.json", strengths_as_json(all, &search));
  } catch (const Stopped& e) {
    say("stopped: the same command goes on, with the tests that are complete\n", stderr);
    return e.status;
  } catch (const CaseError&) {
    if (is_new && all.evaluations.empty()) discard(all.folder);
    throw;
  }
  print_search(all, search);
  return search.end == labtest::StrengthSearchEnd::reached ? done : failed;
}

}  // namespace vbond::app
