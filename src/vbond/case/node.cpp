#include "vbond/case/node.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "vbond/core/error.hpp"

namespace vbond::keys {
namespace {

constexpr std::size_t largest_file = std::size_t{16} << 20;
constexpr int deepest = 32;

[[noreturn]] void refuse(const std::string& file, std::uint32_t line, std::uint32_t column, std::string what,
                         std::string rule, std::string way_out) {
  throw CaseError(Problem{{file, line, column}, std::move(what), std::move(rule), std::move(way_out)});
}

/// The last character of the string that starts at `i`, which may be the end of its line if it is not closed.
std::size_t end_of_string(std::string_view text, std::size_t i) {
  const char quote = text[i];
  const std::string three(3, quote);
  const bool multi = text.compare(i, 3, three) == 0;
  for (i += multi ? 3 : 1; i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\' && i + 1 < text.size() && text[i + 1] != '\n') {
      ++i;
    } else if (text[i] == '\n' && !multi) {
      return i - 1;
    } else if (multi && text.compare(i, 3, three) == 0) {
      i += 2;
      for (int own = 0; own < 2 && i + 1 < text.size() && text[i + 1] == quote; ++own)
        ++i;  // the text may end with two quotes of its own, so that five stand in a row
      return i;
    } else if (text[i] == quote && !multi) {
      return i;
    }
  }
  return text.size();
}

[[noreturn]] void refuse_nesting(std::string_view text, std::size_t i, const std::string& file) {
  const std::string_view before = text.substr(0, i);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1;  // 0 on the first line, where npos wraps around
  refuse(file, static_cast<std::uint32_t>(line), static_cast<std::uint32_t>(i - line_start + 1),
         "nesting deeper than 32", "tables, arrays and dotted keys may be nested 32 deep",
         "close a bracket; no key needs more than 5 levels");
}

/// The parser and the tree recurse with the nesting of the text, by brackets and by the dots of keys; a
/// hostile text must not exhaust the stack. Walks over the text, past strings and comments, and counts both.
void limit_nesting(std::string_view text, const std::string& file) {
  int brackets = 0, dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    switch (text[i]) {
      case '#': i = std::min(text.find('\n', i), text.size()) - 1; break;
      case '"':
      case '\'': i = end_of_string(text, i); break;
      case '.': ++dots; break;
      case '[':
      case '{': ++brackets, dots = 0; break;
      case ']':
      case '}': brackets = std::max(0, brackets - 1), dots = 0; break;
      case ',':
      case '=':
      case '\n': dots = 0; break;
      default: break;
    }
    if (brackets > deepest || dots > deepest) refuse_nesting(text, i, file);
  }
}

Node to_node(const toml::node& from) {
  Node to;
  to.line = from.source().begin.line;
  to.column = from.source().begin.column;
  if (const auto* b = from.as_boolean()) {
    to.value = b->get();
  } else if (const auto* i = from.as_integer()) {
    to.value = std::int64_t{i->get()};
  } else if (const auto* d = from.as_floating_point()) {
    to.value = d->get();
  } else if (const auto* s = from.as_string()) {
    to.value = s->get();
  } else if (const auto* list = from.as_array()) {
    NodeList items;
    items.reserve(list->size());
    for (const toml::node& item : *list) items.push_back(to_node(item));
    to.value = std::move(items);
  } else if (const auto* table = from.as_table()) {
    NodeTable members;
    for (const auto& [key, value] : *table) {
      const auto at = key.source().begin;
      Member m{std::string(key.str()), at.line, at.column, to_node(value)};
      // a value is pointed at by its key, a table with a header by that
      if (!value.is_table() || value.as_table()->is_inline())
        m.value.line = at.line, m.value.column = at.column;
      members.push_back(std::move(m));
    }
    std::sort(members.begin(), members.end(), [](const Member& one, const Member& two) {
      return one.line != two.line ? one.line < two.line : one.column < two.column;
    });
    to.value = std::move(members);
  } else {
    to.value = Date{};
  }
  return to;
}

void append_short(std::string& text, const Node& n) {
  constexpr std::size_t enough = 60;
  if (text.size() > enough) return;
  if (const auto* b = std::get_if<bool>(&n.value)) {
    text += *b ? "true" : "false";
  } else if (const auto* i = std::get_if<std::int64_t>(&n.value)) {
    text += std::to_string(*i);
  } else if (const auto* d = std::get_if<double>(&n.value)) {
    text += number_text(*d);
  } else if (const auto* s = std::get_if<std::string>(&n.value)) {
    std::size_t cut = std::min(enough, s->size());
    while (cut < s->size() && cut > 0 && (static_cast<unsigned char>((*s)[cut]) & 0xC0) == 0x80)
      --cut;  // whole UTF-8
    text += cut < s->size() ? toml_string(s->substr(0, cut) + "...") : toml_string(*s);
  } else if (const auto* list = std::get_if<NodeList>(&n.value)) {
    text += '[';
    for (const Node& item : *list) {
      if (&item != list->data()) text += ", ";
      if (text.size() > enough) {
        text += "...";
        break;
      }
      append_short(text, item);
    }
    text += ']';
  } else if (std::holds_alternative<NodeTable>(n.value)) {
    text += "{...}";
  } else {
    text += "a date or time";
  }
}

}  // namespace

NodeTable parse_toml(std::string_view text, const std::string& file) {
  if (text.size() > largest_file)
    refuse(file, 1, 1, "a case file of " + std::to_string(text.size() >> 20) + " MiB",
           "must not be over 16 MiB", "put the points into a CSV file and use kind = \"csv\"");
  limit_nesting(text, file);
  try {
    const toml::table root = toml::parse(text, file);
    return std::get<NodeTable>(to_node(root).value);
  } catch (const toml::parse_error& e) {
    const auto at = e.source().begin;
    refuse(
        file, at.line, at.column, "not valid TOML: " + std::string(e.description()),
        "the file must be TOML 1.0 (toml.io)",
        "text needs quotes, a table starts with [name], one of several with [[name]], no key stands twice");
  }
}

const char* kind_name(const Node& n) {
  static constexpr const char* names[] = {"true or false",  "a whole number", "a number", "a string",
                                          "a date or time", "a list",         "a table"};
  return names[n.value.index()];
}

std::string short_text(const Node& n) {
  std::string text;
  append_short(text, n);
  return text;
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string number_text(double x) {
  std::string text = fmt::format("{}", x);
  const bool looks_whole = text.find_first_not_of("-0123456789") == std::string::npos;
  return looks_whole ? text + ".0" : text;
}

}  // namespace vbond::keys
