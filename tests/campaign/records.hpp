#pragma once
#include <nlohmann/json.hpp>

#include "judge.hpp"

namespace vbond::campaign {

nlohmann::json json_of(const Reference& r);
nlohmann::json json_of(const Answer& a);
Reference reference_of(const nlohmann::json& j);
Answer answer_of(const nlohmann::json& j);

}  // namespace vbond::campaign
