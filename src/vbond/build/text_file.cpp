#include "vbond/build/text_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

#include "vbond/build/problems.hpp"
#include "vbond/core/nearest.hpp"

namespace vbond {
namespace {

std::string_view trimmed(std::string_view s) {
  const std::size_t first = s.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t") - first + 1);
}

template <class T>
std::optional<T> parsed(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

void check_header(const CsvTable& table, const SourcePlace& header, const std::vector<std::string>& known,
                  const std::vector<std::string>& required, Problems& problems) {
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const std::string& column = table.columns[k];
    const auto near = nearest_name(column, known);
    if (std::find(known.begin(), known.end(), column) == known.end())
      problems.add(header, fmt::format("unknown column \"{}\"", column),
                   fmt::format("known columns: {}", fmt::join(known, ", ")),
                   near ? fmt::format("did you mean \"{}\"?", *near) : "rename or remove it");
    if (table.find(column) != k)
      problems.add(header, fmt::format("column \"{}\" appears twice", column), "each column appears once",
                   "remove one of them");
  }
  for (const std::string& column : required)
    if (!table.find(column))
      problems.add(header, fmt::format("there is no column \"{}\"", column),
                   fmt::format("the first line names the columns, among them {}", fmt::join(required, ", ")),
                   fmt::format("begin the file with the line {}", fmt::join(required, ",")));
}

}  // namespace

namespace {

/// The file, open. Throws CaseError at `place` if it is no file or cannot be read.
std::ifstream opened(const std::filesystem::path& file, const SourcePlace& place) {
  const auto refuse = [&](const std::string& reason) {
    throw CaseError({place, fmt::format("\"{}\" cannot be read: {}", file.string(), reason),
                     "file names are taken from the folder of the case file",
                     "check the name and the rights"});
  };
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_directory(status)) refuse("it is a folder");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    refuse("it is not a regular file, of which the output folder could hold a copy");
  std::ifstream in(file, std::ios::binary);
  if (!in) refuse(std::strerror(errno));
  return in;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file, const SourcePlace& place) {
  std::ifstream in = opened(file, place);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> read_lines(const std::filesystem::path& file, const SourcePlace& place) {
  std::ifstream in = opened(file, place);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

std::filesystem::path beside_case(const std::string& case_file, const std::filesystem::path& file) {
  return std::filesystem::path(case_file).parent_path() / file;  // an absolute `file` replaces the folder
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> to_number(std::string_view text) {
  const auto value = parsed<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> to_integer(std::string_view text) {
  return parsed<std::int64_t>(text);
}

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  const auto at = std::find(columns.begin(), columns.end(), column);
  if (at == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns.begin());
}

CsvTable read_csv(const std::filesystem::path& file, const SourcePlace& place,
                  const std::vector<std::string>& known, const std::vector<std::string>& required) {
  const std::vector<std::string> lines = read_lines(file, place);
  CsvTable table;
  Problems problems;
  SourcePlace at{file.string(), 0, 1};
  for (const std::string& line : lines) {
    ++at.line;
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const std::vector<std::string_view> fields = fields_of(text);
    if (table.columns.empty()) {
      table.columns.assign(fields.begin(), fields.end());
      check_header(table, at, known, required, problems);
      problems.throw_if_any();  // with a wrong header every row would be wrong too
    } else if (fields.size() != table.columns.size()) {
      problems.add(
          at, fmt::format("{} fields", fields.size()),
          fmt::format("a row has {} fields: {}", table.columns.size(), fmt::join(table.columns, ", ")),
          "complete the row or remove what is too much");
    } else {
      table.rows.emplace_back(fields.begin(), fields.end());
      table.lines.push_back(at.line);
    }
  }
  if (table.columns.empty()) check_header(table, {file.string(), 1, 1}, known, required, problems);
  problems.throw_if_any();
  return table;
}

}  // namespace vbond
