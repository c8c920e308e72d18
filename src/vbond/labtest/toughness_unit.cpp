#include "vbond/labtest/toughness_unit.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace vbond::labtest {
namespace {

constexpr std::string_view blanks = " \t";

std::string_view without_blanks_behind(std::string_view text) {
  const auto last = text.find_last_not_of(blanks);
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

/// The text before `end`, if it ends so.
std::optional<std::string_view> before(std::string_view text, std::string_view end) {
  if (!text.ends_with(end)) return std::nullopt;
  return text.substr(0, text.size() - end.size());
}

/// In base units, if it is a quantity of this dimension.
std::optional<double> quantity(std::string_view text, const keys::Dimension& dimension) {
  const auto parsed = keys::parse_quantity(text);
  const auto* q = std::get_if<keys::Quantity>(&parsed);
  if (q == nullptr || !q->has_unit || q->in_T_0 || !keys::fits(q->dimension, dimension)) return std::nullopt;
  return q->value;
}

/// "1.5 MPa*sqrt(m)" as "1.5 MPa" and "m"; nothing if no root stands at the end.
std::optional<std::pair<std::string_view, std::string_view>> cut_root(std::string_view text) {
  for (const std::string_view power : {"^0.5", "^(1/2)", "^.5"})
    if (const auto rest = before(text, power)) {
      const auto at = rest->find_last_of(" \t*");
      if (at == std::string_view::npos) return std::nullopt;
      return std::pair{rest->substr(0, at), rest->substr(at + 1)};
    }
  constexpr std::string_view root = "sqrt(";
  const auto at = text.rfind(root);
  if (at == std::string_view::npos || !text.ends_with(")")) return std::nullopt;
  const auto begin = at + root.size();
  return std::pair{text.substr(0, at), text.substr(begin, text.size() - begin - 1)};
}

}  // namespace

std::variant<double, keys::UnitMistake> parse_toughness(std::string_view text) {
  const keys::UnitMistake mistake{
      "must be a fracture toughness, a stress times the root of a length",
      "write for example \"1.5 MPa m^0.5\", \"1.5 MPa*sqrt(m)\" or \"1.5e6 N/m^1.5\""};
  text = without_blanks_behind(text);
  std::optional<double> value;
  if (const auto force = before(text, "/m^1.5")) {
    value = quantity(*force, keys::force);
  } else if (const auto cut = cut_root(text)) {
    std::string_view stress = without_blanks_behind(cut->first);
    if (stress.ends_with("*")) stress = without_blanks_behind(stress.substr(0, stress.size() - 1));
    const auto s = quantity(stress, keys::stress),
               l = quantity("1 " + std::string(cut->second), keys::length);
    if (s && l) value = *s * std::sqrt(*l);
  } else {
    const auto parsed = keys::parse_quantity(text);
    if (const auto* q = std::get_if<keys::Quantity>(&parsed); q != nullptr && !q->has_unit) value = q->value;
  }
  if (!value || !std::isfinite(*value)) return mistake;
  return *value;
}

}  // namespace vbond::labtest
