#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "sweep.hpp"

namespace vbond::app {
namespace {

[[noreturn]] void refuse(const std::string& text, const std::string& rule) {
  throw std::invalid_argument(
      "--set " + text + ": " + rule +
      "\n  write KEY=a,b,c or KEY=range(first, last, count) or KEY=logrange(first, last, count)");
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// The parts of a text between commas that stand in no brackets or quotes.
std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0)
      quote = c == quote ? '\0' : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '[' || c == '{' || c == '(')
      ++depth;
    else if (c == ']' || c == '}' || c == ')')
      --depth;
    else if (c == ',' && depth == 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
  }
  for (std::string& part : parts) part = trimmed(part);
  return parts;
}

/// The values of range(...) or logrange(...), which begins the text, or nothing.
std::vector<std::string> range_of(const std::string& all, const std::string& text) {
  const bool by_factor = text.starts_with("logrange(");
  if (!by_factor && !text.starts_with("range(")) return {};
  const std::size_t open = text.find('('), close = text.find(')');
  if (close == std::string::npos) refuse(all, "a bracket is not closed");
  const std::vector<std::string> words = parts_of(text.substr(open + 1, close - open - 1));
  const std::string unit = trimmed(text.substr(close + 1));
  double number[3] = {};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t end = 0;
    try {
      if (words.size() == 3) number[k] = std::stod(words[k], &end);
    } catch (const std::exception&) {
    }
    if (end == 0 || end != words[k].size() || !std::isfinite(number[k]))
      refuse(all, "a range has three numbers");
  }
  const auto [first, last, count] = number;
  if (count < 2 || count > 1e6 || count != std::floor(count))
    refuse(all, "the count must be a whole number from 2 on");
  if (by_factor && !(first > 0.0 && last > 0.0)) refuse(all, "both ends of a logrange must be > 0");
  std::vector<std::string> values;
  for (int k = 0; k < static_cast<int>(count); ++k) {
    const double x = by_factor ? first * std::pow(last / first, k / (count - 1))
                               : first + k * (last - first) / (count - 1);  // whole numbers stay whole
    values.push_back(
        fmt::format("{}{}{}", k + 1 == static_cast<int>(count) ? last : x, unit.empty() ? "" : " ", unit));
  }
  return values;
}

}  // namespace

SweptKey swept_key(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0) refuse(text, "no value is given");
  SweptKey swept{text.substr(0, at), range_of(text, trimmed(text.substr(at + 1)))};
  if (swept.values.empty()) swept.values = parts_of(text.substr(at + 1));
  for (const std::string& value : swept.values)
    if (value.empty()) refuse(text, "a value is empty");
  return swept;
}

std::vector<std::vector<std::string>> points_of(const std::vector<SweptKey>& keys) {
  std::vector<std::vector<std::string>> points(1);
  for (const SweptKey& swept : keys) {
    std::vector<std::vector<std::string>> more;
    for (const auto& point : points)
      for (const std::string& value : swept.values) {
        more.push_back(point);
        more.back().push_back(swept.key + "=" + value);
      }
    points = std::move(more);
  }
  return points;
}

}  // namespace vbond::app
