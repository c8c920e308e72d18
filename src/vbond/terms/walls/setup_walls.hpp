#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/problems.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/walls/wall.hpp"

namespace vbond {

/// The materials of the case and which one each particle has.
void add_materials(const Case& c, const std::vector<PlacedSpecimen>& specimens, Model& model,
                   Problems& problems);

/// The material of that name, in Model::materials; if there is none, records it.
std::optional<std::uint32_t> look_up_material(const Placed<std::string>& name, const Model& model,
                                              Problems& problems);

/// The walls of the case, meshes read from their files. Records walls without contacts and walls that stand
/// in a specimen as it begins.
void add_walls(const Case& c, Built& built, Problems& problems);

/// The place of that wall in Model::walls; if there is none, records it.
std::optional<std::size_t> look_up_wall(const Placed<std::string>& name, const Model& model,
                                        Problems& problems);

}  // namespace vbond
