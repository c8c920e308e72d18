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

/// The end of a path after each of its dots, and all of it: stage.stop.peak, stop.peak, peak.
std::vector<std::string> ends_of(const std::string& path) {
  std::vector<std::string> ends{path};
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1))
    ends.push_back(path.substr(dot + 1));
  return ends;
}

/// Whether a word that a key may take, such as "rod" of kind, is named where its type or condition says so.
bool names_word(const KeyEntry& e, const std::string& word) {
  const std::string quoted = '"' + word + '"';
  return e.type.find(quoted) != std::string::npos || e.condition.find(quoted) != std::string::npos;
}

/// The key and what is inside of it; else keys whose path ends so, and those that take this word or go with
/// it.
std::vector<KeyEntry> matches(const std::vector<KeyEntry>& all, const std::string& wanted) {
  std::vector<KeyEntry> found;
  const auto take = [&](const auto& is_meant) {
    std::copy_if(all.begin(), all.end(), std::back_inserter(found), is_meant);
  };
  take([&](const KeyEntry& e) { return e.path == wanted || e.path.rfind(wanted + '.', 0) == 0; });
  if (found.empty())
    take([&](const KeyEntry& e) { return e.path.ends_with('.' + wanted) || names_word(e, wanted); });
  return found;
}

/// The words between quotes in a text.
std::vector<std::string> quoted_words(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = text.find('"'), end; at != std::string::npos; at = text.find('"', end + 1)) {
    end = text.find('"', at + 1);
    if (end == std::string::npos) break;
    words.push_back(text.substr(at + 1, end - at - 1));
  }
  return words;
}

[[noreturn]] void refuse(const std::vector<KeyEntry>& all, const std::string& key) {
  std::vector<std::string> names, tables;
  const auto add = [&names](const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  for (const KeyEntry& e : all) {
    add(ends_of(e.path));
    if (e.path.find('.') == std::string::npos) tables.push_back(e.path);
  }
  for (const KeyEntry& e : all) add(quoted_words(e.type));
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
