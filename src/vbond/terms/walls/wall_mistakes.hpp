#pragma once
#include <string>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/terms/walls/wall.hpp"

namespace vbond {

/// What a program may do wrong with materials and walls, as in mistakes.hpp.
std::vector<std::string> mistakes_in_walls(const Model& model);
/// The same for what moves them in a stage of motion, and in a static one.
std::vector<std::string> mistakes_in_drives(const Model& model, const Stage& stage);
std::vector<std::string> mistakes_in_drives(const Model& model, const StaticStage& stage);

}  // namespace vbond
