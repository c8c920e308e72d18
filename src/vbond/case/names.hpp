#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbond::keys {

/// `a, b, c`, each between `quote` and `quote`.
std::string join(const std::vector<std::string>& names, std::string_view quote = "");

/// The name that is meant by a wrong one: what others call so, or the nearest (nearest.hpp).
std::optional<std::string> meant_name(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace vbond::keys
