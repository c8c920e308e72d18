#include "vbond/setup/group_members.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>

#include "vbond/setup/regions.hpp"
#include "vbond/terms/walls/setup_walls.hpp"

namespace vbond {
namespace {

using Particles = std::vector<ParticleId>;  // in increasing order, none twice

constexpr std::size_t deepest = 1000;  // so that no file of groups takes more stack than there is

enum class Progress : unsigned char { open, under_way, found, wrong };

/// Finds groups one after another, before each those that it refers to.
class Filler {
 public:
  Filler(const Case& c, const std::vector<PlacedSpecimen>& specimens, const std::vector<OpenGroup>& groups,
         Model& model, std::vector<std::string>& notes, Problems& problems)
      : c_(c), specimens_(specimens), model_(model), notes_(notes), problems_(problems) {
    for (const OpenGroup& g : groups) entries_.insert({g.spec->name, {g}});
  }

  void fill_all(const std::vector<OpenGroup>& groups) {
    for (const OpenGroup& g : groups) fill(entries_.at(g.spec->name), g.spec->place);
  }

 private:
  struct Entry {
    OpenGroup group;
    Progress progress = Progress::open;
  };

  /// `place`: what asks for the group. False if it has no particles; that is recorded once.
  bool fill(Entry& entry, const SourcePlace& place) {
    if (entry.progress == Progress::found) return true;
    if (entry.progress == Progress::wrong) return false;
    const GroupSpec& spec = *entry.group.spec;
    if (entry.progress == Progress::under_way || path_.size() >= deepest) {
      refuse_path(spec.name, place);
      return false;
    }
    entry.progress = Progress::under_way;
    path_.push_back(spec.name);
    std::optional<Particles> found = find(spec);
    path_.pop_back();
    if (found && found->empty()) refuse_empty(spec);
    const bool good = found && !found->empty();
    entry.progress = good ? Progress::found : Progress::wrong;
    if (good) model_.groups[entry.group.number].particles = std::move(*found);
    return good;
  }

  /// Nothing if the reason why there are none is recorded; so do those that follow.
  std::optional<Particles> find(const GroupSpec& spec) {
    try {
      return std::visit([&](const auto& form) { return members(form, spec); }, spec.region);
    } catch (const CaseError& e) {
      problems_.add(e);
      return std::nullopt;
    }
  }

  std::optional<Particles> members(const IndexList& numbers, const GroupSpec& spec) {
    const std::string who = "group \"" + spec.name + "\"";
    Particles found;
    for (const std::int64_t number : numbers)
      if (const auto id = look_up_particle(number, model_, who, spec.place, problems_)) found.push_back(*id);
    if (found.size() < numbers.size()) return std::nullopt;
    std::sort(found.begin(), found.end());
    const auto twice = std::adjacent_find(found.begin(), found.end());
    if (twice == found.end()) return found;
    problems_.add(spec.place, fmt::format("{} lists particle {} twice", who, twice->value),
                  "a group is a set", "remove one of them");
    return std::nullopt;
  }

  template <class RegionForm>
  std::optional<Particles> members(const RegionForm& region, const GroupSpec& spec) {
    const Inside inside =
        inside_of(region, {c_.file, spec.place, fmt::format("group \"{}\"", spec.name), notes_});
    return where([&](ParticleId p) { return inside(model_.r_0[p]); });
  }

  std::optional<Particles> members(const MaterialGroup& g, const GroupSpec&) {
    const auto material = look_up_material(g.material, model_, problems_);
    if (!material) return std::nullopt;
    return where([&](ParticleId p) { return model_.material_of(p) == *material; });
  }

  std::optional<Particles> members(const TypeGroup& g, const GroupSpec& spec) {
    Particles found;
    std::set<std::string> known;
    for (const PlacedSpecimen& s : specimens_) {
      if (!std::holds_alternative<LammpsSpecimen>(s.spec->shape)) continue;
      for (const auto& [name, particles] : s.points.parts) {
        known.insert(name);
        if (name != fmt::format("type-{}", g.type)) continue;
        for (const std::int64_t k : particles)
          found.push_back(ParticleId{s.first + static_cast<std::size_t>(k)});
      }
    }
    if (!found.empty()) return found;
    problems_.add(spec.place, fmt::format("group \"{}\": no particle is of type {}", spec.name, g.type),
                  known.empty()
                      ? std::string("particles of LAMMPS data files have types, and the case has none")
                      : fmt::format("there are {}", fmt::join(known, ", ")),
                  known.empty() ? "use another kind of group" : "use one of these types");
    return std::nullopt;
  }

  std::optional<Particles> members(const FibreGroup& g, const GroupSpec& spec) {
    const std::set<std::int64_t> wanted(g.fibres.begin(), g.fibres.end());
    Particles found;
    std::set<std::int64_t> known;
    for (const PlacedSpecimen& s : specimens_)
      for (std::size_t k = 0; k < s.points.fibre.size(); ++k) {
        known.insert(s.points.fibre[k]);
        if (wanted.count(s.points.fibre[k]) > 0) found.push_back(ParticleId{s.first + k});
      }
    for (const std::int64_t fibre : wanted) {
      if (known.count(fibre) > 0) continue;
      problems_.add(spec.place, fmt::format("group \"{}\": there is no fibre {}", spec.name, fibre),
                    known.empty() ? std::string("fibres are those of specimens of kind \"fibres\", and the "
                                                "case has none")
                                  : fmt::format("fibres are numbered {} to {}, less those that are cut away",
                                                *known.begin(), *known.rbegin()),
                    known.empty() ? "use another kind of group" : "use one of these numbers");
      return std::nullopt;
    }
    return found;
  }

  std::optional<Particles> members(const UnionGroup& g, const GroupSpec&) {
    if (!find_all(g.groups)) return std::nullopt;
    const auto in = count(g.groups);
    return where([&](ParticleId p) { return in[p.value] > 0; });
  }

  std::optional<Particles> members(const IntersectionGroup& g, const GroupSpec&) {
    if (!find_all(g.groups)) return std::nullopt;
    const auto in = count(g.groups);
    return where([&](ParticleId p) { return in[p.value] == g.groups.size(); });
  }

  std::optional<Particles> members(const DifferenceGroup& g, const GroupSpec&) {
    if (!find_all({g.of}) || !find_all(g.without)) return std::nullopt;
    const auto of = count({g.of}), without = count(g.without);
    return where([&](ParticleId p) { return of[p.value] > 0 && without[p.value] == 0; });
  }

  bool find_all(const std::vector<Placed<std::string>>& names) {
    bool good = true;
    for (const Placed<std::string>& name : names) {
      const auto entry = entries_.find(name.value);
      good = look_up_group(name, model_, problems_) != nullptr &&
             (entry == entries_.end() || fill(entry->second, name.place)) && good;
    }
    return good;
  }

  /// Of how many of these groups each particle is.
  std::vector<std::size_t> count(const std::vector<Placed<std::string>>& names) const {
    std::vector<std::size_t> in(model_.particles(), 0);
    for (const Placed<std::string>& name : names)
      for (const ParticleId p : model_.find_group(name.value)->particles) ++in[p.value];
    return in;
  }

  template <class Chosen>
  Particles where(Chosen&& chosen) const {
    Particles found;
    for (const ParticleId p : model_.r_0.ids())
      if (chosen(p)) found.push_back(p);
    return found;
  }

  void refuse_path(const std::string& name, const SourcePlace& place) {
    const auto start = std::find(path_.begin(), path_.end(), name);
    if (start == path_.end())
      problems_.add(place, fmt::format("group \"{}\" is the end of a chain of {} groups", name, deepest + 1),
                    fmt::format("groups refer to one another at most {} deep", deepest),
                    "name more groups at once in one union, intersection or difference");
    else
      problems_.add(place,
                    fmt::format("group \"{}\" needs itself: {} -> {}", name,
                                fmt::join(start, path_.end(), " -> "), name),
                    "union, intersection and difference take groups that can be found before",
                    "name another group here");
  }

  void refuse_empty(const GroupSpec& spec) {
    const bool of_groups = std::holds_alternative<IntersectionGroup>(spec.region) ||
                           std::holds_alternative<DifferenceGroup>(spec.region);
    const bool of_material = std::holds_alternative<MaterialGroup>(spec.region);
    problems_.add(spec.place, fmt::format("group \"{}\" has no particles", spec.name),
                  of_groups || of_material
                      ? "a group has at least one"
                      : "a group has at least one; regions include their boundary, without any tolerance",
                  of_groups     ? "change the groups that it is made of"
                  : of_material ? "give the material to a specimen, or name another"
                                : "make the region larger");
  }

  const Case& c_;
  const std::vector<PlacedSpecimen>& specimens_;
  Model& model_;
  std::vector<std::string>& notes_;
  Problems& problems_;
  std::unordered_map<std::string, Entry> entries_;
  std::vector<std::string> path_;  // groups under way, each needed by the one before
};

}  // namespace

void fill_groups(const Case& c, const std::vector<PlacedSpecimen>& specimens,
                 const std::vector<OpenGroup>& groups, Model& model, std::vector<std::string>& notes,
                 Problems& problems) {
  Filler(c, specimens, groups, model, notes, problems).fill_all(groups);
}

}  // namespace vbond
