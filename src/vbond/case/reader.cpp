#include "vbond/case/reader.hpp"

#include <algorithm>
#include <array>

#include "vbond/case/other_place.hpp"

namespace vbond::keys {
Reader::Reader(const NodeTable& members, ReadContext& context, std::string path, SourcePlace header)
    : members_(members), in_(context), path_(std::move(path)), header_(std::move(header)) {}

const Member* Reader::find(const std::string& name) const {
  const auto found =
      std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.key == name; });
  return found == members_.end() ? nullptr : &*found;
}

/// What the key means, where its text goes on from its name.
std::string with_noun(const KeyInfo& key) {
  const std::string_view doc = key.doc;
  const bool goes_on = doc.starts_with("of ") || doc.starts_with("that ");
  return (goes_on ? std::string(key.name) + " " : "") + key.doc;
}

/// The member that a key asks for; nothing, which is noted if it had to be there.
const Member* Reader::take(const KeyInfo& key, const std::string& way_out) {
  if (is_skipping()) {
    std::string& condition = elsewhere_[key.name];
    const std::string& text = conditions_.back().second;
    if (condition.find(text) == std::string::npos) condition += (condition.empty() ? "" : ", or ") + text;
    return nullptr;
  }
  known_.insert(key.name);
  const Member* m = find(key.name);
  const bool needed = key.need.when == Need::When::always ||
                      (key.need.when == Need::When::in_si && in_.units == UnitSystem::si);
  if (!m && needed) {
    failed_.insert(key.name);
    missing_[key.name] = {header_, path_of(key.name) + " is missing",
                          std::string("is required") +
                              (key.need.when == Need::When::in_si ? " in SI units: " : ": ") + with_noun(key),
                          way_out};
  }
  return m;
}

void Reader::on_key(const KeyInfo& key, Value& value) {
  const Member* m = take(key, "add " + std::string(key.name) + " = " + value.example(in_.units));
  if (m) {
    if (value.read(m->value, in_, path_of(key.name))) return;
    failed_.insert(key.name);
    unsure_ = true;
  } else if (!is_skipping()) {
    value.set_place(header_);
    unsure_ = unsure_ || (value.is_choice() && failed_.count(key.name) > 0);
  }
}

/// Reads the members of a table; false after a report.
bool Reader::read_struct(const Node& n, const std::string& path, const Members& members) {
  const auto* table = std::get_if<NodeTable>(&n.value);
  if (!table) return in_.refuse_kind(n, path, "a table", "{ ... }");
  const std::size_t before = in_.problems.count();
  Reader inner(*table, in_, path, in_.place(n));
  members(inner);
  inner.finish();
  return in_.problems.count() == before;
}

void Reader::on_table(const KeyInfo& key, bool, const Members& members) {
  const Member* m = take(key, "add " + std::string(key.name) + " = { ... }");
  if (m && !read_struct(m->value, path_of(key.name), members)) failed_.insert(key.name);
}

void Reader::on_tables(const KeyInfo& key, Structs& items) {
  const bool on_top = path_.empty();
  const Member* m = take(key, on_top ? std::string("add a table [[") + key.name + "]]"
                                     : std::string("add ") + key.name + " = [{ ... }]");
  if (!m) return;
  const auto* list = std::get_if<NodeList>(&m->value.value);
  if (!list) {
    in_.refuse_kind(
        m->value, path_of(key.name), "a list of tables",
        on_top ? std::string("[{ ... }], or a table with the header [[") + key.name + "]]" : "[{ ... }]");
    failed_.insert(key.name);
    return;
  }
  if (list->empty() && key.need.when == Need::When::always)
    in_.refuse(m->value, path_of(key.name), "must have at least one table",
               std::string("add one [[") + key.name + "]]");
  for (std::size_t k = 0; k < list->size(); ++k) {
    items.append({});
    if (!read_struct((*list)[k], path_of(key.name) + "[" + std::to_string(k) + "]",
                     [&](Table& t) { items.describe_one(t, k); }))
      failed_.insert(key.name);
  }
}

void Reader::on_named_tables(const KeyInfo& key, Structs& items) {
  const Member* m = take(key, "add " + std::string(key.name) + " = { ... }");
  if (!m) return;
  const auto* tables = std::get_if<NodeTable>(&m->value.value);
  if (!tables) {
    in_.refuse_kind(m->value, path_of(key.name), "tables with names",
                    std::string("... as in [") + key.name + ".left]");
    return;
  }
  for (const Member& named : *tables) {
    Node word;
    word.value = named.key;
    word.line = named.line;
    word.column = named.column;
    std::string name;
    if (!NameCodec{}.read(word, in_, path_of(key.name) + ", name", name)) continue;
    items.append(name);
    const std::size_t k = items.size() - 1;
    read_struct(named.value, path_of(key.name) + "." + name, [&](Table& t) { items.describe_one(t, k); });
  }
}

std::size_t Reader::exactly_one(const std::vector<std::string>& names, std::size_t) {
  if (is_skipping()) return names.size();
  std::vector<std::string> present;
  for (const std::string& name : names)
    if (find(name)) present.push_back(name);
  if (present.size() == 1)
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), present[0]) - names.begin());
  unsure_ = true;
  SourcePlace at = header_;
  if (present.size() > 1) {
    const auto later = std::max_element(present.begin(), present.end(), [this](const auto& a, const auto& b) {
      return std::pair(find(a)->line, find(a)->column) < std::pair(find(b)->line, find(b)->column);
    });
    at = place_of(*find(*later));
  }
  const Problem problem{at,
                        (path_.empty() ? "" : path_ + ": ") + (present.empty() ? "none" : "both") + " of " +
                            join(present.empty() ? names : present),
                        "exactly one of " + join(names) + " is required",
                        present.empty() ? "add one of them" : "keep one and remove the others"};
  if (present.empty())
    absent_.emplace_back(names, problem);
  else
    in_.problems.add(problem);
  for (const std::string& name : names) failed_.insert(name);
  return names.size();
}

void Reader::check(bool good, const std::vector<std::string>& names, const std::string& rule,
                   const std::string& way_out) {
  if (good || is_skipping()) return;
  const Member* at = nullptr;
  for (const std::string& name : names) {
    if (failed_.count(name) > 0) return;  // what is known to be wrong says nothing about the rest
    if (!at) at = find(name);
  }
  if (at)
    in_.refuse(at->value, path_of(at->key), rule, way_out);
  else
    in_.report(header_, path_, rule, way_out);
  failed_.insert(names.front());
}

void Reader::refuse_key(const std::string& name, const std::string& rule, const std::string& way_out) {
  const Member* m = find(name);
  if (!m || is_skipping()) return;
  in_.refuse(m->value, path_of(name), rule, way_out);
  refused_.insert(name);
  unsure_ = true;
}

void Reader::locate(SourcePlace& place, const std::string& key) const {
  const Member* m = key.empty() ? nullptr : find(key);
  place = m ? place_of(*m) : header_;
}

bool Reader::enter(bool active, const std::string& condition) {
  conditions_.emplace_back(active, condition);
  if (!active) ++inactive_;
  return true;  // also walks over keys that do not apply, to know their names
}

void Reader::leave() {
  if (!conditions_.back().first) --inactive_;
  conditions_.pop_back();
}

/// A key that is not right here, and is meant for one of those of which none is there.
bool Reader::is_meant_for_absent(const Member& m) {
  for (auto choice = absent_.begin(); choice != absent_.end(); ++choice) {
    const auto meant = meant_name(m.key, choice->first);
    if (!meant) continue;
    in_.report(place_of(m), path_of(m.key) + " = " + short_text(m.value),
               "no such key here: " + choice->second.rule, "did you mean " + *meant + "?");
    absent_.erase(choice);
    return true;
  }
  return false;
}

void Reader::report_unknown(const Member& m, const std::vector<std::string>& names, bool shown) {
  const std::string value = short_text(m.value), what = path_of(m.key) + " = " + value;
  const auto meant = shown ? meant_name(m.key, names) : std::nullopt;
  if (meant) {
    missing_.erase(*meant);  // one report is enough for a slip of the pen
    return in_.report(place_of(m), what, "no such key", "did you mean " + *meant + "?");
  }
  if (const auto other = shown ? other_place(path_, m.key, value) : std::nullopt)
    return in_.report(place_of(m), what, other->rule, other->way_out);
  in_.report(place_of(m), what, "no such key", shown ? "the keys here are " + join(names) : "");
}

void Reader::finish() {
  std::vector<std::string> names(known_.begin(), known_.end());
  for (const auto& [name, condition] : elsewhere_)
    if (known_.count(name) == 0) names.push_back(name);
  std::size_t unknown = 0;
  for (const Member& m : members_) {
    if (known_.count(m.key) > 0 || refused_.count(m.key) > 0) continue;
    if (is_meant_for_absent(m)) continue;
    if (const auto other = elsewhere_.find(m.key); other == elsewhere_.end())
      report_unknown(m, names, ++unknown <= Problems::most_shown);
    else if (!unsure_)
      in_.report(place_of(m), path_of(m.key) + " = " + short_text(m.value),
                 "is used only with " + other->second, "remove it, or change what it belongs to");
  }
  for (auto& [choice, problem] : absent_) in_.problems.add(std::move(problem));
  for (auto& [name, problem] : missing_) in_.problems.add(std::move(problem));
}

}  // namespace vbond::keys
