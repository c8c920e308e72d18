#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/observe/csv.hpp"
#include "vbond/observe/history_values.hpp"
#include "vbond/observe/plan.hpp"

namespace vbond {

/// The names of the columns, which are those of quantities.hpp, and a row of them.
std::vector<std::string> history_columns(const OutputPlan& plan);
std::vector<Cell> history_row(const OutputPlan& plan, const HistoryValues& values);

/// The first line of history.csv: the names of the columns.
std::string history_header(const OutputPlan& plan);

/// Writes history.csv row by row, as CsvWriter does, and history.columns.json beside it.
class HistoryWriter {
 public:
  /// Begins a new file, or with resume_step continues one. Throws IoError.
  HistoryWriter(const OutputPlan& plan, std::optional<std::int64_t> resume_step);
  HistoryWriter(const HistoryWriter&) = delete;
  HistoryWriter& operator=(const HistoryWriter&) = delete;

  /// Throws IoError, also if the file was removed, replaced or changed by others: its rows are then lost.
  void write(const HistoryValues& values);

  /// Step of the last row in the file, -1 if there is none.
  std::int64_t last_step() const { return last_step_; }
  /// Largest |balance_error| of the rows in the file.
  double largest_balance_error() const { return largest_balance_error_; }
  /// Largest force that supports exert on the first group whose reaction is asked for, if one is.  [force]
  std::optional<double> largest_load() const { return largest_load_; }
  /// Largest size of the force of particles on each wall of the plan, of the rows in the file.  [force]
  const std::vector<double>& largest_on_walls() const { return largest_on_walls_; }
  /// A run goes on, but its history.csv was not there any more.
  bool begun_anew() const { return file_.begun_anew(); }

 private:
  CsvWriter::Look looker(const std::vector<std::string>& columns);

  OutputPlan plan_;
  std::int64_t last_step_ = -1;
  double largest_balance_error_ = 0;
  std::optional<double> largest_load_;
  std::vector<double> largest_on_walls_;
  CsvWriter file_;  // last: as it is opened it takes up the rows of an earlier run
};

}  // namespace vbond
