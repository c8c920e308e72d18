#include "vbond/case/change.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"

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

  void apply(NodeTable& root) {
    const std::vector<Step> steps = read_path();
    Node value = read_value();
    NodeTable* table = &root;
    for (std::size_t k = 0; k + 1 < steps.size(); ++k) table = &table_of(item_of(*table, steps[k]), steps[k]);
    const Step& last = steps.back();
    item_of(*table, last) = std::move(value);
    for (Member& m : *table)  // a key is pointed at by its own place
      if (m.key == last.name && last.items.empty()) m.line = line_, m.column = 1;
  }

 private:
  [[noreturn]] void refuse(const std::string& rule, const std::string& way_out) const {
    throw CaseError(Problem{{"--set " + text_, 0, 0}, rule, way_out, ""});
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
    Node value;
    if (value_.empty() || value_.find('\n') != std::string::npos) refuse("the value is missing", form);
    try {
      NodeTable parsed = parse_toml("value = " + value_, "");
      value = std::move(parsed.front().value);
    } catch (const CaseError&) {
      if (value_.find_first_of("[]{}\"'=#") != std::string::npos)
        refuse("the value is no TOML",
               "close brackets and quotes; the shell takes quotes away: put '...' around all");
      value.value = value_;
    }
    place(value);
    return value;
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
  std::string value_;
};

}  // namespace

void apply_change(const std::string& text, std::uint32_t number, NodeTable& root) {
  Change(text, number).apply(root);
}

}  // namespace vbond::keys
