#include "vbond/setup/csv_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "vbond/core/nearest.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/setup/text_file.hpp"

namespace vbond {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

bool ends_line(char c) {
  return c == '\n' || c == '\r';
}

/// Goes through the records of a text.
class CsvScanner {
 public:
  CsvScanner(std::string_view text, const std::filesystem::path& file, Problems& problems)
      : text_(text), problems_(problems), place_{file.string(), 1, 1} {
    if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
  }

  /// The next record that holds anything and is no comment; false at the end.
  bool next(std::vector<std::string>& fields) {
    while (at_ < text_.size()) {
      skip_blanks();
      if (at_ < text_.size() && text_[at_] == '#') {
        at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
        end_line();
        continue;
      }
      if (separator_ == '\0') choose_separator();
      place_.line = line_;
      read_record(fields);
      const auto is_empty = [](const std::string& field) { return field.empty(); };
      if (!std::all_of(fields.begin(), fields.end(), is_empty)) return true;
    }
    return false;
  }

  const SourcePlace& place() const { return place_; }  ///< where the record begins
  char separator() const { return separator_ == '\0' ? ',' : separator_; }

 private:
  /// That of the header, which at_ has come to.
  void choose_separator() {
    std::size_t commas = 0, semicolons = 0, tabs = 0;
    bool quoted = false;
    for (std::size_t k = at_; k < text_.size() && (quoted || !ends_line(text_[k])); ++k) {
      if (text_[k] == '"') quoted = !quoted;
      if (quoted) continue;
      commas += text_[k] == ',', semicolons += text_[k] == ';', tabs += text_[k] == '\t';
    }
    if (at_ == text_.size() || ends_line(text_[at_])) return;  // the header is still to come
    if (commas > 0 && semicolons > 0)
      problems_.add({place_.file, line_, 1}, "the header has commas and semicolons",
                    "one of them separates the columns", "put names that hold the other one into quotes");
    separator_ = commas > 0 ? ',' : semicolons > 0 ? ';' : tabs > 0 ? '\t' : ',';
  }

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] == '\t' && separator_ != '\t'))) ++at_;
  }

  /// Goes to the beginning of the next line from the end of this one.
  void end_line() {
    if (at_ == text_.size()) return;
    at_ += text_.compare(at_, 2, "\r\n") == 0 ? 2 : 1;
    ++line_;
  }

  bool at_end_of_field() const {
    return at_ == text_.size() || text_[at_] == separator_ || ends_line(text_[at_]);
  }

  void read_record(std::vector<std::string>& fields) {
    fields.clear();
    for (;;) {
      skip_blanks();
      if (at_ < text_.size() && text_[at_] == '"')
        read_quoted(fields.emplace_back());
      else
        read_plain(fields.emplace_back());
      if (at_ == text_.size()) return;
      if (ends_line(text_[at_])) return end_line();
      ++at_;  // past the separator
    }
  }

  void read_plain(std::string& field) {
    const std::size_t from = at_;
    while (!at_end_of_field()) ++at_;
    field = text_.substr(from, at_ - from);
    field.erase(field.find_last_not_of(" \t") + 1);
  }

  void read_quoted(std::string& field) {
    const SourcePlace begin{place_.file, line_, 1};
    for (++at_; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '"') {
        if (text_.compare(at_, 2, "\"\"") != 0) break;
        ++at_;
      }
      line_ += c == '\n' || (c == '\r' && text_.compare(at_, 2, "\r\n") != 0);
      field += c;
    }
    if (at_ == text_.size()) {
      problems_.add(begin, "a field in quotes that does not end",
                    "a field that begins with a quote ends with one",
                    "close it; a quote inside of it is doubled");
      return;
    }
    ++at_;
    skip_blanks();
    if (at_end_of_field()) return;
    problems_.add(begin, fmt::format("text after the field {}", shown_field(field)),
                  "a field in quotes ends with its second quote",
                  "quote all of the field; a quote inside of it is "
                  "doubled");
    while (!at_end_of_field()) ++at_;
  }

  std::string_view text_;
  Problems& problems_;
  SourcePlace place_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1;
  char separator_ = '\0';  ///< not known yet
};

/// The first names of a list, and how many there are besides.
std::string first_names(const std::vector<std::string>& names) {
  constexpr std::size_t most = 30;
  std::vector<std::string> shown;
  for (std::size_t k = 0; k < std::min(most, names.size()); ++k) shown.push_back(names[k]);
  const std::string text = fmt::format("{}", fmt::join(shown, ", "));
  return names.size() <= most ? text : fmt::format("{} and {} more", text, names.size() - most);
}

/// Finds the wanted columns in a header.
class CsvHeader {
 public:
  static constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();

  CsvHeader(const std::vector<std::string>& titles, const std::vector<WantedColumn>& wanted,
            const OtherColumns& others, SourcePlace place, Problems& problems)
      : place_(std::move(place)), problems_(problems) {
    for (const WantedColumn& column : wanted) wanted_.push_back(column.title);
    std::unordered_map<std::string_view, std::size_t> number;
    for (std::size_t k = 0; k < wanted_.size(); ++k) number.emplace(wanted_[k], k);
    column_of_.assign(wanted.size(), nowhere);
    for (std::size_t column = 0; column < titles.size(); ++column) {
      const auto found = number.find(titles[column]);
      if (found != number.end())
        take(found->second, column);
      else if (others.are_passed_over)
        passed_over_.push_back(titles[column]);
      else
        refuse_unknown(titles[column], others.way_out);
    }
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (wanted[k].required && column_of_[k] == nowhere) refuse_missing(wanted[k].title, titles, wanted);
  }

  /// Where the k-th wanted column is, or `nowhere`.
  std::size_t column_of(std::size_t k) const { return column_of_[k]; }
  const std::vector<std::string>& passed_over() const { return passed_over_; }

 private:
  void take(std::size_t k, std::size_t column) {
    if (column_of_[k] == nowhere)
      column_of_[k] = column;
    else
      problems_.add(place_, fmt::format("column {} appears twice", shown_field(wanted_[k])),
                    "each column that is read appears once", "rename or remove one of them");
  }

  void refuse_unknown(const std::string& title, const std::string& way_out) {
    const auto near = ++unknown_ > Problems::most_shown ? std::nullopt : nearest_name(title, wanted_);
    problems_.add(place_, fmt::format("unknown column {}", shown_field(title)),
                  fmt::format("known columns: {}", fmt::join(wanted_, ", ")),
                  near ? fmt::format("did you mean \"{}\"?", *near) : way_out);
  }

  void refuse_missing(const std::string& title, const std::vector<std::string>& titles,
                      const std::vector<WantedColumn>& wanted) {
    std::vector<std::string> required;
    for (const WantedColumn& column : wanted)
      if (column.required) required.push_back(column.title);
    const auto near = ++unknown_ > Problems::most_shown ? std::nullopt : nearest_name(title, passed_over_);
    problems_.add(place_, fmt::format("there is no column {}", shown_field(title)),
                  fmt::format("the first line names the columns, among them {}; here it has {}",
                              fmt::join(required, ", "), titles.empty() ? "none" : first_names(titles)),
                  near ? fmt::format("did you mean {}?", shown_field(*near))
                       : fmt::format("begin the file with the line {}", fmt::join(required, ",")));
  }

  SourcePlace place_;
  Problems& problems_;
  std::vector<std::string> wanted_, passed_over_;
  std::vector<std::size_t> column_of_;
  std::size_t unknown_ = 0;
};

void refuse_wide_characters(const std::string& content, const std::filesystem::path& file) {
  if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF"))
    throw CaseError({{file.string(), 0, 0},
                     "the file is text of 16 bits per character (UTF-16)",
                     "CSV files are read as UTF-8 or ASCII",
                     "save it as \"CSV UTF-8\""});
}

}  // namespace

std::string shown_field(const std::string& text) {
  constexpr std::size_t most = 60;
  if (text.size() <= most) return '"' + text + '"';
  std::size_t cut = most;
  while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xC0) == 0x80) --cut;  // whole UTF-8
  return '"' + text.substr(0, cut) + "...\"";
}

std::uint32_t column_of_field(std::string_view line, char separator, std::size_t k) {
  const bool marked = line.starts_with(byte_order_mark);
  std::size_t at = marked ? byte_order_mark.size() : 0;
  bool quoted = false;
  for (; k > 0 && at < line.size(); ++at) {
    if (line[at] == '"') quoted = !quoted;  // a doubled quote does it twice
    if (line[at] == separator && !quoted) --k;
  }
  if (k > 0) return 1;
  at = std::min(line.find_first_not_of(separator == '\t' ? " " : " \t", at), line.size());
  const std::string_view before = line.substr(0, at);
  const auto characters = std::count_if(
      before.begin(), before.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
  return static_cast<std::uint32_t>(characters + (marked ? 0 : 1));
}

CsvTable read_csv(const std::filesystem::path& file, const SourcePlace& place,
                  const std::vector<WantedColumn>& wanted, const OtherColumns& others) {
  const std::string content = read_bytes(file, place);
  refuse_wide_characters(content, file);
  Problems problems;
  CsvScanner scanner(content, file, problems);
  std::vector<std::string> fields;
  const bool any = scanner.next(fields);
  const std::vector<std::string> titles = any ? std::exchange(fields, {}) : std::vector<std::string>{};
  const CsvHeader header(titles, wanted, others, any ? scanner.place() : SourcePlace{file.string(), 1, 1},
                         problems);
  problems.throw_if_any();  // with a wrong header every row would be wrong too

  CsvTable table;
  table.header_line = scanner.place().line;
  table.passed_over = header.passed_over();
  table.separator = scanner.separator();
  table.fields.resize(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    table.columns.push_back(header.column_of(k));
    table.found.push_back(header.column_of(k) != CsvHeader::nowhere);
  }
  const std::string rule = fmt::format("the header has {} columns: {}", titles.size(), first_names(titles));
  while (scanner.next(fields)) {
    if (fields.size() != titles.size()) {
      problems.add(scanner.place(), fmt::format("{} fields", fields.size()), rule,
                   "complete the row or remove what is too much");
      continue;
    }
    table.lines.push_back(scanner.place().line);
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (table.found[k]) table.fields[k].push_back(std::move(fields[header.column_of(k)]));
  }
  problems.throw_if_any();
  return table;
}

}  // namespace vbond
