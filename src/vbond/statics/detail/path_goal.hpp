#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/static_stage.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {

/// Something at which a path ends.
struct Goal {
  std::string name;
  std::function<double(const Placement&)> gap;  // negative before
  double small = 0;                             // gap that counts as none
  std::optional<double> load_factor;            // then met exactly
};

/// Those of a stage's `stop`.
std::vector<Goal> goals_of(const PathSettings& path);

}  // namespace vbond
