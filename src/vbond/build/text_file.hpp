#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {

/// All lines of a file that a case names, without line ends (LF or CR LF).
/// Throws CaseError at `place`, where the case names it, if it cannot be read.
std::vector<std::string> read_lines(const std::filesystem::path& file, const SourcePlace& place);

/// All bytes of such a file. Throws like read_lines.
std::string read_bytes(const std::filesystem::path& file, const SourcePlace& place);

/// The file as seen from the folder of the case file.
std::filesystem::path beside_case(const std::string& case_file, const std::filesystem::path& file);

/// The words of a line, separated by blanks and tabs.
std::vector<std::string_view> words_of(std::string_view line);
/// The fields of a line between commas, blanks around them taken off.
std::vector<std::string_view> fields_of(std::string_view line);

/// A finite number, if that is all the text holds.
std::optional<double> to_number(std::string_view text);
/// A whole number, if that is all the text holds.
std::optional<std::int64_t> to_integer(std::string_view text);

/// A table of numbers with named columns: a header line, then one line per row; empty lines and lines
/// that begin with # are passed over.
struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< as many fields as columns
  std::vector<std::uint32_t> lines;            ///< line number of each row, from 1
  std::optional<std::size_t> find(std::string_view column) const;
};

/// Reads such a table whose columns are among `known` and include `required`.
/// Throws CaseError with all mistakes of the file.
CsvTable read_csv(const std::filesystem::path& file, const SourcePlace& place,
                  const std::vector<std::string>& known, const std::vector<std::string>& required);

}  // namespace vbond
