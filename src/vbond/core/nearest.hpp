#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbond {

/// Number of single-character insertions, deletions and replacements between two words (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name that a misspelt one most likely means, the first of equals; nothing if none is
/// within a third of its length (at least two edits).
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace vbond
