#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace vbond::keys {

/// The name that is closest to `wrong` by edit distance (a swap of neighbours counts as one edit, letter case
/// as none); empty if none is close enough to be meant.
std::string nearest(std::string_view wrong, const std::vector<std::string>& names);

/// `a, b, c`, each between `quote` and `quote`.
std::string join(const std::vector<std::string>& names, std::string_view quote = "");

}  // namespace vbond::keys
