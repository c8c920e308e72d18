#include "vbond/case/value.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "vbond/case/value_lists.hpp"

namespace vbond::keys {
namespace {

std::string with_article(const std::string& noun) {
  return (std::string("aeiou").find(noun[0]) == std::string::npos ? "a " : "an ") + noun;
}

/// The unit string `text` for a value of dimension d, or nothing after a report.
std::optional<Quantity> read_quantity(const std::string& text, const Dimension& d, const Node& n,
                                      ReadContext& in, const std::string& path, const std::string& example) {
  const bool is_time = d == duration;
  const auto refuse = [&](std::string rule, std::string way_out) -> std::optional<Quantity> {
    in.refuse(n, path, std::move(rule), std::move(way_out));
    return std::nullopt;
  };
  const auto parsed = parse_quantity(text);
  const auto* q = std::get_if<Quantity>(&parsed);
  if (!in.any_units && in.units == UnitSystem::reduced && !(q && q->in_T_0 && is_time))
    return refuse(is_time
                      ? "in reduced units (a = m = c_A = 1) a time is a bare number or a multiple of T0"
                      : "in reduced units (a = m = c_A = 1) a number stands bare, without quotes and unit",
                  "write " + last_name(path) + (is_time ? " = \"10 T0\"" : " = 1.0") +
                      ", or choose [units] system = \"SI\"");
  if (const auto* mistake = std::get_if<UnitMistake>(&parsed)) return refuse(mistake->rule, mistake->way_out);
  if (!fits(q->dimension, d) || (q->in_T_0 && !is_time))
    return refuse("must be " + with_article(to_text(d)) + "; this is " +
                      (q->in_T_0 ? "a multiple of T0" : with_article(to_text(q->dimension))),
                  d == angular_velocity
                      ? "say what turns, in rad/s, deg/s or rev/s: " + such_as(path, "\"10 rev/s\"")
                      : such_as(path, example));
  return *q;
}

bool check_range(const Range& range, double x, const Node& n, ReadContext& in, const std::string& path,
                 const std::string& example) {
  if (!std::isfinite(x) || std::abs(x) > largest_number)
    return in.refuse(n, path, "must be a finite number, at most 1e60 in size", such_as(path, example));
  if (range.contains(x)) return true;
  return in.refuse(n, path, range.rule(last_name(path)), such_as(path, example));
}

/// A number or, if `quantity` takes strings, one with its unit.
bool read_number(const Node& n, const Dimension& d, ReadContext& in, const std::string& path,
                 const std::string& type, const std::string& example, double& x, bool* in_T_0 = nullptr) {
  if (const auto* i = std::get_if<std::int64_t>(&n.value)) {
    x = static_cast<double>(*i);
  } else if (const auto* f = std::get_if<double>(&n.value)) {
    x = *f;
  } else if (const auto* s = std::get_if<std::string>(&n.value)) {
    const std::optional<Quantity> q = read_quantity(*s, d, n, in, path, example);
    if (!q) return false;
    x = q->value;
    if (in_T_0) *in_T_0 = q->in_T_0;
  } else {
    return in.refuse_kind(n, path, type, example);
  }
  return true;
}

}  // namespace

bool ReadContext::refuse_kind(const Node& n, const std::string& path, const std::string& type,
                              const std::string& example) {
  return refuse(n, path, std::string("must be: ") + type + "; this is " + kind_name(n),
                such_as(path, example));
}

std::string last_name(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? path : path.substr(dot + 1);
}

std::string such_as(const std::string& path, const std::string& example) {
  if (path.back() == ']') return "write for example " + example + " there";
  return "write for example " + last_name(path) + " = " + example;
}

std::string any_of(const std::vector<std::string>& schemas) {
  return fmt::format(R"({{"anyOf": [{}]}})", fmt::join(schemas, ", "));
}

std::string list_schema(const std::string& element, std::size_t min, std::size_t max) {
  std::string text = fmt::format(R"({{"type": "array", "items": {}, "minItems": {})", element, min);
  if (max != SIZE_MAX) text += fmt::format(R"(, "maxItems": {})", max);
  return text + '}';
}

std::string enum_schema(const std::vector<std::string>& words) {
  return fmt::format(R"({{"enum": [{}]}})", join(words, "\""));
}

// An open bound as a number that is not allowed: exclusiveMinimum is not the same in all drafts of JSON
// Schema.
std::string Range::schema() const {
  std::string number = R"({"type": "number")";
  if (min > -largest_number) number += fmt::format(R"(, "minimum": {})", min);
  if (max < largest_number) number += fmt::format(R"(, "maximum": {})", max);
  if (min_open || max_open)
    number += fmt::format(R"(, "not": {{"enum": [{}]}})", min_open && max_open
                                                              ? fmt::format("{}, {}", min, max)
                                                              : fmt::format("{}", min_open ? min : max));
  return any_of({number + '}', R"({"type": "string", "pattern": "^ *[-+]?[0-9.]"})"});
}

std::string CountCodec::schema() const {
  return fmt::format(R"({{"type": "integer", "minimum": {}, "maximum": {}}})", min, max);
}

std::string Range::rule(const std::string& name) const {
  const bool low = min > -largest_number, high = max < largest_number;
  std::string text = "must satisfy ";
  if (low) text += fmt::format("{}{}", min, min_open ? " < " : " <= ");
  text += name;
  if (high) text += fmt::format("{}{}", max_open ? " < " : " <= ", max);
  return text;
}

std::string Range::text() const {
  std::string t;
  if (min > -largest_number) t = fmt::format("{}{}", min_open ? "> " : ">= ", min);
  if (max < largest_number) t += fmt::format("{}{}{}", t.empty() ? "" : ", ", max_open ? "< " : "<= ", max);
  return t;
}

bool NumberCodec::read(const Node& n, ReadContext& in, const std::string& path, double& out) const {
  double x = 0;
  // before it is read it has its default, which is of a better size than 1
  const bool has_default = dimension == pure && out != 0.0 && range.contains(out);
  const std::string such_as_this = has_default ? number_text(out) : example(in.units);
  if (!read_number(n, dimension, in, path, type(), such_as_this, x)) return false;
  if (!check_range(range, x, n, in, path, such_as_this)) return false;
  out = x;
  return true;
}

std::string NumberCodec::type() const {
  const std::string rule = range.text();
  return rule.empty() ? dimension.name : std::string(dimension.name) + " " + rule;
}

std::string NumberCodec::example(UnitSystem u) const {
  if (*sample != '\0') return sample;
  if (u == UnitSystem::si && !(dimension == pure)) return toml_string(dimension.example);
  const double x = range.contains(1.0)         ? 1.0
                   : range.contains(range.max) ? range.max
                                               : 0.5 * (range.min + range.max);
  return number_text(x);
}

bool CountCodec::read(const Node& n, ReadContext& in, const std::string& path, std::int64_t& out) const {
  const auto* i = std::get_if<std::int64_t>(&n.value);
  if (!i) return in.refuse_kind(n, path, type() + ", without a decimal point or quotes", example(in.units));
  if (*i < min || *i > max) {
    std::string rule = "must satisfy " + std::to_string(min) + " <= " + last_name(path);
    if (max != INT64_MAX) rule += " <= " + std::to_string(max);
    return in.refuse(n, path, rule, such_as(path, example(in.units)));
  }
  out = *i;
  return true;
}

std::string CountCodec::type() const {
  return "whole number >= " + std::to_string(min);
}

bool FlagCodec::read(const Node& n, ReadContext& in, const std::string& path, bool& out) const {
  const auto* b = std::get_if<bool>(&n.value);
  if (!b) return in.refuse_kind(n, path, type() + ", without quotes", example(in.units));
  out = *b;
  return true;
}

bool UnitCodec::read(const Node& n, ReadContext& in, const std::string& path, ColumnUnit& out) const {
  const auto* text = std::get_if<std::string>(&n.value);
  if (!text) return in.refuse_kind(n, path, "a unit between quotes", example(in.units));
  if (!in.any_units && in.units == UnitSystem::reduced)
    return in.refuse(n, path, "in reduced units (a = m = c_A = 1) columns have no units",
                     "remove it and use scale, or choose [units] system = \"SI\"");
  const auto quantity = read_quantity("1 " + *text, dimension, n, in, path, example(in.units));
  if (!quantity) return false;
  out = {*text, quantity->value};
  return true;
}

std::string UnitCodec::example(UnitSystem) const {
  const std::string quantity = dimension.example;  // a number, a blank, a unit
  const auto blank = quantity.find(' ');
  return toml_string(blank == std::string::npos ? "" : quantity.substr(blank + 1));
}

bool TextCodec::read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const {
  const auto* s = std::get_if<std::string>(&n.value);
  if (!s) return in.refuse_kind(n, path, "text between quotes", example(in.units));
  out = *s;
  return true;
}

bool only_digits(std::string_view s) {
  return s.find_first_not_of("0123456789") == std::string_view::npos;
}

bool NameCodec::read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const {
  std::string name;
  if (!TextCodec::read(n, in, path, name)) return false;
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  if (only_digits(name) || name.size() > 64 || !std::all_of(name.begin(), name.end(), allowed))
    return in.refuse(n, path,
                     "a name must have 1 to 64 letters (a-z, A-Z), digits, _ or -, and not only digits",
                     such_as(path, "\"left_end\""));
  out = name;
  return true;
}

bool ReferenceCodec::read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const {
  std::string name;
  if (!TextCodec::read(n, in, path, name)) return false;
  if (name.empty())
    return in.refuse(n, path, std::string("must name a ") + to, "write the name between the quotes");
  out = name;
  return true;
}

bool ParticlesCodec::read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const {
  if (const auto* s = std::get_if<std::string>(&n.value); s && only_digits(*s))
    return in.refuse(n, path, "a particle is named by its bare number",
                     "write it without quotes and leading zeros");
  if (!std::holds_alternative<std::int64_t>(n.value)) return ReferenceCodec::read(n, in, path, out);
  std::int64_t number = 0;
  if (!particle_number.read(n, in, path, number)) return false;
  out = std::to_string(number);
  return true;
}

std::string ParticlesCodec::write(const std::string& x) const {
  return only_digits(x) ? x : toml_string(x);
}

bool FileCodec::read(const Node& n, ReadContext& in, const std::string& path,
                     std::filesystem::path& out) const {
  const auto* s = std::get_if<std::string>(&n.value);
  if (!s) return in.refuse_kind(n, path, type(), example(in.units));
  if (s->empty() || s->find('\0') != std::string::npos)
    return in.refuse(n, path, "must be a file name", such_as(path, example(in.units)));
  const std::filesystem::path given(*s);
  out = given.is_absolute() ? given : (in.folder / given).lexically_normal();
  return true;
}

bool read_word(const Node& n, ReadContext& in, const std::string& path, const std::vector<std::string>& names,
               std::size_t& index) {
  const auto* s = std::get_if<std::string>(&n.value);
  if (!s) return in.refuse_kind(n, path, "one of " + join(names, "\""), toml_string(names.front()));
  const auto found = std::find(names.begin(), names.end(), *s);
  if (found == names.end()) {
    const auto meant = meant_name(*s, names);
    return in.refuse(n, path, "must be one of " + join(names, "\""),
                     !meant ? "choose one of these" : "did you mean \"" + *meant + "\"?");
  }
  index = static_cast<std::size_t>(found - names.begin());
  return true;
}

bool refuse_subset(const Node& n, ReadContext& in, const std::string& path,
                   const std::vector<std::string>& names) {
  const std::string all = "[" + join(names, "\"") + "]";
  const auto* word = std::get_if<std::string>(&n.value);
  const bool known = word && std::find(names.begin(), names.end(), *word) != names.end();
  return in.refuse(
      n, path, "must be a list of " + join(names, "\"") + "; this is " + kind_name(n),
      "write " + last_name(path) + " = " +
          (known ? "[\"" + *word + "\"]" : all + (word && *word == "all" ? "" : ", or some of these")));
}

bool refuse_length(const Node& n, ReadContext& in, const std::string& path, std::size_t is,
                   std::size_t wanted, const std::string& example) {
  return in.refuse(n, path,
                   "must have " + std::to_string(wanted) + " elements; this has " + std::to_string(is),
                   such_as(path, example));
}

bool VectorCodec::read(const Node& n, ReadContext& in, const std::string& path, Vec3d& out) const {
  std::array<double, 3> x{};
  const auto* items = std::get_if<NodeList>(&n.value);
  if (!items) return in.refuse_kind(n, path, type(), example(in.units));
  if (items->size() != 3) return refuse_length(n, in, path, items->size(), 3, example(in.units));
  if (!TupleCodec<NumberCodec, 3>{number(dimension)}.read(n, in, path, x)) return false;
  const Vec3d v{x[0], x[1], x[2]};
  if (!may_be_zero && !(norm(v) > 1.0 / largest_number))
    return in.refuse(n, path, "must not be the zero vector: it is a direction",
                     "write for example " + last_name(path) + " = [0, 0, 1]; its length does not matter");
  out = v;
  return true;
}

std::string VectorCodec::write(const Vec3d& v) const {
  return "[" + number_text(v.x) + ", " + number_text(v.y) + ", " + number_text(v.z) + "]";
}

std::string VectorCodec::type() const {
  return may_be_zero ? std::string("3 x ") + dimension.name : "3 x number, not all zero";
}

std::string VectorCodec::example(UnitSystem u) const {
  const std::string one =
      u == UnitSystem::si && !(dimension == pure) ? toml_string(dimension.example) : "1.0";
  return may_be_zero ? "[0, 0, " + one + "]" : "[1, 0, 0]";
}

bool TimeCodec::read(const Node& n, ReadContext& in, const std::string& path, CaseTime& out) const {
  CaseTime t;
  if (!read_number(n, duration, in, path, type(), example(in.units), t.value, &t.in_T_0)) return false;
  if (!check_range(range, t.value, n, in, path, example(in.units))) return false;
  out = t;
  return true;
}

std::string TimeCodec::write(const CaseTime& t) const {
  return t.in_T_0 ? "\"" + number_text(t.value) + " T0\"" : number_text(t.value);
}

std::string TimeCodec::type() const {
  return "time " + range.text() + ", or \"10 T0\"";
}

}  // namespace vbond::keys
