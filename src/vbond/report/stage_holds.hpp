#pragma once
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/report/page.hpp"

namespace vbond::page {

/// What each stage of the case holds and loads; stages that do neither are left out.
std::vector<StageHolds> holds_of(const Case& c, const Model& model);

}  // namespace vbond::page
