#include "vbond/build/groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include "vbond/build/build.hpp"
#include "vbond/build/text_file.hpp"
#include "vbond/core/nearest.hpp"

namespace vbond {
namespace {

std::vector<std::string> names_of(const std::vector<Group>& groups) {
  std::vector<std::string> names;
  for (const Group& g : groups) names.push_back(g.name);
  return names;
}

/// Adds groups of different names to the model.
class Adder {
 public:
  Adder(Model& model, Problems& problems) : model_(model), problems_(problems) {}

  void operator()(Group group, const SourcePlace& place) {
    if (taken_.insert(group.name).second)
      model_.groups.push_back(std::move(group));
    else
      problems_.add(place, fmt::format("a second group of the name \"{}\"", group.name),
                    "\"all\", specimens, their parts and groups have different names",
                    fmt::format("rename it; taken: {}", fmt::join(names_of(model_.groups), ", ")));
  }

 private:
  Model& model_;
  Problems& problems_;
  std::unordered_set<std::string> taken_;
};

Group consecutive(std::string name, std::size_t first, std::size_t count) {
  Group g{std::move(name), {}};
  for (std::size_t k = 0; k < count; ++k) g.particles.push_back(ParticleId{first + k});
  return g;
}

Group part_of(const PlacedSpecimen& s, std::size_t part, std::string name) {
  Group g{std::move(name), {}};
  for (const std::int64_t k : s.points.parts[part].second)
    g.particles.push_back(ParticleId{s.first + static_cast<std::size_t>(k)});
  return g;
}

void add_parts(const std::vector<PlacedSpecimen>& specimens, Adder& add) {
  std::unordered_map<std::string, int> specimens_with;
  for (const PlacedSpecimen& s : specimens)
    for (std::size_t part = 0; part < s.points.parts.size(); ++part) {
      const std::string& name = s.points.parts[part].first;
      ++specimens_with[name];
      add(part_of(s, part, s.spec->name + "." + name), s.spec->place);
    }
  for (const PlacedSpecimen& s : specimens)
    for (std::size_t part = 0; part < s.points.parts.size(); ++part) {
      const std::string& name = s.points.parts[part].first;
      if (specimens_with[name] == 1) add(part_of(s, part, name), s.spec->place);
    }
}

/// Finds the particles of a group that the case describes.
struct Members {
  const Model& model;
  const GroupSpec& spec;
  Problems& problems;

  std::vector<ParticleId> operator()(const IndexList& numbers) const {
    std::vector<ParticleId> found;
    for (const std::int64_t number : numbers)
      if (const auto id =
              look_up_particle(number, model, "group \"" + spec.name + "\"", spec.place, problems))
        found.push_back(*id);
    std::sort(found.begin(), found.end());
    const auto twice = std::adjacent_find(found.begin(), found.end());
    if (twice != found.end())
      problems.add(spec.place, fmt::format("group \"{}\" lists particle {} twice", spec.name, twice->value),
                   "a group is a set", "remove one of them");
    return found;
  }
  std::vector<ParticleId> operator()(const BoxRegion& b) const {
    return where([&](const Vec3d& r) {
      return b.min.x <= r.x && r.x <= b.max.x && b.min.y <= r.y && r.y <= b.max.y && b.min.z <= r.z &&
             r.z <= b.max.z;
    });
  }
  std::vector<ParticleId> operator()(const SphereRegion& s) const {
    return where([&](const Vec3d& r) { return norm(r - s.centre) <= s.radius; });
  }
  std::vector<ParticleId> operator()(const PlaneRegion& p) const {
    if (!(norm(p.normal) > 0.0)) {
      problems.add(spec.place, fmt::format("the normal of group \"{}\" is zero", spec.name),
                   "it says which way the plane faces", "use for instance normal = [0, 0, 1]");
      return {};
    }
    const Vec3d n = normalised(p.normal);
    return where([&](const Vec3d& r) { return std::abs(dot(r - p.point, n)) <= p.within; });
  }

  template <class Inside>
  std::vector<ParticleId> where(Inside&& inside) const {
    std::vector<ParticleId> found;
    for (const ParticleId p : model.r_0.ids())
      if (inside(model.r_0[p])) found.push_back(p);
    return found;
  }
};

/// Records that there is no particle of this number, however it was written.
void refuse_particle(const std::string& number, const Model& model, const std::string& what,
                     const SourcePlace& place, Problems& problems) {
  problems.add(place, fmt::format("{}: there is no particle {}", what, number),
               fmt::format("particles are numbered 0 to {}", model.particles() - 1),
               "use a number in that range");
}

}  // namespace

void add_groups(const Case& c, const std::vector<PlacedSpecimen>& specimens, Model& model,
                Problems& problems) {
  Adder add(model, problems);
  add(consecutive("all", 0, model.particles()), {});
  for (const PlacedSpecimen& s : specimens)
    add(consecutive(s.spec->name, s.first, s.points.r.size()), s.spec->place);
  add_parts(specimens, add);
  for (const GroupSpec& spec : c.groups) {
    const std::size_t before = problems.count();
    Group group{spec.name, std::visit(Members{model, spec, problems}, spec.region)};
    if (group.particles.empty() && problems.count() == before)
      problems.add(spec.place, fmt::format("group \"{}\" has no particles", spec.name),
                   "a group has at least one; regions include their boundary, without any tolerance",
                   "make the region larger");
    add(std::move(group), spec.place);
  }
}

const Group* look_up_group(const Placed<std::string>& name, const Model& model, Problems& problems) {
  const Group* group = model.find_group(name.value);
  if (group == nullptr) {
    const std::vector<std::string> known = names_of(model.groups);
    const auto near = nearest_name(name.value, known);
    problems.add(name.place, fmt::format("there is no group \"{}\"", name.value),
                 fmt::format("known groups: {}", fmt::join(known, ", ")),
                 near ? fmt::format("did you mean \"{}\"?", *near)
                      : "use one of them, or define it: [groups." + name.value + "]");
  }
  return group;
}

std::optional<ParticleId> look_up_particle(std::int64_t number, const Model& model, const std::string& what,
                                           const SourcePlace& place, Problems& problems) {
  if (number >= 0 && static_cast<std::size_t>(number) < model.particles())
    return ParticleId{static_cast<std::size_t>(number)};
  refuse_particle(std::to_string(number), model, what, place, problems);
  return std::nullopt;
}

std::vector<char> membership(const Group& group, const Model& model) {
  std::vector<char> in(model.particles(), 0);
  for (const ParticleId p : group.particles) in[p.value] = 1;
  return in;
}

std::vector<Group> resolve_groups(const std::vector<Placed<std::string>>& names, const Model& model) {
  Problems problems;
  std::vector<Group> groups;
  for (const auto& name : names)
    if (const Group* g = look_up_group(name, model, problems)) groups.push_back(*g);
  problems.throw_if_any();
  return groups;
}

std::vector<Group> look_up_groups_or_particles(const std::vector<Placed<std::string>>& names,
                                               const Model& model, Problems& problems) {
  std::vector<Group> groups;
  for (const auto& name : names) {
    const std::string& text = name.value;
    if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos) {
      if (const Group* g = look_up_group(name, model, problems)) groups.push_back(*g);
    } else if (const auto number = to_integer(text); !number) {  // too large
      refuse_particle(text, model, "displacements", name.place, problems);
    } else if (const auto id = look_up_particle(*number, model, "displacements", name.place, problems)) {
      groups.push_back({text, {*id}});
    }
  }
  return groups;
}

std::vector<Group> resolve_groups_or_particles(const std::vector<Placed<std::string>>& names,
                                               const Model& model) {
  Problems problems;
  std::vector<Group> groups = look_up_groups_or_particles(names, model, problems);
  problems.throw_if_any();
  return groups;
}

}  // namespace vbond
