#pragma once
#include <string>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/terms/walls/wall.hpp"

namespace vbond {

/// What a program may do wrong with materials and walls, as in mistakes.hpp.
std::vector<std::string> mistakes_in_walls(const Model& model);

}  // namespace vbond
