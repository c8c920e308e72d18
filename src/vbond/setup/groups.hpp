#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/problems.hpp"
#include "vbond/model/model.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {

/// A specimen and the number of its first particle in the model.
struct PlacedSpecimen {
  const SpecimenSpec* spec;
  std::size_t first;
  SpecimenPoints points;
};

/// Adds "all", the specimens and their parts, then the groups of the case. A part is known by its plain
/// name too ("ends") if only one specimen has such a part. Regions include their boundary. `notes` takes what
/// is made of the files of meshes.
void add_groups(const Case& c, const std::vector<PlacedSpecimen>& specimens, Model& model,
                std::vector<std::string>& notes, Problems& problems);

/// The group of that name; if there is none, records it and returns nullptr.
const Group* look_up_group(const Placed<std::string>& name, const Model& model, Problems& problems);

/// The particle of that number; if there is none, records it. `what` names the key.
std::optional<ParticleId> look_up_particle(std::int64_t number, const Model& model, const std::string& what,
                                           const SourcePlace& place, Problems& problems,
                                           const char* way_out = "use a number in that range");

/// The volume that a group of output.history.stress takes up; if it has none, records it.
double look_up_volume(const StressSpec& s, const Model& model, Problems& problems);

/// For each particle, whether the group has it.
std::vector<char> membership(const Group& group, const Model& model);

/// Groups by name, or of one particle where the name is digits; records what is unknown. `what` names the
/// key.
std::vector<Group> look_up_groups_or_particles(const std::vector<Placed<std::string>>& names,
                                               const char* what, const Model& model, Problems& problems);

}  // namespace vbond
