#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {

/// A column that is read from a table.
struct WantedColumn {
  std::string title;  ///< its name in the header of the file
  bool required = false;
};

/// What happens to columns of the file that nobody wants.
struct OtherColumns {
  bool are_passed_over = false;
  std::string way_out;  ///< where they are refused
};

/// The wanted columns of a table.
struct CsvTable {
  std::vector<char> found;                       ///< for each wanted column: whether the file has it
  std::vector<std::vector<std::string>> fields;  ///< for each wanted column: one per row, if it is there
  std::vector<std::size_t> columns;  ///< for each wanted column: its place in a row, from 0, if it is there
  char separator = ',';
  std::uint32_t header_line = 1;         ///< from 1
  std::vector<std::uint32_t> lines;      ///< where each row begins
  std::vector<std::string> passed_over;  ///< titles
  std::size_t rows() const { return lines.size(); }
};

/// Reads a table as RFC 4180 has it and as spreadsheets, R and ParaView write it: a header line, then a line
/// per row. Fields may stand in quotes and then hold separators, line ends and, doubled, quotes. They are
/// separated by commas; by semicolons or tabs if the header has no comma. Lines end with LF, CR LF or CR. A
/// UTF-8 byte order mark, empty rows, and lines that begin with # are passed over.
/// Throws CaseError with the mistakes of the file; like read_bytes if it cannot be read.
CsvTable read_csv(const std::filesystem::path& file, const SourcePlace& place,
                  const std::vector<WantedColumn>& wanted, const OtherColumns& others);

/// The character of a line, from 1, at which a field of a row begins: field number k, from 0. 1 if the row
/// does not have it on this line, its first one.
std::uint32_t column_of_field(std::string_view line, char separator, std::size_t k);

/// A field in quotes, cut where it is too long to be shown.
std::string shown_field(const std::string& text);

}  // namespace vbond
