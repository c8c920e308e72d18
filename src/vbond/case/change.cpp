#include "vbond/case/change.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "vbond/case/find_key.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/nearest.hpp"

namespace vbond::keys {
namespace {

constexpr const char* form = "write it as key=value, as in stage[0].duration=\"2 T0\" or bonds[beam].E=2e9";

/// A name of the path, and which items of it.
struct Step {
  std::string name;
  std::vector<std::string> items;
};

class Change {
 public:
  Change(const std::string& text, std::uint32_t number) : text_(text), line_(first_changed_line + number) {}
  /// One that only looks, for an option of this name.
  Change(const std::string& text, const std::string& option) : text_(text), line_(0), looks_for_(option) {}

  void apply(NodeTable& root, SetTwice twice) {
    const std::vector<Step> steps = read_path();
    Node value = read_value();
    NodeTable* table = &root;
    for (std::size_t k = 0; k + 1 < steps.size(); ++k) table = &table_of(item_of(*table, steps[k]), steps[k]);
    const Step& last = steps.back();
    Node& place = item_of(*table, last);
    if (const auto earlier = set_before(place); earlier && twice == SetTwice::refused)
      refuse(
          "--set number " + std::to_string(*earlier + 1) + " sets this key, or a part of it, already",
          "give it once; an item by its place and by its name, as stage[0] and stage[push], may be the same");
    place = std::move(value);
    for (Member& m : *table)  // a key is pointed at by its own place
      if (m.key == last.name && last.items.empty()) m.line = line_, m.column = 1;
  }

  FoundKey find(NodeTable& root) {
    const std::vector<Step> steps = read_path();
    NodeTable* table = &root;
    for (std::size_t k = 0; k + 1 < steps.size(); ++k) table = &table_of(item_of(*table, steps[k]), steps[k]);
    return {&item_of(*table, steps.back()), !steps.back().items.empty()};
  }

 private:
  [[noreturn]] void refuse(const std::string& rule, const std::string& way_out) const {
    std::string shown = text_;
    std::replace_if(shown.begin(), shown.end(), is_line_break, ' ');
    if (!looks_for_.empty() && shown.ends_with('=')) shown.pop_back();
    throw CaseError(
        Problem{{(looks_for_.empty() ? "--set" : looks_for_) + " " + shown, 0, 0}, rule, way_out, ""});
  }
  static bool is_line_break(char c) { return c == '\n' || c == '\r'; }

  /// The number of the first change that has set this value or one below it; nothing if it is of the file, or
  /// was made by this change.
  std::optional<std::uint32_t> set_before(const Node& n) const {
    if (n.line >= first_changed_line && n.line != line_) return n.line - first_changed_line;
    std::optional<std::uint32_t> found;
    if (const auto* list = std::get_if<NodeList>(&n.value))
      for (std::size_t k = 0; k < list->size() && !found; ++k) found = set_before((*list)[k]);
    if (const auto* table = std::get_if<NodeTable>(&n.value))
      for (std::size_t k = 0; k < table->size() && !found; ++k) found = set_before((*table)[k].value);
    return found;
  }

  std::vector<Step> read_path() {
    std::vector<Step> steps;
    for (std::size_t at = 0;;) {
      steps.push_back({read_name(at), {}});
      while (at < text_.size() && text_[at] == '[') {
        ++at;
        steps.back().items.push_back(read_name(at));
        if (at >= text_.size() || text_[at] != ']') refuse("a bracket is not closed", form);
        ++at;
      }
      if (at >= text_.size() || (text_[at] != '.' && text_[at] != '=')) refuse("no value is given", form);
      if (text_[at++] == '=') {
        value_ = text_.substr(at);
        return steps;
      }
    }
  }
  std::string read_name(std::size_t& at) const {
    const std::size_t first = at;
    const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
    while (at < text_.size() && plain(static_cast<unsigned char>(text_[at]))) ++at;
    if (at == first) refuse("a name of a key is missing", form);
    return text_.substr(first, at - first);
  }

  /// As TOML, or the text itself if it is none.
  Node read_value() const {
    if (value_.find_first_not_of(" \t\r\n") == std::string::npos) refuse("the value is missing", form);
    if (std::any_of(value_.begin(), value_.end(), is_line_break))
      refuse("the value has a line break", "write \\n for it in a text in double quotes, or leave it out");
    Node value;
    if (auto parsed = as_toml()) {
      value = std::move(*parsed);
    } else {
      if (value_.find_first_of("[]{}\"'=#") != std::string::npos)
        refuse("the value is no TOML",
               "close brackets and quotes, leave out comments; the shell takes quotes away: put '...' around "
               "all");
      value.value = value_;
    }
    place(value);
    return value;
  }
  /// In a list with something behind it, so that neither a comment nor a second value is taken.
  std::optional<Node> as_toml() const {
    try {
      NodeTable parsed = parse_toml("value = [" + value_ + ", 0]", "");
      auto& list = std::get<NodeList>(parsed.front().value.value);
      if (parsed.size() == 1 && list.size() == 2) return std::move(list.front());
    } catch (const CaseError&) {
    }
    return std::nullopt;
  }
  void place(Node& n) const {
    n.line = line_, n.column = 1;
    if (auto* list = std::get_if<NodeList>(&n.value))
      for (Node& item : *list) place(item);
    if (auto* table = std::get_if<NodeTable>(&n.value))
      for (Member& m : *table) m.line = line_, m.column = 1, place(m.value);
  }

  /// The value that a step leads to; a key that is not there is made.
  Node& item_of(NodeTable& table, const Step& step) const {
    auto at = std::find_if(table.begin(), table.end(), [&](const Member& m) { return m.key == step.name; });
    if (at == table.end()) {
      if (!looks_for_.empty()) {
        std::vector<std::string> given;
        for (const Member& m : table) given.push_back(m.key);
        const auto near = nearest_name(step.name, given);
        refuse("the case does not give " + step.name,
               near ? "did you mean " + *near + "?"
                    : "write it into the case file, with the value to start from");
      }
      if (!step.items.empty()) refuse("the case has no " + step.name, "write it into the case file");
      table.push_back({step.name, line_, 1, Node{NodeTable{}, line_, 1}});
      at = table.end() - 1;
    }
    Node* node = &at->value;
    for (const std::string& item : step.items) {
      auto* list = std::get_if<NodeList>(&node->value);
      if (!list) refuse(step.name + " is no list", "leave out [" + item + "]");
      node = find_item(*list, item);
      if (!node)
        refuse(step.name + " has no item " + item,
               "it has " + std::to_string(list->size()) + ": " + names_of(*list));
    }
    return *node;
  }
  NodeTable& table_of(Node& node, const Step& step) const {
    if (auto* table = std::get_if<NodeTable>(&node.value)) return *table;
    const auto* list = std::get_if<NodeList>(&node.value);
    refuse(step.name + " is " + kind_name(node),
           list ? "say which of its items: " + step.name + "[0], or its name" : "nothing can stand below it");
  }

  static std::optional<std::string> name_of(const Node& item) {
    if (const auto* table = std::get_if<NodeTable>(&item.value))
      for (const Member& m : *table)
        if (m.key == "name")
          if (const auto* name = std::get_if<std::string>(&m.value.value)) return *name;
    return std::nullopt;
  }
  static std::string names_of(const NodeList& list) {
    std::string text;
    for (std::size_t k = 0; k < list.size(); ++k)
      text += (k == 0 ? "" : ", ") + name_of(list[k]).value_or(std::to_string(k));
    return text;
  }
  static Node* find_item(NodeList& list, const std::string& item) {
    for (Node& n : list)
      if (name_of(n) == item) return &n;
    std::size_t k = 0;
    const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), k);
    const bool is_number = error == std::errc{} && end == item.data() + item.size();
    return is_number && k < list.size() ? &list[k] : nullptr;
  }

  const std::string& text_;
  std::uint32_t line_;
  std::string value_, looks_for_;
};

}  // namespace

void apply_change(const std::string& text, std::uint32_t number, NodeTable& root, SetTwice twice) {
  Change(text, number).apply(root, twice);
}

FoundKey find_key(const std::string& path, NodeTable& root, const std::string& option) {
  const std::string text = path + '=';
  return Change(text, option).find(root);
}

}  // namespace vbond::keys
