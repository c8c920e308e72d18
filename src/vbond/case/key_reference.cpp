#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "vbond/case/keys.hpp"
#include "vbond/case/read.hpp"

namespace vbond::keys {
namespace {

/// In Markdown.
std::string default_of(const KeyInfo& key, const std::string& written) {
  switch (key.need.when) {
    case Need::When::always: return "required";
    case Need::When::in_si: return "`" + written + "`; SI: required";
    case Need::When::never: break;
  }
  if (*key.need.default_text != '\0') return key.need.default_text;
  return written.empty() ? "" : "`" + written + "`";
}

/// Writes the reference of a struct's keys as Markdown.
class Documenter final : public Table {
 public:
  std::string text;

  std::size_t exactly_one(const std::vector<std::string>& names, std::size_t current) override {
    end_rows();
    text += "\nExactly one of " + join(names, "`") + ":\n";
    return current;
  }

 protected:
  void on_key(const KeyInfo& key, Value& value) override {
    row(key, value.type(), default_of(key, value.write()));
  }

  void on_table(const KeyInfo& key, bool, const Members& members) override {
    if (depth_ == 0) {
      heading(std::string("[") + key.name + "]", key);
      inside("", members);
    } else {
      row(key, "table", key.need.when == Need::When::always ? "required" : "");
      inside(prefix_ + key.name + ".", members);
    }
  }

  void on_tables(const KeyInfo& key, Structs& items) override {
    const auto members = [&items](Table& t) { items.describe_any(t); };
    if (depth_ == 0) {
      heading(std::string("[[") + key.name + "]]", key);
      inside("", members);
    } else {
      row(key, "list of tables", "");
      inside(prefix_ + key.name + "[].", members);
    }
  }

  void on_named_tables(const KeyInfo& key, Structs& items) override {
    heading(std::string("[") + key.name + ".NAME]", key);
    inside("", [&items](Table& t) { items.describe_any(t); });
  }

  bool enter(bool, const std::string& condition) override {
    end_rows();
    had_conditions_ = true;
    conditions_.push_back(condition);
    return true;
  }
  void leave() override {
    end_rows();
    conditions_.pop_back();
  }

 private:
  void heading(const std::string& title, const KeyInfo& key) {
    end_rows();
    had_conditions_ = false;
    std::string doc = key.doc;
    doc.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(doc.front())));
    text += "\n## `" + title + "`\n\n" + doc +
            (key.need.when == Need::When::always ? ". At least one is required.\n" : ".\n");
  }

  void inside(const std::string& prefix, const Members& members) {
    const std::string outer = prefix_;
    prefix_ = prefix;
    ++depth_;
    members(*this);
    --depth_;
    prefix_ = outer;
    if (depth_ == 0) end_rows();
  }

  void row(const KeyInfo& key, const std::string& type, const std::string& default_text) {
    if (!in_rows_) {
      if (!conditions_.empty()) text += "\nWith " + conditions_.back() + ":\n";
      if (conditions_.empty() && had_conditions_) text += "\nIn any case:\n";
      text += "\n| key | value | default | meaning |\n|---|---|---|---|\n";
      in_rows_ = true;
    }
    text += "| `" + prefix_ + key.name + "` | " + type + " | " + default_text + " | " + key.doc + " |\n";
  }

  void end_rows() { in_rows_ = false; }

  std::string prefix_;
  std::vector<std::string> conditions_;
  int depth_ = 0;
  bool had_conditions_ = false;  ///< in this section
  bool in_rows_ = false;
};

/// Lists the keys of a struct one by one.
class Lister final : public Table {
 public:
  std::vector<KeyEntry> entries;

  std::size_t exactly_one(const std::vector<std::string>& names, std::size_t current) override {
    for (const std::string& name : names) choices_[name] = "exactly one of " + join(names);
    return current;
  }

 protected:
  void on_key(const KeyInfo& key, Value& value) override {
    add(key, value.type(), default_of(key, value.write()));
  }
  void on_table(const KeyInfo& key, bool, const Members& members) override {
    add(key, "table", key.need.when == Need::When::always ? "required" : "");
    inside(key, members);
  }
  void on_tables(const KeyInfo& key, Structs& items) override {
    add(key, "list of tables", key.need.when == Need::When::always ? "required" : "");
    inside(key, [&items](Table& t) { items.describe_any(t); });
  }
  void on_named_tables(const KeyInfo& key, Structs& items) override {
    add(key, "tables with names of your choice", "");
    inside(key, [&items](Table& t) { items.describe_any(t); });
  }
  bool enter(bool, const std::string& condition) override {
    conditions_.push_back(condition);
    return true;
  }
  void leave() override { conditions_.pop_back(); }

 private:
  void add(const KeyInfo& key, const std::string& type, std::string default_text) {
    default_text.erase(std::remove(default_text.begin(), default_text.end(), '`'), default_text.end());
    std::string condition = conditions_.empty() ? "" : conditions_.back();
    if (condition == key.name) condition = choices_[condition];
    entries.push_back({prefix_ + key.name, type, std::move(default_text), key.doc, std::move(condition)});
  }
  void inside(const KeyInfo& key, const Members& members) {
    const std::string outer = prefix_;
    const std::vector<std::string> conditions = std::exchange(conditions_, {});
    prefix_ += std::string(key.name) + '.';
    members(*this);
    prefix_ = outer;
    conditions_ = conditions;
  }

  std::string prefix_;
  std::vector<std::string> conditions_;
  std::map<std::string, std::string> choices_;  ///< of which a key is one
};

constexpr const char* introduction = R"(# Keys of a case file

This page is generated from the table that reads and checks case files; a test keeps the two the same.
Do not edit it: change the `describe` function of the key and run the test with `VBOND_UPDATE_REFERENCE=1`.

A case is a TOML file. A key that is not listed here is an error, and so is one that another choice would need.
In reduced units numbers are bare, with a = m = c_A = 1. In SI a number is in m, kg, s, rad, or is text with a unit
such as `"2 GPa"`, `"7800 kg/m^3"`, `"10 deg/s"`. Times may be multiples of T0 = 2 pi sqrt(m / c_A) in both: `"10 T0"`.
Numbers are finite and at most 1e60 in size, particles are at most 1e8 and are counted from 0. Groups that
specimens make by themselves: `all`, their own names, and their parts `ends`, `first`, `last`, `rim`, `apex`, as in
`rod.ends`; the plain `ends` will do if only one specimen has such a part.

In a terminal, `vbond reference KEY` prints a key or a table of this page. For completion and first checks in an editor,
`vbond schema >vbond.schema.json` writes a JSON Schema (draft 07); editors that use taplo, such as VS Code with
Even Better TOML, take it from a first line `#:schema ./vbond.schema.json` of the case. It knows all keys, the form of
their values and their ranges; `vbond check` knows all rules.
)";

}  // namespace
}  // namespace vbond::keys

namespace vbond {

std::string key_reference() {
  Case fresh;
  keys::Documenter documenter;
  documenter.text = keys::introduction;
  keys::describe(documenter, fresh);
  return documenter.text;
}

std::vector<KeyEntry> list_keys() {
  Case fresh;
  keys::Lister lister;
  keys::describe(lister, fresh);
  return lister.entries;
}

}  // namespace vbond
