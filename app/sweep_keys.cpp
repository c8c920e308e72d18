#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "sweep.hpp"

namespace vbond::app {
namespace {

[[noreturn]] void refuse(std::string text, const std::string& rule) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  throw std::invalid_argument(
      "--set " + text + ": " + rule +
      "\n  write KEY=a,b,c or KEY=range(first, last, count) or KEY=logrange(first, last, count);" +
      "\n  keys that go together: KEY,KEY=a:b,c:d");
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// Where the TOML string ends that begins at this quote: behind its last quote, or with the text.
std::size_t behind_string(const std::string& text, std::size_t at) {
  const char quote = text[at];
  const bool triple = text.compare(at, 3, std::string(3, quote)) == 0;
  const std::string end(triple ? 3 : 1, quote);
  for (std::size_t k = at + end.size(); k < text.size(); ++k)
    if (quote == '"' && text[k] == '\\')
      ++k;
    else if (text.compare(k, end.size(), end) == 0)
      return k + end.size();
  return text.size();
}

/// The parts of a text between separators that stand in no brackets or quotes.
std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0, at = 0;
  for (int depth = 0; at < text.size();) {
    const char c = text[at];
    if (c == separator && depth == 0) {
      parts.push_back(trimmed(text.substr(begin, at - begin)));
      begin = at + 1;
    }
    depth += c == '[' || c == '{' || c == '(' ? 1 : c == ']' || c == '}' || c == ')' ? -1 : 0;
    at = c == '"' || c == '\'' ? behind_string(text, at) : at + 1;
  }
  parts.push_back(trimmed(text.substr(begin)));
  return parts;
}

constexpr double most_points = 1e6;

/// Three numbers: first, last, count.
std::array<double, 3> three_numbers(const std::string& all, const std::string& text, bool by_factor) {
  const std::vector<std::string> words = parts_of(text, ',');
  std::array<double, 3> number{};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t end = 0;
    try {
      if (words.size() == 3) number[k] = std::stod(words[k], &end);
    } catch (const std::exception&) {
    }
    if (end == 0 || end != words[k].size() || !std::isfinite(number[k]))
      refuse(all, "a range has three numbers");
  }
  if (number[2] < 2 || number[2] > most_points || number[2] != std::floor(number[2]))
    refuse(all, "the count must be a whole number from 2 to 1000000");
  if (by_factor && !(number[0] > 0.0 && number[1] > 0.0)) refuse(all, "both ends of a logrange must be > 0");
  return number;
}

/// The k-th value. Where a difference, product or ratio of the ends is beyond what a double holds, each end
/// has its weight.
double in_range(double first, double last, double count, double k) {
  const double x = first + k * (last - first) / (count - 1);  // whole numbers stay whole
  const double t = k / (count - 1);
  return std::isfinite(x) ? x : (1 - t) * first + t * last;
}
double in_logrange(double first, double last, double count, double k) {
  const double t = k / (count - 1), ratio = last / first;
  return std::isnormal(ratio) ? first * std::pow(ratio, t) : std::pow(first, 1 - t) * std::pow(last, t);
}

bool is_range(const std::string& text) {
  return text.starts_with("range(") || text.starts_with("logrange(");
}

/// The values of range(...) or logrange(...), which begins the text, or nothing.
std::vector<std::string> range_of(const std::string& all, const std::string& text) {
  if (!is_range(text)) return {};
  const bool by_factor = text.starts_with("logrange(");
  const std::size_t open = text.find('('), close = text.find(')');
  if (close == std::string::npos) refuse(all, "a bracket is not closed");
  const auto [first, last, count] = three_numbers(all, text.substr(open + 1, close - open - 1), by_factor);
  const std::string unit = trimmed(text.substr(close + 1));
  std::vector<std::string> values;
  for (double k = 0; k < count; ++k) {
    const double x = k + 1 == count ? last : (by_factor ? in_logrange : in_range)(first, last, count, k);
    values.push_back(fmt::format("{}{}{}", x, unit.empty() ? "" : " ", unit));
  }
  return values;
}

/// What stands behind =: of each value the parts, one for each key.
std::vector<std::vector<std::string>> values_of(const std::string& all, const std::string& text,
                                                std::size_t keys) {
  std::vector<std::vector<std::string>> values;
  for (const std::string& value : parts_of(text, ','))
    values.push_back(keys == 1 ? std::vector{value} : parts_of(value, ':'));
  for (const auto& parts : values)
    if (values.size() > 1 && std::any_of(parts.begin(), parts.end(), is_range))
      refuse(all, "a range stands in place of all values of a key");
    else if (parts.size() != keys)
      refuse(all, fmt::format("{} keys go together, and one of the values has {} parts", keys, parts.size()));
  std::vector<std::vector<std::string>> ranges;
  if (values.size() == 1)
    for (const std::string& part : values.front())
      if (auto range = range_of(all, part); !range.empty()) ranges.push_back(std::move(range));
  if (ranges.empty()) return values;
  for (const auto& range : ranges)
    if (ranges.size() != keys || range.size() != ranges.front().size())
      refuse(all, "keys that go together take ranges of one count, or values");
  values.assign(ranges.front().size(), {});
  for (std::size_t k = 0; k < values.size(); ++k)
    for (const auto& range : ranges) values[k].push_back(range[k]);
  return values;
}

}  // namespace

SweptKeys swept_keys(const std::string& text) {
  if (text.find_first_of("\r\n") != std::string::npos) refuse(text, "there is a line break");
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0) refuse(text, "no value is given");
  SweptKeys swept{parts_of(text.substr(0, at), ','), {}};
  for (const std::string& key : swept.keys)
    if (key.empty()) refuse(text, "a name of a key is missing");
  swept.values = values_of(text, text.substr(at + 1), swept.keys.size());
  for (const auto& parts : swept.values)
    for (const std::string& value : parts)
      if (value.empty()) refuse(text, "a value is empty");
  return swept;
}

std::vector<std::vector<std::string>> points_of(const std::vector<SweptKeys>& all) {
  double count = 1;
  for (const SweptKeys& swept : all) count *= static_cast<double>(swept.values.size());
  if (count > most_points)
    throw std::invalid_argument(
        fmt::format("a sweep has at most {} points, and this one has {}", most_points, count));
  std::vector<std::vector<std::string>> points(1);
  for (const SweptKeys& swept : all) {
    std::vector<std::vector<std::string>> more;
    for (const auto& point : points)
      for (const auto& values : swept.values) {
        more.push_back(point);
        for (std::size_t j = 0; j < values.size(); ++j)
          more.back().push_back(swept.keys[j] + "=" + values[j]);
      }
    points = std::move(more);
  }
  return points;
}

}  // namespace vbond::app
