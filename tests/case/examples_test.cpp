// A message says `add nu = ...`: what it says must not break the rules of that key.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "vbond/case/keys.hpp"

namespace vbond::examples_test {
namespace {

using namespace keys;

/// Gives each required key its example, and gathers the rules that these break. Of keys of which exactly one
/// must stand it takes the one of that number, or the last.
class ExampleTaker final : public Table {
 public:
  ExampleTaker(UnitSystem units, std::size_t choice, std::string path, std::vector<std::string>& broken)
      : units_(units), choice_(choice), path_(std::move(path)), broken_(broken) {}

  std::size_t exactly_one(const std::vector<std::string>& names, std::size_t) override {
    return std::min(choice_, names.size() - 1);
  }
  void check(bool good, const std::vector<std::string>& names, const std::string& rule,
             const std::string&) override {
    const auto taken = [this](const std::string& name) { return taken_.count(name) > 0; };
    if (!good && inactive_ == 0 && std::any_of(names.begin(), names.end(), taken))
      broken_.push_back(path_ + ": " + join(names) + ": " + rule);
  }

 protected:
  void on_key(const KeyInfo& key, Value& value) override {
    const bool needed = key.need.when == Need::When::always ||
                        (key.need.when == Need::When::in_si && units_ == UnitSystem::si);
    const std::string text = value.example(units_);
    const std::string before = value.write();  // what it is by default, and afterwards again
    if (inactive_ > 0 || text.find("...") != std::string::npos || (!needed && before.empty())) return;
    ReadContext in;
    in.units = units_;
    const NodeTable root = parse_toml("x = " + text, "example");
    if (!value.read(root.at(0).value, in, key.name))
      broken_.push_back(path_ + "." + key.name + " = " + text + ": " + in.problems.shown().at(0).rule);
    if (needed) {
      taken_.insert(key.name);
      return;
    }
    const NodeTable old = parse_toml("x = " + before, "default");
    value.read(old.at(0).value, in, key.name);
  }
  void on_table(const KeyInfo& key, bool, const Members& members) override {
    if (inactive_ == 0) inside(key, members);
  }
  void on_tables(const KeyInfo& key, Structs& items) override {
    if (inactive_ == 0) inside(key, [&items](Table& t) { items.describe_any(t); });
  }
  void on_named_tables(const KeyInfo& key, Structs& items) override { on_tables(key, items); }
  bool enter(bool active, const std::string&) override {
    active_.push_back(active);
    inactive_ += active ? 0 : 1;
    return true;
  }
  void leave() override {
    inactive_ -= active_.back() ? 0 : 1;
    active_.pop_back();
  }

 private:
  void inside(const KeyInfo& key, const Members& members) {
    ExampleTaker inner(units_, choice_, path_ + "." + key.name, broken_);
    members(inner);
  }

  UnitSystem units_;
  std::size_t choice_;
  std::string path_;
  std::vector<std::string>& broken_;
  std::set<std::string> taken_;
  std::vector<bool> active_;
  int inactive_ = 0;
};

/// Here all tables stand, also those that exclude each other, and all points are the same.
bool is_of_several(const std::string& rule) {
  for (const char* known :
       {"softening: tension", "flat_joint, ", "mass, density, ", "ends of the axis must differ"})
    if (rule.find(known) != std::string::npos) return true;
  return false;
}

TEST(Examples, OfMissingKeysKeepTheirRules) {
  for (const UnitSystem units : {UnitSystem::reduced, UnitSystem::si})
    for (std::size_t choice = 0; choice < 12; ++choice) {
      std::vector<std::string> broken;
      Case c;
      c.units = units;
      ExampleTaker taker(units, choice, "", broken);
      describe(taker, c);
      for (const std::string& rule : broken)
        if (!is_of_several(rule)) ADD_FAILURE() << "choice " << choice << rule;
    }
}

}  // namespace
}  // namespace vbond::examples_test
