#include "vbond/case/other_place.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

/// The keys of each table, which is named as in `stage[].stop` or `groups.*`.
using KeysOfTables = std::map<std::string, std::vector<std::string>>;

class Collector final : public Table {
 public:
  Collector(KeysOfTables& all, std::string path) : all_(all), path_(std::move(path)) {}
  std::size_t exactly_one(const std::vector<std::string>&, std::size_t current) override { return current; }

 protected:
  void on_key(const KeyInfo& key, Value&) override { all_[path_].emplace_back(key.name); }
  void on_table(const KeyInfo& key, bool, const Members& members) override {
    Collector inner(all_, add(key, ""));
    members(inner);
  }
  void on_tables(const KeyInfo& key, Structs& items) override {
    Collector inner(all_, add(key, "[]"));
    items.describe_any(inner);
  }
  void on_named_tables(const KeyInfo& key, Structs& items) override {
    Collector inner(all_, add(key, ".*"));
    items.describe_any(inner);
  }
  bool enter(bool, const std::string&) override { return true; }
  void leave() override {}

 private:
  /// The path of a table inside this one.
  std::string add(const KeyInfo& key, const char* end) {
    all_[path_].emplace_back(key.name);
    return (path_.empty() ? "" : path_ + ".") + key.name + end;
  }

  KeysOfTables& all_;
  std::string path_;
};

KeysOfTables keys_of_tables() {
  KeysOfTables all;
  Case fresh;
  Collector collector(all, "");
  describe(collector, fresh);
  return all;
}

/// `stage[0].supports[1]` as `stage[].supports[]`, `groups.left` as `groups.*`.
std::string table_of(const std::string& path, const KeysOfTables& all) {
  std::string table;
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    std::string part = path.substr(begin, end - begin);
    if (const auto bracket = part.find('['); bracket != std::string::npos)
      part = part.substr(0, bracket) + "[]";
    const std::string before = table.empty() ? "" : table + ".";
    table = before + (all.count(before + part) > 0 || before + part == "groups" ? part : "*");
    begin = end + 1;
  }
  return table;
}

bool has(const KeysOfTables& all, const std::string& table, const std::string& key) {
  const auto found = all.find(table);
  return found != all.end() &&
         std::find(found->second.begin(), found->second.end(), key) != found->second.end();
}

/// The path of the table around, empty for the top level.
std::string around(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

/// `newton.solver` and the like, of tables inside of this one.
std::vector<std::string> inside(const KeysOfTables& all, const std::string& table, const std::string& key) {
  std::vector<std::string> found;
  const std::string begin = table.empty() ? "" : table + ".";
  for (const auto& [name, keys] : all)
    if (name.size() > begin.size() && name.compare(0, begin.size(), begin) == 0 && has(all, name, key))
      found.push_back(name.substr(begin.size()) + "." + key);
  std::stable_sort(found.begin(), found.end(), [](const std::string& a, const std::string& b) {
    return std::count(a.begin(), a.end(), '.') < std::count(b.begin(), b.end(), '.');
  });
  return found;
}

}  // namespace

std::optional<OtherPlace> other_place(const std::string& path, const std::string& key,
                                      const std::string& value) {
  const KeysOfTables all = keys_of_tables();
  for (std::string up = path; !up.empty();) {
    up = around(up);
    if (!has(all, table_of(up, all), key)) continue;
    if (up.empty())
      return OtherPlace{"no such key here: " + key + " is a key of the top level",
                        "write it before the first header [...] or [[...]]: what follows a header belongs to "
                        "its table"};
    return OtherPlace{"no such key here: " + key + " is a key of " + up,
                      "write it there, before the headers of tables inside it"};
  }
  std::vector<std::string> found = inside(all, table_of(path, all), key);
  if (found.empty()) return std::nullopt;
  constexpr std::size_t most = 3;
  const std::string first = found.front(), more = found.size() > most ? ", ..." : "";
  if (found.size() == 1 && first.find_first_of("[*") == std::string::npos)
    return OtherPlace{"no such key here: there is " + first, "write " + first + " = " + value};
  found.resize(std::min(found.size(), most));
  return OtherPlace{"no such key here: there is " + join(found) + more,
                    "write it in the table that is meant"};
}

}  // namespace vbond::keys
