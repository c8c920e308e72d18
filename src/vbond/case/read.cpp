#include "vbond/case/read.hpp"

#include <algorithm>
#include <set>

#include "vbond/case/change.hpp"
#include "vbond/case/keys.hpp"
#include "vbond/case/reader.hpp"
#include "vbond/core/nearest.hpp"
#include "vbond/core/read_file.hpp"

namespace vbond {
namespace {

using keys::ReadContext;

/// stage-1, stage-2, ... for those without a name.
template <class T>
void number_nameless(std::vector<T>& items, const std::string& kind) {
  for (std::size_t k = 0; k < items.size(); ++k)
    if (items[k].name.empty()) items[k].name = kind + "-" + std::to_string(k + 1);
}

template <class T>
void check_twice(const std::vector<T>& items, const std::string& kind, std::set<std::string>& taken,
                 ReadContext& in) {
  for (const T& item : items)
    if (!taken.insert(item.name).second)
      in.report(item.place, kind + " \"" + item.name + "\"",
                "the name \"" + item.name + "\" is taken already", "give this one another name");
}

/// Specimens and groups share one set of names, in which setup/ adds some of its own.
void check_names(const Case& c, ReadContext& in) {
  std::set<std::string> stages, bonds, groups, walls, materials, sources, sinks;
  check_twice(c.stages, "stage", stages, in);
  check_twice(c.bonds, "bonds", bonds, in);
  check_twice(c.walls, "wall", walls, in);
  check_twice(c.materials, "material", materials, in);
  check_twice(c.sources, "source", sources, in);
  check_twice(c.sinks, "sink", sinks, in);
  const std::vector<std::string> reserved{"all", "ends", "first", "last", "rim", "apex"};
  const auto check_reserved = [&](const auto& item, const char* kind) {
    if (std::find(reserved.begin(), reserved.end(), item.name) != reserved.end())
      in.report(item.place, std::string(kind) + " \"" + item.name + "\"",
                "the names " + keys::join(reserved) + " belong to groups that the specimens make themselves",
                "choose another name, such as \"my_" + item.name + "\"");
  };
  for (const auto& s : c.specimens) check_reserved(s, "specimen");
  for (const auto& g : c.groups) check_reserved(g, "group");
  check_twice(c.specimens, "specimen", groups, in);
  check_twice(c.groups, "group", groups, in);
}

void check_stage_references(const Case& c, ReadContext& in) {
  std::vector<std::string> names;
  for (const StageSpec& s : c.stages) names.push_back(s.name);
  const auto check_visits = [&](const VisitSpec& visits, const std::string& who) {
    for (const auto& wanted : visits.stages) {
      const auto found = std::find(names.begin(), names.end(), wanted.value);
      const auto meant = nearest_name(wanted.value, names);
      if (found == names.end())
        in.report(wanted.place, who + ": stages has \"" + wanted.value + "\"",
                  "there is no stage of this name",
                  !meant ? "the stages are " + keys::join(names, "\"") : "did you mean \"" + *meant + "\"?");
      else if (is_static(c.stages[static_cast<std::size_t>(found - names.begin())].kind))
        in.report(wanted.place, who + ": stages has \"" + wanted.value + "\"",
                  "that stage is static: particles come and go in dynamics only", "take the stage out");
    }
  };
  for (const SourceSpec& s : c.sources) check_visits(s.visits, "source \"" + s.name + "\"");
  for (const SinkSpec& s : c.sinks) check_visits(s.visits, "sink \"" + s.name + "\"");
  for (const BondSpec& b : c.bonds)
    for (const auto& wanted : b.stages) {
      const auto found = std::find(names.begin(), names.end(), wanted.value);
      if (found != names.end()) {
        const StageSpec& stage = c.stages[static_cast<std::size_t>(found - names.begin())];
        if (b.when == BondTime::approach && is_static(stage.kind))
          in.report(wanted.place, "bonds \"" + b.name + "\": stages has \"" + wanted.value + "\"",
                    "that stage is static: particles come near each other in dynamics only",
                    "take the stage out, or make the bonds as it begins: when = \"stage\"");
        continue;
      }
      const auto meant = nearest_name(wanted.value, names);
      in.report(wanted.place, "bonds \"" + b.name + "\": stages has \"" + wanted.value + "\"",
                "there is no stage of this name",
                !meant ? "the stages are " + keys::join(names, "\"") : "did you mean \"" + *meant + "\"?");
    }
}

}  // namespace

Case parse_case(std::string_view text, const std::filesystem::path& file,
                const std::vector<std::string>& changes, SetTwice twice) {
  ReadContext in;
  in.file = file.string();
  in.folder = std::filesystem::absolute(file.empty() ? "." : file).parent_path();
  keys::NodeTable root = keys::parse_toml(text, in.file);
  in.changes = changes;
  for (std::size_t k = 0; k < changes.size(); ++k)
    keys::apply_change(changes[k], static_cast<std::uint32_t>(k), root, twice);

  Case c;
  c.file = in.file;
  c.changes = changes;
  keys::Reader reader(root, in, "", {in.file, 1, 1});
  keys::describe(reader, c);
  reader.finish();
  number_nameless(c.stages, "stage");
  number_nameless(c.bonds, "bonds");
  if (c.bonds.size() > most_bond_sets)
    in.report(c.bonds[most_bond_sets].place, std::to_string(c.bonds.size()) + " tables [[bonds]]",
              "there may be " + std::to_string(most_bond_sets),
              "make bonds that differ in their pairs, length or radii alone by one table");
  number_nameless(c.walls, "wall");
  number_nameless(c.sources, "source");
  number_nameless(c.sinks, "sink");
  check_names(c, in);
  check_stage_references(c, in);

  if (!in.problems.none()) {
    std::vector<Problem> problems = in.problems.shown();
    std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
      return a.place.line != b.place.line ? a.place.line < b.place.line : a.place.column < b.place.column;
    });
    throw CaseError(std::move(problems));
  }
  return c;
}

Case read_case(const std::filesystem::path& file, const std::vector<std::string>& changes) {
  if (file == "-") return parse_case(read_standard_input(), "standard-input.toml", changes);
  return parse_case(read_file(file), file, changes);
}

}  // namespace vbond
