#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "test_command.hpp"
#include "vbond/labtest/request.hpp"
#include "vbond/labtest/result.hpp"
#include "vbond/labtest/search_strengths.hpp"

namespace vbond::app {

/// Of `vbond calibrate CASE --tensile --compressive --toughness`, as texts with or without units; empty: not
/// given.
struct StrengthOptions {
  std::string tensile, compressive, toughness, notch = "50 %", within = "0.01";
  TestOptions test;  ///< how all tests are made; kind aside
};

/// What `calibrate`, which has all its other options already, takes for strengths of a case. Returned are
/// options that are for these alone.
std::vector<CLI::Option*> add_strengths(CLI::App* command, StrengthOptions& o, RunOptions& run);
/// Throws std::invalid_argument if one of them is given.
void refuse_without_strengths(const std::vector<CLI::Option*>& for_strengths);

/// A limit of a set of bonds that factors multiply.
struct BondLimit {
  std::size_t set = 0;
  const char* key = "";  ///< in the table strength
  double StrengthSpec::*of = nullptr;
  bool in_tension = false;  ///< else it goes with the factor of shear
  double given = 0;         ///< as the case has it  [force/length^2]
  /// With 6 digits: what is tested is what is printed.
  double with(const labtest::StrengthFactors& factors) const;
};
/// Limits of all sets of bonds that have strengths. Throws CaseError if none has, or some have no limits of
/// stress.
std::vector<BondLimit> limits_of(const Case& c);
/// The case with its limits multiplied.
Case with_factors(const Case& c, const std::vector<BondLimit>& limits,
                  const labtest::StrengthFactors& factors);
/// The same as changes of keys, as --set takes them.
std::vector<std::string> changes_of(const std::vector<BondLimit>& limits,
                                    const labtest::StrengthFactors& factors);

/// Tests that were made with the same factors.
struct TestsOfFactors {
  std::vector<std::string> folders;  ///< below that of the calibration, in their order
  std::optional<labtest::TestResult> tension, compression, bending;
  std::optional<labtest::TestResult>& of(labtest::Kind kind);
};

/// What a calibration tells.
struct Calibrated {
  const RunOptions& options;
  const StrengthOptions& asked;
  const Case& c;
  const labtest::StrengthGoal& goal;
  const std::vector<BondLimit>& limits;
  std::string command;
  std::filesystem::path folder;
  std::vector<labtest::StrengthEvaluation> evaluations;  ///< as many as there are
  std::vector<TestsOfFactors> tests;                     ///< of each of them
};

void print_head(const Calibrated& all);
/// One line for the last evaluation.
void print_evaluation(const Calibrated& all);
/// What the search has found; how it ended otherwise on stderr.
void print_search(const Calibrated& all, const labtest::StrengthSearch& search);
/// result.json; search: nothing while it is under way.
std::string strengths_as_json(const Calibrated& all, const labtest::StrengthSearch* search);

/// Finds factors of the strengths of a case's bonds with which its body has the strengths that are asked for,
/// by laboratory tests: docs/material.md. Of `run`: case_file, changes, folder, threads, program, processes.
int calibrate_strengths(const RunOptions& run, const StrengthOptions& asked);

}  // namespace vbond::app
