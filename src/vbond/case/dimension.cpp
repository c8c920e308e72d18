#include "vbond/case/dimension.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <system_error>

namespace vbond::keys {
namespace {

constexpr std::size_t longest_text = 200;  // bounds the powers, so that nothing below overflows
constexpr int largest_power = 12;

/// A unit as factor * 10^exponent of the base unit: keeps decimal prefixes exact.
struct Unit {
  const char* name;
  double factor;
  int exponent;
  Dimension dimension;
  bool takes_prefix;
};

constexpr std::array units{
    Unit{"m", 1, 0, {1, 0, 0}, true},
    Unit{"g", 1, -3, {0, 1, 0}, true},
    Unit{"s", 1, 0, {0, 0, 1}, true},
    Unit{"N", 1, 0, {1, 1, -2}, true},
    Unit{"Pa", 1, 0, {-1, 1, -2}, true},
    Unit{"J", 1, 0, {2, 1, -2}, true},
    Unit{"W", 1, 0, {2, 1, -3}, true},
    Unit{"Hz", 1, 0, {0, 0, -1}, true},
    Unit{"rad", 1, 0, {0, 0, 0, 1}, false},
    Unit{"deg", std::numbers::pi / 180.0, 0, {0, 0, 0, 1}, false},
    Unit{"rev", 2.0 * std::numbers::pi, 0, {0, 0, 0, 1}, false},
    Unit{"min", 60, 0, {0, 0, 1}, false},
    Unit{"h", 3600, 0, {0, 0, 1}, false},
    Unit{"angstrom", 1, -10, {1, 0, 0}, false},
    Unit{"eV", 1.602176634, -19, {2, 1, -2}, true},  // exact since the SI of 2019
    Unit{"1", 1, 0, {0, 0, 0}, false},
    Unit{"%", 1, -2, {0, 0, 0}, false},
};

struct Prefix {
  std::string_view name;
  int exponent;
};

constexpr std::array prefixes{
    Prefix{"a", -18}, Prefix{"f", -15}, Prefix{"p", -12},       Prefix{"n", -9},        Prefix{"u", -6},
    Prefix{"m", -3},  Prefix{"c", -2},  Prefix{"\xC2\xB5", -6}, Prefix{"\xCE\xBC", -6}, Prefix{"d", -1},
    Prefix{"da", 1},  Prefix{"h", 2},   Prefix{"k", 3},         Prefix{"M", 6},         Prefix{"G", 9},
    Prefix{"T", 12},  Prefix{"P", 15},
};

/// Exact names come first: "min" is a minute, "Pa" a pascal.
std::optional<Unit> find_unit(std::string_view name) {
  for (const Unit& u : units)
    if (name == u.name) return u;
  for (const Prefix& p : prefixes)
    for (const Unit& u : units)
      if (u.takes_prefix && name.size() > p.name.size() && name.substr(0, p.name.size()) == p.name &&
          name.substr(p.name.size()) == u.name)
        return Unit{u.name, u.factor, u.exponent + p.exponent, u.dimension, false};
  return std::nullopt;
}

std::string_view trim(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

UnitMistake no_such_unit(std::string_view name) {
  for (const char* of_temperature : {"K", "C", "degC",
                                     "\xC2\xB0"
                                     "C",
                                     "\xE2\x84\x83", "kelvin", "celsius"})
    if (name == of_temperature)
      return {"\"" + std::string(name) + "\" is not a unit: temperatures have none here",
              "write bare numbers in degrees of one kind, as in change = 15 and expansion = 1.2e-5"};
  return {"\"" + std::string(name) + "\" is not a unit",
          "units are m, g, s, N, Pa, J, W, Hz, eV with SI prefixes, and rad, deg, rev, min, h, angstrom, %; "
          "join them "
          "with * and /, raise with ^, as in \"7800 kg/m^3\""};
}

/// name or name^power
std::variant<Unit, UnitMistake> parse_factor(std::string_view factor) {
  int power = 1;
  std::string_view name = trim(factor);
  if (const auto hat = name.find('^'); hat != std::string_view::npos) {
    const std::string_view digits = trim(name.substr(hat + 1));
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
    if (error != std::errc{} || end != digits.data() + digits.size() || std::abs(power) > largest_power)
      return UnitMistake{"the power of a unit must be a whole number from -12 to 12",
                         "write for example \"7800 kg/m^3\""};
    name = trim(name.substr(0, hat));
  }
  const std::optional<Unit> found = find_unit(name);
  if (!found) return no_such_unit(name);
  const Dimension& d = found->dimension;
  return Unit{found->name,
              std::pow(found->factor, power),
              found->exponent * power,
              {d.length * power, d.mass * power, d.time * power, d.angle * power},
              false};
}

std::variant<Unit, UnitMistake> parse_unit(std::string_view text) {
  Unit total{"", 1, 0, {}, false};
  for (int sign = 1; true;) {
    const auto end = text.find_first_of("*/");
    auto factor = parse_factor(text.substr(0, end));
    if (const auto* mistake = std::get_if<UnitMistake>(&factor)) return *mistake;
    const Unit& u = std::get<Unit>(factor);
    total.factor *= sign > 0 ? u.factor : 1.0 / u.factor;
    total.exponent += sign * u.exponent;
    total.dimension.length += sign * u.dimension.length;
    total.dimension.mass += sign * u.dimension.mass;
    total.dimension.time += sign * u.dimension.time;
    total.dimension.angle += sign * u.dimension.angle;
    if (end == std::string_view::npos) return total;
    sign = text[end] == '*' ? 1 : -1;
    text.remove_prefix(end + 1);
  }
}

/// The decimal number `digits` (already known to be one) times 10^exponent, rounded once.
std::optional<double> scaled(std::string_view digits, int exponent) {
  const auto e = digits.find_first_of("eE");
  int own = 0;
  if (e != std::string_view::npos) {
    std::string_view power = digits.substr(e + 1);
    if (!power.empty() && power.front() == '+') power.remove_prefix(1);
    if (std::from_chars(power.data(), power.data() + power.size(), own).ec != std::errc{} ||
        std::abs(own) > 10000)
      return std::nullopt;
  }
  const std::string text = std::string(digits.substr(0, e)) + "e" + std::to_string(own + exponent);
  double value = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc{}) return std::nullopt;
  return value;
}

}  // namespace

std::variant<Quantity, UnitMistake> parse_quantity(std::string_view text) {
  const UnitMistake no_number{"must be a number, or a number and its unit",
                              "write for example 0.5 or \"0.5 mm\""};
  text = trim(text);
  if (text.size() > longest_text) return no_number;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  if (text.find_first_of("0123456789") > 2)
    return no_number;  // leaves "inf" and "nan" out: "-.5" is the longest start
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc::invalid_argument) return no_number;
  const std::string_view digits(text.data(), static_cast<std::size_t>(end - text.data()));
  const std::string_view unit_text = trim(text.substr(digits.size()));

  const UnitMistake too_large{"must be a number that fits into double precision", "choose another unit"};
  if (unit_text == "T0" || unit_text == "T_0" || unit_text.empty()) {
    if (error != std::errc{} || !std::isfinite(number)) return too_large;
    return Quantity{number, unit_text.empty() ? Dimension{} : Dimension{0, 0, 1}, !unit_text.empty(),
                    !unit_text.empty()};
  }
  const auto unit = parse_unit(unit_text);
  if (const auto* mistake = std::get_if<UnitMistake>(&unit)) return *mistake;
  const Unit& u = std::get<Unit>(unit);
  const std::optional<double> value = scaled(digits, u.exponent);
  if (!value || !std::isfinite(*value * u.factor)) return too_large;
  return Quantity{*value * u.factor, u.dimension, false, true};
}

std::string to_text(const Dimension& d) {
  const std::array known{length, area,   mass,   density,   duration, velocity,         acceleration,
                         force,  moment, stress, stiffness, angle,    angular_velocity, frequency};
  std::string text;
  const auto add = [&text](const char* base, int power) {
    if (power == 0) return;
    if (!text.empty()) text += ' ';
    text += base;
    if (power != 1) text += "^" + std::to_string(power);
  };
  add("kg", d.mass);
  add("m", d.length);
  add("s", d.time);
  add("rad", d.angle);
  if (text.empty()) return "number without a unit";
  for (const Dimension& k : known)
    if (k == d) return std::string(k.name) + " (" + text + ")";
  return text;
}

}  // namespace vbond::keys
