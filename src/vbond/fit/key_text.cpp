#include "vbond/fit/key_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>

#include "vbond/case/change.hpp"
#include "vbond/case/dimension.hpp"
#include "vbond/case/find_key.hpp"
#include "vbond/case/node.hpp"

namespace vbond::fit {
namespace {

using keys::Node;

/// Where a line and column of the parser, which counts characters, lie in the bytes of the text.
std::size_t offset_of(std::string_view text, std::uint32_t line, std::uint32_t column) {
  std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (std::uint32_t k = 1; k < line; ++k) at = text.find('\n', at) + 1;
  for (std::uint32_t k = 1; k < column && at < text.size(); ++k) {
    ++at;
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) ++at;
  }
  return at;
}

/// Past a text in quotes that begins here and ends on its line.
std::size_t behind_quotes(std::string_view text, std::size_t at) {
  const char quote = text[at];
  for (++at; at < text.size() && text[at] != quote; ++at)
    if (quote == '"' && text[at] == '\\') ++at;
  return at + 1;
}

/// The value behind the key that stands at `at`, or the one that stands there itself.
void find_value(std::string_view text, std::size_t at, bool behind_key, NumberInText& to) {
  if (behind_key) {
    while (at < text.size() && text[at] != '=')
      at = text[at] == '"' || text[at] == '\'' ? behind_quotes(text, at) : at + 1;
    at = text.find_first_not_of(" \t", at + 1);
  }
  to.begin = at;
  to.end = text[at] == '"' || text[at] == '\'' ? behind_quotes(text, at)
                                               : std::min(text.find_first_of(" \t\r\n,]}#", at), text.size());
}

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string_view::npos ? std::string() : std::string(text.substr(first, last - first + 1));
}

/// The unit behind a number: "GPa" of "2 GPa".
std::string unit_in(std::string_view quantity) {
  const std::size_t number_ends = quantity.find_first_not_of("+-0123456789._eE");
  std::string_view unit = number_ends == std::string_view::npos ? "" : quantity.substr(number_ends);
  return trimmed(unit);
}

/// A number, with its unit if it has one; false if it is none.
bool read(const Node& node, NumberInText& to) {
  if (const auto* whole = std::get_if<std::int64_t>(&node.value)) {
    to.value = static_cast<double>(*whole);
  } else if (const auto* real = std::get_if<double>(&node.value)) {
    to.value = *real;
  } else if (const auto* words = std::get_if<std::string>(&node.value)) {
    const auto quantity = keys::parse_quantity(*words);
    if (std::holds_alternative<keys::UnitMistake>(quantity)) return false;
    to.unit = unit_in(*words);
    const auto bare = keys::parse_quantity(trimmed(words->substr(0, words->rfind(to.unit))));
    if (std::holds_alternative<keys::UnitMistake>(bare)) return false;
    to.value = std::get<keys::Quantity>(bare).value;
  } else {
    return false;
  }
  return std::isfinite(to.value);
}

}  // namespace

std::string NumberInText::toml(double number) const {
  const std::string text = keys::number_text(number);
  return unit.empty() ? text : keys::toml_string(text + ' ' + unit);
}

NumberInText number_in(std::string_view text, const std::string& file, const std::string& path,
                       const std::string& option) {
  keys::NodeTable root = keys::parse_toml(text, file);
  const keys::FoundKey found = keys::find_key(path, root, option);
  NumberInText number;
  number.place = {file, found.node->line, found.node->column};
  if (!read(*found.node, number))
    throw CaseError(Problem{number.place, path + " = " + short_text(*found.node),
                            option + " varies a key that is one number, with or without a unit",
                            "name a number; of a list one of its items, as in force[1]"});
  find_value(text, offset_of(text, found.node->line, found.node->column), !found.in_list, number);
  return number;
}

double in_unit_of(const NumberInText& number, std::string_view text, const std::string& option) {
  const auto refuse = [&](const std::string& rule, const std::string& way_out) {
    throw CaseError(Problem{{option, 0, 0}, trimmed(text), rule, way_out});
  };
  const auto quantity = keys::parse_quantity(trimmed(text));
  if (const auto* mistake = std::get_if<keys::UnitMistake>(&quantity))
    refuse(mistake->rule, mistake->way_out);
  const keys::Quantity bound = std::get<keys::Quantity>(quantity);
  const std::string unit = unit_in(trimmed(text));
  if (unit == number.unit || unit.empty()) {
    NumberInText alone;
    Node node;
    node.value = trimmed(text);
    read(node, alone);
    return alone.value;
  }
  if (number.unit.empty())
    refuse("the case gives this key without a unit", "give the bound without a unit, as the case does");
  const keys::Quantity one = std::get<keys::Quantity>(keys::parse_quantity("1 " + number.unit));
  if (!(bound.dimension == one.dimension) || bound.in_T_0 != one.in_T_0)
    refuse("the case gives this key in " + number.unit + ", of another dimension than " + unit,
           "give the bound in " + number.unit);
  return bound.value / one.value;
}

}  // namespace vbond::fit
