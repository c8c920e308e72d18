#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/nearest.hpp"

namespace vbond::app {
namespace {

/// As the user may write it: [[stage]], stage[0].stop, groups.NAME.box.
std::string path_of(const std::string& key) {
  std::string path;
  bool inside = false;  // of an index
  for (std::size_t k = 0; k < key.size(); ++k) {
    if (key[k] == '[' && !path.empty()) inside = true;
    if (!inside && key[k] != '[' && key[k] != ']') path += key[k];
    if (key[k] == ']') inside = false;
  }
  const std::string named = "groups.";
  const std::size_t dot = path.find('.', named.size());
  if (path.rfind(named, 0) == 0 && path.compare(named.size(), 4, "NAME") == 0)
    path = dot == std::string::npos ? "groups" : named + path.substr(dot + 1);
  return path;
}

std::string last_part(const std::string& path) {
  return path.substr(path.rfind('.') + 1);  // npos + 1 is 0
}

/// The key, what is inside of it, and keys of that name in other tables.
std::vector<KeyEntry> matches(const std::vector<KeyEntry>& all, const std::string& wanted) {
  std::vector<KeyEntry> found;
  const auto take = [&](const auto& is_meant) {
    std::copy_if(all.begin(), all.end(), std::back_inserter(found), is_meant);
  };
  take([&](const KeyEntry& e) { return e.path == wanted || e.path.rfind(wanted + '.', 0) == 0; });
  if (found.empty()) take([&](const KeyEntry& e) { return last_part(e.path) == wanted; });
  return found;
}

[[noreturn]] void refuse(const std::vector<KeyEntry>& all, const std::string& key) {
  std::vector<std::string> names, tables;
  for (const KeyEntry& e : all) {
    names.push_back(e.path), names.push_back(last_part(e.path));
    if (e.path.find('.') == std::string::npos) tables.push_back(e.path);
  }
  const auto meant = nearest_name(path_of(key), names);
  throw CaseError(
      {{},
       "key " + key,
       "no case file has it",
       meant ? "did you mean " + *meant + "?" : fmt::format("the tables are {}", fmt::join(tables, ", "))});
}

std::string in_lines(const KeyEntry& e) {
  std::string text = fmt::format("{}\n    {}\n    {}", e.path, e.meaning, e.type);
  if (e.default_text == "required")
    text += ", required";
  else if (!e.default_text.empty())
    text += ", default " + e.default_text;
  return text + (e.condition.empty() ? "\n" : "\n    with " + e.condition + "\n");
}

}  // namespace

int reference(const std::string& key) {
  const std::vector<KeyEntry> all = list_keys(), wanted = key.empty() ? all : matches(all, path_of(key));
  if (wanted.empty()) refuse(all, key);
  std::string text;
  for (const KeyEntry& e : wanted) text += in_lines(e);
  say(text);
  return done;
}

int schema() {
  say(case_schema());
  return done;
}

}  // namespace vbond::app
