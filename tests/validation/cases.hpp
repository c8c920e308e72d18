#pragma once
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "vbond/core/quat.hpp"

namespace vbond::testing {

/// One case of tests/data/validation.json; the file says where its numbers come from.
inline const nlohmann::json& validation_case(const std::string& id) {
  static const nlohmann::json all = [] {
    std::ifstream file(std::string(VBOND_TEST_DATA) + "/validation.json");
    return nlohmann::json::parse(file)["cases"];
  }();
  return all.at(id);
}

/// A number that stands in the file as such or, to keep all its digits, as text.
inline double number(const nlohmann::json& j) {
  return j.is_string() ? std::stod(j.get<std::string>()) : j.get<double>();
}
inline Vec3d vector(const nlohmann::json& j) {
  return {number(j.at(0)), number(j.at(1)), number(j.at(2))};
}
inline Quatd quaternion(const nlohmann::json& j) {
  return normalised(Quatd{number(j.at(0)), number(j.at(1)), number(j.at(2)), number(j.at(3))});
}

}  // namespace vbond::testing
