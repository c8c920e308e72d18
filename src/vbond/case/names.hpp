#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace vbond::keys {

/// `a, b, c`, each between `quote` and `quote`.
std::string join(const std::vector<std::string>& names, std::string_view quote = "");

}  // namespace vbond::keys
