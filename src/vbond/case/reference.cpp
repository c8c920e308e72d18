#include <cctype>
#include <string>

#include "vbond/case/keys.hpp"
#include "vbond/case/read.hpp"

namespace vbond::keys {
namespace {

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
  static std::string default_of(const KeyInfo& key, const std::string& written) {
    switch (key.need.when) {
      case Need::When::always: return "required";
      case Need::When::in_si: return "`" + written + "`; SI: required";
      case Need::When::never: break;
    }
    if (*key.need.default_text != '\0') return key.need.default_text;
    return written.empty() ? "" : "`" + written + "`";
  }

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

constexpr const char* introduction = R"(# Keys of a case file

This page is generated from the table that reads and checks case files; a test keeps the two the same.
Do not edit it: change the `describe` function of the key and run the test with `VBOND_UPDATE_REFERENCE=1`.

A case is a TOML file. A key that is not listed here is an error, and so is one that another choice would need.
In reduced units numbers are bare, with a = m = c_A = 1. In SI a number is in m, kg, s, rad, or is text with a unit
such as `"2 GPa"`, `"7800 kg/m^3"`, `"10 deg/s"`. Times may be multiples of T0 = 2 pi sqrt(m / c_A) in both: `"10 T0"`.
Numbers are finite and at most 1e60 in size, particles are at most 1e8 and are counted from 0. Groups that
specimens make by themselves: `all`, their own names, and their parts `ends`, `first`, `last`, `rim`, `apex`, as in
`rod.ends`; the plain `ends` will do if only one specimen has such a part.
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

}  // namespace vbond
