#pragma once
#include <string>
#include <vector>

#include "vbond/case/keys.hpp"

namespace vbond::keys {

/// Refuses more particles than a specimen may have.
void check_total(Table& t, double particles, const std::vector<std::string>& keys);

/// What is done with the points of any shape, in this order.
void describe_arrangement(Table& t, SpecimenSpec& s);

}  // namespace vbond::keys
