#pragma once
#include <string>
#include <vector>

#include "vbond/setup/groups.hpp"

namespace vbond {

/// A group of the case and its number in Model::groups, where it has no particles yet.
struct OpenGroup {
  const GroupSpec* spec;
  std::size_t number;
};

/// Finds the particles of these groups, which may refer to one another in any order. Records groups without
/// particles and groups that need themselves. `notes` takes what is made of files.
void fill_groups(const Case& c, const std::vector<PlacedSpecimen>& specimens,
                 const std::vector<OpenGroup>& groups, Model& model, std::vector<std::string>& notes,
                 Problems& problems);

}  // namespace vbond
