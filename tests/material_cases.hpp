#pragma once
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace vbond::testing {

/// A case of tests/data/materials.json; the file says where its numbers come from.
inline nlohmann::json material_case(const std::string& id) {
  std::ifstream file(VBOND_TEST_DATA "/materials.json");
  const nlohmann::json all = nlohmann::json::parse(file);
  for (const auto& c : all["cases"])
    if (c["id"] == id) return c;
  throw std::out_of_range("materials.json has no case " + id);
}

}  // namespace vbond::testing
