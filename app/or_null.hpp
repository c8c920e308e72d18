#pragma once
#include <nlohmann/json.hpp>
#include <optional>

namespace vbond::app {

/// A number of a JSON file that may not be known.
inline nlohmann::ordered_json or_null(const std::optional<double>& x) {
  return x ? nlohmann::ordered_json(*x) : nlohmann::ordered_json();
}

}  // namespace vbond::app
