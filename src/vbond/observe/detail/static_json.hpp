#pragma once
#include <nlohmann/json.hpp>

#include "vbond/observe/summary.hpp"

namespace vbond {

using Json = nlohmann::ordered_json;

/// A static stage as its object in run.json, without name and time.
Json to_json(const StaticSummary& s);

/// The same back, without shapes and residuals. Throws Json::exception.
StaticSummary static_summary(const Json& j);

}  // namespace vbond
