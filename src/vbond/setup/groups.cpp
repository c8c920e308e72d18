#include "vbond/setup/groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/nearest.hpp"
#include "vbond/model/stress.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/group_members.hpp"
#include "vbond/setup/text_file.hpp"

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

  /// False if the name is taken, which is recorded.
  bool operator()(Group group, const SourcePlace& place) {
    const bool is_new = taken_.insert(group.name).second;
    if (is_new)
      model_.groups.push_back(std::move(group));
    else
      problems_.add(place, fmt::format("a second group of the name \"{}\"", group.name),
                    "\"all\", specimens, their parts and groups have different names",
                    fmt::format("rename it; taken: {}", fmt::join(names_of(model_.groups), ", ")));
    return is_new;
  }

 private:
  Model& model_;
  Problems& problems_;
  std::unordered_set<std::string> taken_;
};

Group consecutive(std::string name, std::size_t first, std::size_t count) {
  return {std::move(name), IdList<ParticleId>::consecutive(ParticleId{first}, count)};
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

/// Records that there is no particle of this number, however it was written.
void refuse_particle(const std::string& number, const Model& model, const std::string& what,
                     const SourcePlace& place, Problems& problems,
                     const char* way_out = "use a number in that range") {
  problems.add(place, fmt::format("{}: there is no particle {}", what, number),
               fmt::format("particles are numbered 0 to {}", model.particles() - 1), way_out);
}

}  // namespace

void add_groups(const Case& c, const std::vector<PlacedSpecimen>& specimens, Model& model,
                std::vector<std::string>& notes, Problems& problems) {
  Adder add(model, problems);
  add(consecutive("all", 0, model.particles()), {});
  for (const PlacedSpecimen& s : specimens)
    add(consecutive(s.spec->name, s.first, s.points.r.size()), s.spec->place);
  add_parts(specimens, add);
  std::vector<OpenGroup> open;
  for (const GroupSpec& spec : c.groups)
    if (add({spec.name, {}}, spec.place)) open.push_back({&spec, model.groups.size() - 1});
  fill_groups(c, specimens, open, model, notes, problems);
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
                                           const SourcePlace& place, Problems& problems,
                                           const char* way_out) {
  if (number >= 0 && static_cast<std::size_t>(number) < model.particles())
    return ParticleId{static_cast<std::size_t>(number)};
  refuse_particle(std::to_string(number), model, what, place, problems, way_out);
  return std::nullopt;
}

std::vector<char> membership(const Group& group, const Model& model) {
  std::vector<char> in(model.particles(), 0);
  for (const ParticleId p : group.particles) in[p.value] = 1;
  return in;
}

double look_up_volume(const StressSpec& s, const Model& model, Problems& problems) {
  const Group* group = look_up_group(s.group, model, problems);
  if (const double* given = std::get_if<double>(&s.volume)) return *given;
  if (group == nullptr) return 0.0;
  double spheres = 0.0;
  BoundingBox box;
  for (const ParticleId p : group->particles) {
    spheres += sphere_volume(model, p);
    box.add(model.r_0[p], model.radius[p]);
  }
  const Vec3d edges = box.high - box.low;
  const bool of_box = std::get<StressVolume>(s.volume) == StressVolume::box;
  const double volume = of_box ? edges.x * edges.y * edges.z : spheres;
  if (!(volume > 0.0) || group->particles.empty()) {
    problems.add(s.place, fmt::format("stress of group \"{}\"", group->name),
                 of_box ? "the box around its particles has no volume to divide by"
                        : "its particles have no volume to divide by",
                 "give a volume, or the particles a radius");
    return 0.0;
  }
  return volume;
}

std::vector<Group> resolve_groups(const std::vector<Placed<std::string>>& names, const Model& model) {
  Problems problems;
  std::vector<Group> groups;
  for (const auto& name : names)
    if (const Group* g = look_up_group(name, model, problems)) groups.push_back(*g);
  problems.throw_if_any();
  return groups;
}

double resolve_volume(const StressSpec& s, const Model& model) {
  Problems problems;
  const double volume = look_up_volume(s, model, problems);
  problems.throw_if_any();
  return volume;
}

std::vector<Group> look_up_groups_or_particles(const std::vector<Placed<std::string>>& names,
                                               const char* what, const Model& model, Problems& problems) {
  std::vector<Group> groups;
  for (const auto& name : names) {
    const std::string& text = name.value;
    if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos) {
      if (const Group* g = look_up_group(name, model, problems)) groups.push_back(*g);
    } else if (const auto number = to_integer(text); !number) {  // too large
      refuse_particle(text, model, what, name.place, problems);
    } else if (const auto id = look_up_particle(*number, model, what, name.place, problems)) {
      groups.push_back({text, {*id}});
    }
  }
  return groups;
}

std::vector<Group> resolve_groups_or_particles(const std::vector<Placed<std::string>>& names,
                                               const char* what, const Model& model) {
  Problems problems;
  std::vector<Group> groups = look_up_groups_or_particles(names, what, model, problems);
  problems.throw_if_any();
  return groups;
}

}  // namespace vbond
