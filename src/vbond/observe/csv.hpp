#pragma once
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/units.hpp"
#include "vbond/observe/files.hpp"

namespace vbond {

/// What stands in one place of a CSV file: nothing, a whole number, a number, or a word.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string_view>;

/// A line of these cells; numbers have 17 significant digits, enough to give back every double.
std::string csv_line(std::span<const Cell> cells);
/// A line of texts as they stand in the file.
std::string csv_line(const std::vector<std::string>& cells);

/// A text as CSV wants it, quoted if it holds a comma, a quote or a line end; and what it was.
std::string csv_quoted(const std::string& text);
std::string csv_plain(const std::string& cell);

/// The cells of a line without its end, as they stand there: quoted ones with their quotes.
std::vector<std::string> csv_cells(std::string_view line);

/// The number that a cell holds, and nothing else.
template <class T>
std::optional<T> csv_number(const std::string& cell) {
  T value{};
  const char* end_of_cell = cell.data() + cell.size();
  const auto [end, error] = std::from_chars(cell.data(), end_of_cell, value);
  if (error != std::errc{} || end != end_of_cell) return std::nullopt;
  return value;
}

/// Where a text stands among others; nothing if it does not.
std::optional<std::size_t> index_of(const std::vector<std::string>& texts, std::string_view text);

/// Reads a file line by line, whatever its size. Throws IoError.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// The next line without its end; nothing at the end of the file, or for a last line cut short.
  std::optional<std::string_view> next();

 private:
  File file_;
  std::filesystem::path path_;
  char* line_ = nullptr;
  std::size_t room_ = 0;
};

/// Reads a table that CsvWriter has written, row by row. Throws IoError.
class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& path);

  /// The cells of the first line, as they stand in the file; none if it is not there as a whole.
  const std::vector<std::string>& header() const { return header_; }
  /// Where the column of this name stands; throws if there is none.
  std::size_t place(std::string_view name) const;

  /// Goes to the next row; false at the end, also before a last line that is still being written. Throws for
  /// a row that has more or fewer cells than the header.
  bool next();
  const std::vector<std::string>& cells() const { return cells_; }  ///< of the row, as they stand in the file
  const std::string& line() const { return line_; }  ///< that row without its end; at first the header

  /// Throws: the file is damaged at this row.
  [[noreturn]] void refuse() const;

 private:
  std::filesystem::path path_;
  LineReader lines_;
  std::vector<std::string> header_, cells_;
  std::string line_;
};

/// What a column holds.
struct ColumnFacts {
  Unit unit;
  const char* meaning;
};
using FactsOfColumn = std::function<std::optional<ColumnFacts>(std::string_view)>;

/// Unit and meaning of each column as JSON, since the header of a CSV file has its name alone.
std::string columns_json(const std::vector<std::string>& names, UnitSystem units, const FactsOfColumn& facts);

/// A CSV file that grows row by row as a run goes: what is written is readable at once and stays so if the
/// run dies. NAME.columns.json stands beside NAME.csv.
class CsvWriter {
 public:
  /// Looks at the cells of a row that is kept; false if they cannot be.
  using Look = std::function<bool(const std::vector<std::string>& cells)>;
  struct Content {
    const char* what;                    ///< for messages: "a history"
    std::vector<std::string> columns;    ///< their names
    const char* ordered_by;              ///< the one that grows from row to row: "step"
    std::vector<std::string> necessary;  ///< those without which an old file is none of this kind
    FactsOfColumn facts;
    std::function<Look(const std::vector<std::string>& columns)> looker;  ///< for the columns of an old file
  };
  /// Begins a new file, or with keep_until continues one: rows after that step, which a killed run may have
  /// written past its checkpoint, are dropped. A case that was edited meanwhile may ask for other columns:
  /// new ones are added behind, empty so far; those that it no longer asks for stay, empty from now on. A
  /// file that is missing is begun anew, see begun_anew(). Throws IoError.
  CsvWriter(std::filesystem::path path, Content content, UnitSystem units,
            std::optional<std::int64_t> keep_until);

  /// A row of the columns asked for. Throws IoError, also if the file was removed, replaced or changed by
  /// others: its rows are then lost.
  void write(std::span<const Cell> row);

  /// A run goes on, but its file was not there any more.
  bool begun_anew() const { return begun_anew_; }

 private:
  void continue_after(std::int64_t last, const Content& content);

  std::filesystem::path path_;
  std::vector<std::string> asked_;    ///< columns asked for, as they would stand in the file
  std::vector<std::string> columns_;  ///< of the file
  std::optional<GrowingFile> file_;
  bool begun_anew_ = false;
};

}  // namespace vbond
