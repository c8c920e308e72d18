#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbond {

/// The name that is closest to `wrong` by edit distance (a swap of neighbours counts as one edit, letter case
/// as none) and close enough to be meant, the first of equals.
std::optional<std::string> nearest_name(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace vbond
