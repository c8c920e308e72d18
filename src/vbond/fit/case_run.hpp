#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// A case run in memory, for columns of its history: no file is written.
namespace vbond::fit {

/// How the columns change with a value.
struct Slope {
  std::vector<std::vector<double>> columns;  ///< d column / d value, as Rows::columns; empty: not known
  std::string why_not;
};

/// Columns of history.csv of one run; numbers that a row lacks are NaN.
struct Rows {
  std::vector<std::vector<double>> columns;  ///< as they were asked for, row by row
  std::vector<std::size_t> stage;            ///< of each row
  /// A row that history.csv lacks: a stage begins where the one before it has ended, which is one row there.
  std::vector<char> only_of_stage;
  bool interrupted = false;
  std::vector<Slope> slopes;  ///< of each Nudge
};

/// Text of a case, for runs with other values.
struct CaseText {
  std::string text;
  std::filesystem::path file;  ///< for messages, and where its relative file names start
};

/// A value whose effect on the rows is wanted too: all changes with this value at v + k step, k = -3 .. 3.
struct Nudge {
  double step = 0;  ///< > 0, in the unit of the value
  std::array<std::vector<std::string>, 7> changes;
  std::string why_not;  ///< it is known not to be a parameter of bonds; empty: it may be one
};

/// Runs the case with these changes (case/read.hpp). `columns` are names of history.csv: CaseError, which
/// names the nearest, if there is no such column. Looks at the run as `vbond run` does, and throws what that
/// ends with: CaseError, Diverged, NoEquilibrium, NoConvergence, std::invalid_argument, IoError. Rows do not
/// depend on threads, nor on runs that go on at the same time, nor on slopes, which come by the tangents of
/// balances (statics/sensitivity.hpp) for values that change bonds and nothing else, and for no column
/// wall.*.
Rows run_case(const CaseText& c, const std::vector<std::string>& changes,
              const std::vector<std::string>& columns, int threads, const std::function<bool()>& interrupted,
              const std::vector<Nudge>& nudges = {});

}  // namespace vbond::fit
