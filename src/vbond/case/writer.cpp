#include "vbond/case/keys.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/printable.hpp"

namespace vbond::keys {
namespace {

/// Writes a struct as TOML: tables with headers on the top level, inline tables below.
class Writer final : public Table {
 public:
  explicit Writer(bool on_top) : on_top_(on_top) {}

  std::string text;

  std::size_t exactly_one(const std::vector<std::string>&, std::size_t current) override { return current; }

 protected:
  void on_key(const KeyInfo& key, Value& value) override {
    const std::string v = value.write();
    if (!v.empty()) add(key.name, v);
  }

  void on_table(const KeyInfo& key, bool there, const Members& members) override {
    if (!there) return;
    if (on_top_)
      section(std::string("[") + key.name + "]", members);
    else
      add(key.name, inline_table(members));
  }

  void on_tables(const KeyInfo& key, Structs& items) override {
    std::string list;
    for (std::size_t k = 0; k < items.size(); ++k) {
      const auto members = [&](Table& t) { items.describe_one(t, k); };
      if (on_top_)
        section(std::string("[[") + key.name + "]]", members);
      else
        list += (k > 0 ? ", " : "") + inline_table(members);
    }
    if (!list.empty()) add(key.name, "[" + list + "]");
  }

  void on_named_tables(const KeyInfo& key, Structs& items) override {
    for (std::size_t k = 0; k < items.size(); ++k)
      section(std::string("[") + key.name + "." + items.name(k) + "]",
              [&](Table& t) { items.describe_one(t, k); });
  }

  bool enter(bool active, const std::string&) override { return active; }
  void leave() override {}

 private:
  /// A line of its own below a header; a comma's distance inside braces.
  void add(const std::string& name, const std::string& value) {
    if (is_inline_ && !text.empty()) text += ", ";
    text += name + " = " + value;
    if (!is_inline_) text += '\n';
  }
  void section(const std::string& header, const Members& members) {
    Writer inner(false);
    members(inner);
    text += (text.empty() ? "" : "\n") + header + "\n" + inner.text;
  }
  static std::string inline_table(const Members& members) {
    Writer inner(false);
    inner.is_inline_ = true;
    members(inner);
    return "{ " + inner.text + " }";
  }

  bool on_top_;
  bool is_inline_ = false;
};

}  // namespace
}  // namespace vbond::keys

namespace vbond {

std::string to_toml(const Case& c) {
  Case copy = c;  // describe() serves reading too and takes it by reference
  keys::Writer writer(true);
  keys::describe(writer, copy);
  std::string changes;
  for (const std::string& change : c.changes) changes += "# --set " + printable(change) + "\n";
  return changes + writer.text;
}

}  // namespace vbond
