#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/observe/files.hpp"
#include "vbond/observe/history_values.hpp"
#include "vbond/observe/plan.hpp"

namespace vbond {

/// The first line of history.csv: the names of the columns, which are those of quantities.hpp.
std::string history_header(const OutputPlan& plan);

/// One row with 17 significant digits, enough to give back every double.
std::string history_row(const OutputPlan& plan, const HistoryValues& values);

/// history.columns.json: unit and meaning of each column, since the header of history.csv has its name alone.
std::string history_columns_json(const std::vector<std::string>& names, UnitSystem units);

/// Writes history.csv row by row, and history.columns.json beside it; what is written is readable at once and
/// stays so if the run dies.
class HistoryWriter {
 public:
  /// Begins a new file, or with resume_step continues one: rows after that step, which a killed run
  /// may have written past its checkpoint, are dropped. A case that was edited meanwhile may ask for other
  /// columns: new ones are added behind, empty so far; those that it no longer asks for stay, empty from now
  /// on. A file that is missing is begun anew, see begun_anew(). Throws IoError.
  HistoryWriter(const OutputPlan& plan, std::optional<std::int64_t> resume_step);

  /// Throws IoError, also if the file was removed, replaced or changed by others: its rows are then lost.
  void write(const HistoryValues& values);

  /// Step of the last row in the file, -1 if there is none.
  std::int64_t last_step() const { return last_step_; }
  /// Largest |balance_error| of the rows in the file.
  double largest_balance_error() const { return largest_balance_error_; }
  /// A run goes on, but its history.csv was not there any more.
  bool begun_anew() const { return begun_anew_; }

 private:
  void keep_until(std::int64_t resume_step);
  /// The row of the plan in the columns of the file.
  std::string in_columns_of_file(const std::string& row) const;

  OutputPlan plan_;
  std::filesystem::path path_;
  std::vector<std::string> columns_;  ///< of the file, as they stand there
  std::optional<GrowingFile> file_;
  std::int64_t last_step_ = -1;
  double largest_balance_error_ = 0;
  bool begun_anew_ = false;
};

}  // namespace vbond
