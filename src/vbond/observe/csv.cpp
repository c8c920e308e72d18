#include "vbond/observe/csv.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/types.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

struct WriteCell {
  fmt::memory_buffer& row;
  void operator()(std::monostate) const {}
  void operator()(std::int64_t x) const { fmt::format_to(std::back_inserter(row), "{}", x); }
  void operator()(double x) const { fmt::format_to(std::back_inserter(row), "{:.17g}", x); }
  void operator()(std::string_view x) const { row.append(csv_quoted(std::string(x))); }
};

/// Into the texts that are there, which keep their memory from row to row.
void split_cells(std::string_view line, std::vector<std::string>& cells) {
  std::size_t count = 0, from = 0;
  const auto end_cell = [&](std::size_t to) {
    if (count == cells.size()) cells.emplace_back();
    cells[count++].assign(line, from, to - from);
    from = to + 1;
  };
  bool in_quotes = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"') in_quotes = !in_quotes;
    if (line[k] == ',' && !in_quotes) end_cell(k);
  }
  end_cell(line.size());
  cells.resize(count);
}

}  // namespace

std::string csv_line(std::span<const Cell> cells) {
  fmt::memory_buffer row;
  bool first = true;
  for (const Cell& cell : cells) {
    if (!std::exchange(first, false)) row.push_back(',');
    std::visit(WriteCell{row}, cell);
  }
  row.push_back('\n');
  return fmt::to_string(row);
}

std::string csv_line(const std::vector<std::string>& cells) {
  return fmt::format("{}\n", fmt::join(cells, ","));
}

std::string csv_quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv_plain(const std::string& cell) {
  if (cell.empty() || cell.front() != '"') return cell;
  std::string text;
  for (std::size_t k = 1; k + 1 < cell.size(); ++k) {
    text += cell[k];
    if (cell[k] == '"') ++k;
  }
  return text;
}

std::vector<std::string> csv_cells(std::string_view line) {
  std::vector<std::string> cells;
  split_cells(line, cells);
  return cells;
}

std::optional<std::size_t> index_of(const std::vector<std::string>& texts, std::string_view text) {
  const auto at = std::find(texts.begin(), texts.end(), text);
  if (at == texts.end()) return std::nullopt;
  return static_cast<std::size_t>(at - texts.begin());
}

// ---- reading --------------------------------------------------------------------------------------------

LineReader::LineReader(const std::filesystem::path& path) : file_(open_file(path, "rb")), path_(path) {}
LineReader::~LineReader() {
  std::free(line_);
}

std::optional<std::string_view> LineReader::next() {
  const ssize_t size = getline(&line_, &room_, file_.get());
  if (size < 0) require_read(file_.get(), path_);
  if (size <= 0 || line_[size - 1] != '\n') return std::nullopt;
  return std::string_view(line_, static_cast<std::size_t>(size) - 1);
}

CsvReader::CsvReader(const std::filesystem::path& path) : path_(path), lines_(path) {
  const auto first = lines_.next();
  if (!first) return;
  line_ = *first;
  split_cells(line_, header_);
}

std::size_t CsvReader::place(std::string_view name) const {
  const auto at = index_of(header_, name);
  if (!at) throw IoError(path_.string() + ": has no column " + std::string(name));
  return *at;
}

bool CsvReader::next() {
  const auto line = lines_.next();
  if (!line) return false;
  line_ = *line;
  split_cells(line_, cells_);
  if (cells_.size() != header_.size()) refuse();
  return true;
}

void CsvReader::refuse() const {
  throw IoError(path_.string() + ": is damaged at \"" + line_.substr(0, 60) + '"');
}

// ---- writing --------------------------------------------------------------------------------------------

std::string columns_json(const std::vector<std::string>& names, UnitSystem units,
                         const FactsOfColumn& facts_of) {
  nlohmann::ordered_json columns;
  for (const std::string& name : names) {
    const auto facts = facts_of(name);
    columns[name] = {{"unit", facts ? facts->unit.in(units) : ""}, {"meaning", facts ? facts->meaning : ""}};
  }
  return columns.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

CsvWriter::CsvWriter(std::filesystem::path path, Content content, UnitSystem units,
                     std::optional<std::int64_t> keep_until)
    : path_(std::move(path)) {
  for (const std::string& name : content.columns) asked_.push_back(csv_quoted(name));
  columns_ = asked_;
  std::error_code e;
  begun_anew_ = keep_until && !std::filesystem::exists(path_, e) && !e;
  if (keep_until && !begun_anew_) {
    continue_after(*keep_until, content);
    file_.emplace(path_, GrowingFile::Begin::at_end);
  } else {
    file_.emplace(path_, GrowingFile::Begin::anew);
    file_->append(csv_line(columns_));
  }
  std::vector<std::string> names;
  for (const std::string& column : columns_) names.push_back(csv_plain(column));
  std::filesystem::path beside = path_;
  beside.replace_extension(".columns.json");
  replace_file(beside, columns_json(names, units, content.facts), Sync::none);
}

void CsvWriter::continue_after(std::int64_t last, const Content& content) {
  CsvReader in(path_);
  const std::vector<std::string>& old = in.header();
  columns_ = old;
  for (const std::string& name : content.necessary)
    if (!index_of(old, name))
      throw IoError(path_.string() + ": its columns are not those of " + content.what +
                    ", so it cannot be continued\n  move it away, and resume begins a new one");
  for (const std::string& name : asked_)
    if (!index_of(old, name)) columns_.push_back(name);

  std::vector<std::string> names;
  for (const std::string& column : old) names.push_back(csv_plain(column));
  const std::size_t place_at = index_of(old, content.ordered_by).value();
  const Look look = content.looker(names);
  std::uintmax_t kept = in.line().size() + 1;
  std::optional<Replacement> wider;
  if (columns_ != old) wider.emplace(path_), wider->write(csv_line(columns_));
  const std::string empty_cells(columns_.size() - old.size(), ',');
  while (in.next()) {
    const auto place = csv_number<std::int64_t>(in.cells()[place_at]);
    const bool late = place && *place > last;
    if (!place || (!late && !look(in.cells()))) in.refuse();
    if (late) break;
    kept += in.line().size() + 1;
    if (wider) wider->write(fmt::format("{}{}\n", in.line(), empty_cells));
  }
  if (wider)
    wider->publish(Sync::to_disk);
  else
    cut_file(path_, kept);
}

void CsvWriter::write(std::span<const Cell> row) {
  if (columns_ == asked_) return file_->append(csv_line(row));
  std::vector<Cell> placed;
  for (const std::string& name : columns_) {
    const auto at = index_of(asked_, name);
    placed.push_back(at ? row[*at] : Cell());
  }
  file_->append(csv_line(placed));
}

}  // namespace vbond
