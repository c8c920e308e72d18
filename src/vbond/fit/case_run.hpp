#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// A case run in memory, for columns of its history: no file is written.
namespace vbond::fit {

/// Columns of history.csv of one run; numbers that a row lacks are NaN.
struct Rows {
  std::vector<std::vector<double>> columns;  ///< as they were asked for, row by row
  std::vector<std::size_t> stage;            ///< of each row
  /// A row that history.csv lacks: a stage begins where the one before it has ended, which is one row there.
  std::vector<char> only_of_stage;
  bool interrupted = false;
};

/// Text of a case, for runs with other values.
struct CaseText {
  std::string text;
  std::filesystem::path file;  ///< for messages, and where its relative file names start
};

/// Runs the case with these changes (case/read.hpp). `columns` are names of history.csv: CaseError, which
/// names the nearest, if there is no such column. Looks at the run as `vbond run` does, and throws what that
/// ends with: CaseError, Diverged, NoEquilibrium, NoConvergence, std::invalid_argument, IoError. Rows do not
/// depend on threads, nor on runs that go on at the same time.
Rows run_case(const CaseText& c, const std::vector<std::string>& changes,
              const std::vector<std::string>& columns, int threads, const std::function<bool()>& interrupted);

}  // namespace vbond::fit
